//! The program from outside: what a command prints, writes and answers, and that bad input ends
//! with exit code 2, a message that names the place, and nothing half-written.

mod architecture;
mod bank;
mod benchmark;
mod campaign;
mod campaign_foreign;
mod compare;
mod diagnose;
mod diagnoser_fmu;
mod discover;
mod docs;
mod drive_files;
mod effects;
mod export;
mod fit;
mod fmu;
mod fmu_parameters;
mod help;
mod imports;
mod init;
mod interrupt;
mod manners;
mod rosa;
mod serve;
mod simulate;
mod study;
mod train_options;
mod worked_example;

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// What a run of the program gave.
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Ran {
    fn of(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// The answer as JSON.
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.out))
    }
}

/// The program in that folder.
pub(crate) fn program(folder: &Path) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_drivescope"));
    program.current_dir(folder).stdin(Stdio::null());
    program
}

/// Runs the program in that folder.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Ran {
    Ran::of(program(folder).args(arguments).output().expect("the program starts"))
}

/// Runs it where it must succeed.
pub(crate) fn done(folder: &Path, arguments: &[&str]) -> Ran {
    let ran = run(folder, arguments);
    assert_eq!(ran.code, Some(0), "{arguments:?}: {}", ran.err);
    ran
}

/// Runs it where it must refuse; the message. No file may appear, vanish or change.
pub(crate) fn refused(folder: &Path, arguments: &[&str]) -> String {
    let before = contents(folder);
    let ran = run(folder, arguments);
    assert_eq!(ran.code, Some(2), "{arguments:?}: {}{}", ran.out, ran.err);
    assert_eq!(ran.out, "", "{arguments:?}");
    assert!(!ran.err.contains("internal error"), "{arguments:?}: {}", ran.err);
    assert_eq!(contents(folder), before, "{arguments:?} left something");
    ran.err
}

/// Every file of the folder with its bytes.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = folder.read_dir().expect("a folder").map(|entry| entry.expect("an entry"));
    let mut files: Vec<_> = entries
        .map(|entry| {
            let bytes = std::fs::read(entry.path()).unwrap_or_default();
            (entry.file_name().to_string_lossy().into_owned(), bytes)
        })
        .collect();
    files.sort();
    files
}

/// A folder of its own for a test.
pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Writes a file into the folder.
pub(crate) fn put(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    std::fs::write(folder.join(name), content).expect("it can be written");
}

/// The values of a column of a CSV recording, by its header.
pub(crate) fn column(folder: &Path, file: &str, header: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(folder.join(file)).expect("the recording is there");
    let mut lines = text.lines();
    let headers: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let at = headers.iter().position(|name| *name == header);
    let at = at.unwrap_or_else(|| panic!("{header} is not among {headers:?}"));
    lines
        .map(|line| line.split(',').nth(at).and_then(|value| value.parse().ok()).expect("a number"))
        .collect()
}
