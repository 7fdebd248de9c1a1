//! `NAME=REC`: a recording and the fault that it shows.

use std::path::PathBuf;
use std::str::FromStr;

/// A recording of a fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Labelled {
    /// Name of the fault.
    pub(super) name: String,
    /// The recording.
    pub(super) file: PathBuf,
}

impl FromStr for Labelled {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, file) = text.split_once('=').unwrap_or(("", text));
        let name = name.trim();
        if name.is_empty() || file.is_empty() {
            return Err("give NAME=REC: a name for the fault, and a recording of it".to_owned());
        }
        if name == "unknown" || name.contains(char::is_control) {
            return Err(format!("{name:?} cannot be the name of a fault"));
        }
        Ok(Self { name: name.to_owned(), file: file.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_before_its_recording() {
        let labelled: Labelled = "gain +10 %=runs/a=b.csv".parse().unwrap();
        assert_eq!((&*labelled.name, labelled.file), ("gain +10 %", "runs/a=b.csv".into()));
        for wrong in ["a.csv", "=a.csv", "worn=", "unknown=a.csv", "a\u{1b}=b"] {
            assert!(wrong.parse::<Labelled>().is_err(), "{wrong}");
        }
    }
}
