//! A first drive file from a recording: what was measured decides what is modelled, least squares
//! on the balances and a fit give its values, and what the recording does not tell is marked.
//!
//! [`choice`] says what is modelled; [`given`] reads what a data sheet says; [`usual`] makes the drive
//! to begin with; [`estimate`] finds the values and how well they fit, [`origins`] where each comes
//! from; [`text`] writes the file with its comments.

mod choice;
mod estimate;
mod evidence;
mod given;
mod loads;
mod names;
mod origins;
mod text;
mod usual;

use drivescope_discovery::Unexplained;
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use miette::Diagnostic;
use thiserror::Error;

pub(crate) use choice::{Choice, Constant};
pub(crate) use given::{Given, held, offer};

use crate::simulation::replay::Fit;

/// A recording lasts so long at least, s.
const LEAST_S: f64 = 1.0;

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
    /// Nothing tells what drove the motion.
    #[error(
        "{file}: has none of voltage or command `u`, current `i`, `torque`, control signal `C_m`; it has {signals}"
    )]
    #[diagnostic(help("name the column with --columns u=COLUMN:UNIT (or i, torque)"))]
    NoInput {
        /// The recording.
        file: String,
        /// What is there.
        signals: String,
    },
    /// A voltage-driven drive was asked for.
    #[error("{file}: has no voltage `u`; it has {signals}")]
    #[diagnostic(help("name it with --columns u=COLUMN:V, or leave --input voltage out"))]
    NoVoltage {
        /// The recording.
        file: String,
        /// What is there.
        signals: String,
    },
    /// Friction and inertia need some time to show.
    #[error("{file}: lasts {duration_s:.3} s, and a first drive needs {LEAST_S} s")]
    #[diagnostic(help("record for longer: steps and reversals over some seconds"))]
    TooShort {
        /// The recording.
        file: String,
        /// All its segments together, s.
        duration_s: f64,
    },
    /// A value of the command line.
    #[error("--given: `{item}` is no NAME=VALUE above zero, SI, of {names}")]
    #[diagnostic(help("give values such as --given K_m=0.05,R=2.1"))]
    Given {
        /// What was given.
        item: String,
        /// What may be.
        names: String,
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
    /// Name in the drive file.
    pub(crate) name: &'static str,
    /// SI.
    pub(crate) value: f64,
    pub(crate) unit: String,
    /// Standard error where it was estimated.
    pub(crate) std_error: Option<f64>,
    /// Where it comes from.
    pub(crate) origin: Origin,
}

/// Where a value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    /// From this recording.
    Estimated(&'static str),
    /// From a data sheet, or by definition.
    Given(&'static str),
    /// The recording does not tell: what to do about it.
    Guessed(&'static str),
}

/// How well the first drive fits its recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Quality {
    /// Every measured output.
    pub(crate) fits: Vec<Fit>,
    /// Bandwidth of the observer with which, Hz; 0 in free run.
    pub(crate) observer_hz: f64,
    /// What the torque balance and the voltage balance leave unexplained.
    pub(crate) unexplained: [Option<Unexplained>; 2],
}

/// What a recording says of a drive.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FirstDrive {
    pub(crate) recording: String,
    /// What is modelled.
    pub(crate) choice: Choice,
    /// Every parameter, in the order of the file.
    pub(crate) values: Vec<Value>,
    /// Parameters that a fit leaves as they are.
    pub(crate) fixed: Vec<&'static str>,
    /// How well it fits.
    pub(crate) quality: Quality,
}

impl FirstDrive {
    /// Finds what the recording says; `input` overrules what its columns suggest, what is `given`
    /// is taken as it is.
    ///
    /// # Errors
    /// Nothing drives, or nothing tells the motion, or the recording cannot be used.
    pub(crate) fn of(
        recording: &Recording,
        input: Option<drivescope_plant::drive::Input>,
        given: &Given,
    ) -> miette::Result<Self> {
        let choice = Choice::of(recording, input)?;
        let duration_s = recording.len() as f64 * recording.period_s;
        // Rounding of the sampling time is no reason to refuse.
        if duration_s < LEAST_S * (1.0 - 1e-6) {
            let file = recording.name.clone();
            return Err(FirstDriveError::TooShort { file, duration_s }.into());
        }
        estimate::first_drive(recording, choice, given)
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
        let guess = |value: &Value| match value.origin {
            Origin::Guessed(todo) => Some((value.name, todo)),
            Origin::Estimated(_) | Origin::Given(_) => None,
        };
        self.values.iter().filter_map(guess).collect()
    }

    /// The value of a parameter, if the drive has it.
    pub(crate) fn value(&self, name: &str) -> Option<&Value> {
        self.values.iter().find(|value| value.name == name)
    }
}
