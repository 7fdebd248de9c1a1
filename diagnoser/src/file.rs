//! The diagnoser file: TOML, versioned, written whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use drivescope_recording::write_whole;
use serde::Deserialize;
use thiserror::Error;

use crate::bank::BankDesign;
use crate::detectors::DetectorKind;
use crate::diagnoser::Diagnoser;
use crate::flaw::Flaw;

/// Version of the file format that this code writes: 3, since it may hold a bank.
pub const SCHEMA: u32 = 3;
/// Oldest version that it reads: one of version 2 has no bank, one of version 1 no known faults either.
const OLDEST: u32 = 1;

/// Why a diagnoser file cannot be used or written.
#[derive(Debug, Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It cannot be written; nothing was left behind.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is not a diagnoser file, or damaged.
    #[error("{} is no diagnoser file: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and what was expected there.
        source: Box<toml::de::Error>,
    },
    /// The diagnoser cannot be put into words.
    #[error("this diagnoser cannot be written as TOML: {0}")]
    Serialise(#[from] toml::ser::Error),
    /// It was written by another version.
    #[error("{} has schema {found}, this program reads {OLDEST} to {SCHEMA}: train the diagnoser again", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: u32,
    },
    /// A part of it cannot run, or has no meaning.
    #[error("{}: {flaw}", path.display())]
    Flaw {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        #[source]
        flaw: Flaw,
    },
    /// Known faults whose parts do not fit together.
    #[error("{}: the known faults do not fit together or not the {inputs} inputs and the residual: train the diagnoser again", path.display())]
    Faults {
        /// The file.
        path: PathBuf,
        /// Inputs of the interface.
        inputs: usize,
    },
}

/// The part that every version has.
#[derive(Deserialize)]
struct Head {
    schema: u32,
}

impl Diagnoser {
    /// The text of its file.
    ///
    /// # Errors
    /// A diagnoser that TOML does not hold.
    pub fn to_toml(&self) -> Result<String, FileError> {
        Ok(toml::to_string(self)?)
    }

    /// Writes the file, whole or not at all.
    pub fn save(&self, path: &Path) -> Result<(), FileError> {
        let text = self.to_toml()?;
        let write = || write_whole(path, |out| out.write_all(text.as_bytes()));
        write().map_err(|source| FileError::Write { path: path.into(), source })?;
        Ok(())
    }

    /// Whether a text is meant to be a diagnoser file: it says which signals it watches.
    pub fn is_meant(text: &str) -> bool {
        toml::from_str::<toml::Table>(text).is_ok_and(|table| table.contains_key("interface"))
    }

    /// Reads a file and checks that what it holds can run.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let text = fs::read_to_string(path)
            .map_err(|source| FileError::Read { path: path.into(), source })?;
        let parse =
            |source| FileError::Parse { path: path.to_path_buf(), source: Box::new(source) };
        // The version first: a later one may hold keys that this one does not know.
        let Head { schema } = toml::from_str(&text).map_err(parse)?;
        if !(OLDEST..=SCHEMA).contains(&schema) {
            return Err(FileError::Schema { path: path.into(), found: schema });
        }
        let diagnoser: Self = toml::from_str(&text).map_err(parse)?;
        diagnoser.check(path)?;
        Ok(Self { schema: SCHEMA, ..diagnoser })
    }

    fn check(&self, path: &Path) -> Result<(), FileError> {
        let flawed = |flaw| FileError::Flaw { path: path.into(), flaw };
        let inputs = self.interface.inputs.len();
        Flaw::of_model("process model", &self.model, inputs).map_err(flawed)?;
        let check = |kind: DetectorKind| kind.check(&self.parts(), &self.detectors);
        DetectorKind::ALL.into_iter().try_for_each(check).map_err(flawed)?;
        if self.faults.as_ref().is_some_and(|faults| !faults.is_valid(inputs)) {
            return Err(FileError::Faults { path: path.into(), inputs });
        }
        self.numbers().map_err(flawed)
    }

    /// Refuses numbers without meaning.
    fn numbers(&self) -> Result<(), Flaw> {
        let bank = self.bank.as_ref();
        let of_bank = |value: fn(&BankDesign) -> f64| bank.map_or(1.0, value);
        let positive = [
            ("bank.arl_0", of_bank(|bank| bank.arl_0)),
            ("bank.period_s", of_bank(|bank| bank.period_s)),
            ("bank.horizon", of_bank(|bank| bank.horizon as f64)),
            ("bank.limits.ratio", of_bank(|bank| bank.limits.ratio)),
            ("bank.limits.squares", of_bank(|bank| bank.limits.squares)),
            ("bank.noise.omega", of_bank(|bank| bank.noise.omega)),
            ("bank.noise.torque_time", of_bank(|bank| bank.noise.torque_time)),
            ("interface.period_s", self.interface.period_s),
            ("window", self.window as f64),
        ];
        positive.into_iter().try_for_each(|(key, value)| Flaw::unless_positive(key, value))
    }
}
