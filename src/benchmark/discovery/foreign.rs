//! Cases of the independent generators: Python programs that ship inside this one.
//!
//! They integrate in their own way and their laws differ in form from the library's, so that a
//! discovery cannot succeed by knowing the simulator.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use drivescope_plant::drive::Drive;
use drivescope_recording::{ReadOptions, Recording, read};
use miette::{IntoDiagnostic as _, WrapErr as _};

use super::{Case, Group};
use crate::failure::{Failure, told};

macro_rules! package {
    ($($name:literal),+ $(,)?) => {
        &[
            ("make_recordings.py", include_str!("../../../tools/make_recordings.py")),
            $((
                concat!("generators/", $name),
                include_str!(concat!("../../../tools/generators/", $name)),
            )),+
        ]
    };
}

/// Every file of the generators.
const PACKAGE: &[(&str, &str)] = package![
    "__init__.py",
    "axis.py",
    "balance.py",
    "cases.py",
    "electrical.py",
    "excitation.py",
    "files.py",
    "friction.py",
    "laws.py",
    "machine.py",
    "measuring.py",
    "mechanism.py",
    "position.py",
    "sensing.py",
    "stepping.py",
    "unknown.py",
];

/// What is asked of the generators, and its share of their cases.
const ORDERS: [(Group, f64, &[&str]); 6] = [
    (Group::Hidden, 0.30, &["--hidden", "library"]),
    (Group::HiddenLoaded, 0.20, &["--hidden", "library", "--coloured"]),
    (Group::Null, 0.14, &["--hidden", "none"]),
    (Group::NullLoaded, 0.12, &["--hidden", "none", "--coloured"]),
    (Group::NullZeroSpeed, 0.12, &["--hidden", "none", "--smooth"]),
    (Group::Outside, 0.12, &["--hidden", OUTSIDE]),
];
const OUTSIDE: &str = "x_speed_bump,x_tight_spot,x_curved_resistance,x_touch,x_leaning_field";

/// A Python with numpy.
#[derive(Debug, Clone)]
pub(crate) struct Python {
    program: PathBuf,
}

impl Python {
    /// The given one, or `python3` on the path.
    pub(crate) fn new(given: Option<PathBuf>) -> Self {
        Self { program: given.unwrap_or_else(|| PathBuf::from("python3")) }
    }

    /// About that many cases.
    ///
    /// # Errors
    /// There is no such Python, or it has no numpy.
    pub(super) fn cases(&self, count: usize, seed: u64) -> miette::Result<Vec<Case>> {
        let has_numpy = Command::new(&self.program)
            .args(["-c", "import numpy"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        if !has_numpy.is_ok_and(|status| status.success()) {
            let what = format!("{} has no numpy, or is no Python", self.program.display());
            let instead =
                "name a Python 3.10 or later with numpy by DRIVESCOPE_PYTHON, or install \
                           numpy: half of the cases come from independent generators"
                    .to_owned();
            return Err(Failure::Usage { what, instead }.into());
        }
        let folder = tempfile::tempdir().into_diagnostic()?;
        std::fs::create_dir(folder.path().join("generators")).into_diagnostic()?;
        for (name, text) in PACKAGE {
            std::fs::write(folder.path().join(name), text).into_diagnostic()?;
        }
        let mut all = Vec::new();
        for (number, (group, share, order)) in ORDERS.iter().enumerate() {
            crate::interrupt::check()?;
            let some = (share * count as f64).round() as usize;
            if some > 0 {
                let out = folder.path().join(number.to_string());
                self.make(folder.path(), &out, some, seed.wrapping_add(number as u64), order)?;
                all.extend(read_all(&out, *group)?);
            }
        }
        Ok(all)
    }

    fn make(
        &self,
        folder: &Path,
        out: &Path,
        count: usize,
        seed: u64,
        order: &[&str],
    ) -> miette::Result<()> {
        let made = Command::new(&self.program)
            .current_dir(folder)
            .arg("make_recordings.py")
            .arg(out)
            .args(["--cases", &count.to_string(), "--seed", &seed.to_string()])
            .args(order)
            .output()
            .into_diagnostic()?;
        if made.status.success() {
            return Ok(());
        }
        let told = String::from_utf8_lossy(&made.stderr).into_owned();
        Err(miette::miette!("{told}")).wrap_err("the generators of recordings failed")
    }
}

fn read_all(out: &Path, group: Group) -> miette::Result<Vec<Case>> {
    let mut folders: Vec<PathBuf> = std::fs::read_dir(out)
        .into_diagnostic()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    folders.iter().map(|folder| read_one(folder, group)).collect()
}

fn read_one(folder: &Path, group: Group) -> miette::Result<Case> {
    let options = ReadOptions { columns: Vec::new(), resample: None };
    let recording = |name: &str| -> miette::Result<Recording> {
        Ok(read(folder.join(name), &options).map_err(told)?.0)
    };
    let truth = std::fs::read_to_string(folder.join("truth.json")).into_diagnostic()?;
    let truth: serde_json::Value = serde_json::from_str(&truth).into_diagnostic()?;
    Ok(Case {
        group,
        foreign: true,
        hidden: truth["hidden"].as_str().map(str::to_owned).into_iter().collect(),
        drive: Drive::read(folder.join("drive.toml")).map_err(told)?,
        estimation: recording("estimation.csv")?,
        validation: recording("validation.csv")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_package_is_whole() {
        for (name, text) in PACKAGE {
            for line in text.lines().filter_map(|line| line.strip_prefix("from .")) {
                let module = line.split_whitespace().next().unwrap_or_default();
                let needed = format!("generators/{module}.py");
                let there = PACKAGE.iter().any(|(other, _)| *other == needed);
                assert!(module == "import" || there, "{name} needs {needed}");
            }
        }
    }

    #[test]
    fn a_python_that_is_none_is_said() {
        let python = Python::new(Some(PathBuf::from("no-such-python")));
        let error = format!("{:?}", python.cases(4, 1).expect_err("there is none"));
        assert!(error.contains("DRIVESCOPE_PYTHON"), "{error}");
    }

    #[test]
    fn the_shares_are_all_there_is() {
        let sum: f64 = ORDERS.iter().map(|order| order.1).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }
}
