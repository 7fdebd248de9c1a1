//! How a recording is read, kept beside it: what was said once of its columns is not asked again.
//!
//! `log.csv` has its `log.csv.columns.toml`:
//!
//! ```toml
//! resample = 0.001
//!
//! [columns]
//! u = "Voltage"
//! omega = "Speed:rpm"
//! ```

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::mapping::{Mapping, ReadOptions};
use crate::replace::write_whole;

/// What is added to the recording's name.
const ENDING: &str = ".columns.toml";

/// The file as it is written.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    #[serde(skip_serializing_if = "Option::is_none")]
    resample: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rows_every: Option<f64>,
    #[serde(default)]
    columns: BTreeMap<String, String>,
}

impl ReadOptions {
    /// Where the options of a recording are kept: `log.csv.columns.toml` beside `log.csv`.
    pub fn kept_at(recording: &Path) -> PathBuf {
        let mut name = recording.as_os_str().to_owned();
        name.push(ENDING);
        PathBuf::from(name)
    }

    /// What was kept for a recording; nothing where no such file is.
    ///
    /// # Errors
    /// [`Error::Kept`] where the file cannot be read or says what no mapping is.
    pub fn kept(recording: &Path) -> Result<Option<ReadOptions>, Error> {
        let path = Self::kept_at(recording);
        let failed = |reason: String| Error::Kept { file: path.display().to_string(), reason };
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(failed(error.to_string())),
        };
        let Kept { resample, rows_every, columns } =
            toml::from_str(&text).map_err(|error| failed(error.message().to_owned()))?;
        let item = |(signal, column): (&String, &String)| format!("{signal}={column}").parse();
        let columns: Result<Vec<Mapping>, Error> = columns.iter().map(item).collect();
        Ok(Some(ReadOptions { columns: columns?, resample, rows_every, ..ReadOptions::default() }))
    }

    /// The text of the file that keeps the options of a recording.
    ///
    /// # Errors
    /// What TOML cannot hold.
    pub fn kept_text(&self, recording: &Path) -> Result<String, toml::ser::Error> {
        let column = |it: &Mapping| match &it.unit {
            Some(unit) => format!("{}:{unit}", it.foreign),
            None => it.foreign.clone(),
        };
        let columns = self.columns.iter().map(|it| (it.canonical.clone(), column(it))).collect();
        let Self { resample, rows_every, .. } = *self;
        let table = toml::to_string(&Kept { resample, rows_every, columns })?;
        let name = recording.file_name().unwrap_or_default().to_string_lossy();
        Ok(format!("# How {name} is read. Remove this file to have it guessed again.\n{table}"))
    }

    /// Keeps the options for a recording.
    ///
    /// # Errors
    /// [`Error::Write`] where the file cannot be written.
    pub fn keep(&self, recording: &Path) -> Result<PathBuf, Error> {
        let path = Self::kept_at(recording);
        let text = self.kept_text(recording);
        let written = || -> std::io::Result<()> {
            let text = text.map_err(std::io::Error::other)?;
            write_whole(&path, |out| out.write_all(text.as_bytes()))
        };
        written().map_err(|source| Error::Write { file: path.display().to_string(), source })?;
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_said_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        assert_eq!(ReadOptions::kept(&log).unwrap(), None);
        let columns = Mapping::parse_list("omega=Speed \"A\":rpm,u=Volt").unwrap();
        let (resample, rows_every) = (Some(0.001), Some(0.002));
        let said = ReadOptions { columns, resample, rows_every, ..ReadOptions::default() };
        assert_eq!(said.keep(&log).unwrap(), folder.path().join("log.csv.columns.toml"));
        assert_eq!(ReadOptions::kept(&log).unwrap(), Some(said));
    }

    #[test]
    fn what_is_no_mapping_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        std::fs::write(ReadOptions::kept_at(&log), "colums = 3").unwrap();
        let said = ReadOptions::kept(&log).unwrap_err().to_string();
        assert!(said.contains("log.csv.columns.toml") && said.contains("colums"), "{said}");
    }
}
