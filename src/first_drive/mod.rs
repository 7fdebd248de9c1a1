//! A first drive file from a recording: what its columns say about the drive, rough values for a
//! fit to start from, and what a person has to fill in.
//!
//! [`signals`] tells what was measured; [`estimate`] finds values by regression; [`text`] writes
//! the file with its comments.

mod estimate;
mod signals;
mod text;

use drivescope_plant::drive::{Drive, Input, Motion};
use drivescope_recording::Recording;
use miette::Diagnostic;
use thiserror::Error;

pub(crate) use signals::Signals;

/// Why no drive file can be made.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum FirstDriveError {
    /// Nothing tells the motion.
    #[error("{file}: has neither speed nor position; it has {signals}")]
    #[diagnostic(help("name the column with --columns omega=COLUMN:UNIT (or theta, v, x)"))]
    NoMotion {
        /// The recording.
        file: String,
        /// What is there.
        signals: String,
    },
    /// The file that was made is wrong: an error of this program.
    #[error("the values found make no drive: {reason}")]
    #[diagnostic(help("check the units of the columns; the recording may not move the drive"))]
    NoDrive {
        /// Why.
        reason: String,
    },
}

/// A value and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Value {
    /// SI.
    pub(crate) value: f64,
    /// What was done to get it, or that it is a guess to be replaced.
    pub(crate) origin: Origin,
}

/// Where a value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    /// From this recording.
    Estimated(&'static str),
    /// The recording does not tell: what to do about it.
    Guessed(&'static str),
}

/// What a recording says of a drive.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FirstDrive {
    /// The recording.
    pub(crate) recording: String,
    /// Rotary or linear.
    pub(crate) motion: Motion,
    /// What u is.
    pub(crate) input: Input,
    /// Why u is taken as that.
    pub(crate) because: &'static str,
    /// Unit of u.
    pub(crate) u_unit: String,
    /// Armature resistance; none where force-driven.
    pub(crate) r: Option<Value>,
    /// Armature inductance; none where force-driven.
    pub(crate) l: Option<Value>,
    /// Voltage and torque constant, or K_m alone where force-driven.
    pub(crate) k: Value,
    /// Inertia.
    pub(crate) j: Value,
    /// Viscous friction.
    pub(crate) b_m: Value,
    /// Coulomb friction.
    pub(crate) t_c: Value,
    /// Whether a reference was recorded: there is a controller that nobody described.
    pub(crate) controlled: bool,
}

impl FirstDrive {
    /// Finds what the recording says; `input` overrules what its columns suggest.
    ///
    /// # Errors
    /// There is no u, or nothing that tells the motion.
    pub(crate) fn of(recording: &Recording, input: Option<Input>) -> miette::Result<Self> {
        Ok(estimate::first_drive(&Signals::of(recording, input)?))
    }

    /// The text of the drive file, and the drive in it.
    ///
    /// # Errors
    /// [`FirstDriveError::NoDrive`] if the values are no drive.
    pub(crate) fn file(&self, name: &str) -> Result<(String, Drive), FirstDriveError> {
        let text = text::drive_file(self);
        let parsed = Drive::parse(&text, name);
        let drive =
            parsed.map_err(|error| FirstDriveError::NoDrive { reason: error.to_string() })?;
        Ok((text, drive))
    }

    /// The parameters that are guesses, by name, each with what to do about it.
    pub(crate) fn guesses(&self) -> Vec<(&'static str, &'static str)> {
        self.values()
            .into_iter()
            .filter_map(|(name, value)| match value.origin {
                Origin::Guessed(todo) => Some((name, todo)),
                Origin::Estimated(_) => None,
            })
            .collect()
    }

    /// Every parameter with its name in the drive file.
    pub(crate) fn values(&self) -> Vec<(&'static str, &Value)> {
        let force = self.input == Input::Force;
        let electrical = [("R", self.r.as_ref()), ("L", self.l.as_ref())];
        let electrical = electrical.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let constants = if force { &["K_m"][..] } else { &["K_e", "K_m"] };
        electrical
            .chain(constants.iter().map(|name| (*name, &self.k)))
            .chain([("J", &self.j), ("B_m", &self.b_m), ("coulomb.T_c", &self.t_c)])
            .collect()
    }
}
