//! Cases of the independent generators: Python programs that ship inside this one.
//!
//! They integrate in their own way and their laws differ in form from the library's, so that a
//! discovery cannot succeed by knowing the simulator.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use drivescope_plant::drive::Drive;
use drivescope_recording::{ReadOptions, read};
use miette::IntoDiagnostic as _;
use serde::Deserialize;

use super::{Case, Grade, Group, Record};
use crate::failure::{Failure, into_report};

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
    "channels.py",
    "control.py",
    "electrical.py",
    "excitation.py",
    "files.py",
    "friction.py",
    "laws.py",
    "loads/__init__.py",
    "loads/ornstein_uhlenbeck.py",
    "loads/oscillation.py",
    "loads/random_walk.py",
    "loads/shots.py",
    "loads/sine.py",
    "loads/telegraph.py",
    "machine.py",
    "measuring.py",
    "mechanism.py",
    "operating.py",
    "position.py",
    "sensing.py",
    "sizes.py",
    "stepping.py",
    "unknown.py",
    "wide.py",
];

/// What is asked of the generators in each group, and its share of their cases.
const ORDERS: [(Group, f64, &[&str]); 7] = [
    (Group::Hidden, 0.24, &["--hidden", "library"]),
    (Group::HiddenLoaded, 0.16, &["--hidden", "library", "--coloured"]),
    (Group::Null, 0.14, &["--hidden", "none"]),
    (Group::NullLoaded, 0.12, &["--hidden", "none", "--coloured"]),
    (Group::NullZeroSpeed, 0.12, &["--hidden", "none", "--smooth"]),
    (Group::Outside, 0.10, &["--hidden", OUTSIDE]),
    (Group::Graded, 0.12, &["--hidden", "library"]),
];
const OUTSIDE: &str = "x_speed_bump,x_tight_spot,x_curved_resistance,x_touch,x_leaning_field";

/// A Python with numpy.
#[derive(Debug, Clone)]
pub(crate) struct Python {
    program: PathBuf,
}

impl Python {
    /// That program.
    pub(crate) fn new(program: PathBuf) -> Self {
        Self { program }
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
        for (name, text) in PACKAGE {
            let file = folder.path().join(name);
            if let Some(parent) = file.parent() {
                std::fs::create_dir_all(parent).into_diagnostic()?;
            }
            std::fs::write(file, text).into_diagnostic()?;
        }
        let mut all = Vec::new();
        for (number, order) in orders(count).into_iter().enumerate() {
            crate::interrupt::check()?;
            let out = folder.path().join(number.to_string());
            self.make(folder.path(), &out, &order, seed.wrapping_add(number as u64))?;
            all.extend(read_all(&out, &order)?);
        }
        Ok(all)
    }

    fn make(&self, folder: &Path, out: &Path, order: &Order, seed: u64) -> miette::Result<()> {
        let noise = serde_json::to_value(order.grade.noise).into_diagnostic()?;
        let made = Command::new(&self.program)
            .current_dir(folder)
            .arg("make_recordings.py")
            .arg(out)
            .args(["--cases", &order.cases.to_string(), "--seed", &seed.to_string()])
            .args(["--size", &order.grade.size.to_string()])
            .args(["--noise", noise.as_str().unwrap_or_default()])
            .args(order.arguments)
            .output()
            .into_diagnostic()?;
        if made.status.success() {
            return Ok(());
        }
        let stated = String::from_utf8_lossy(&made.stderr).into_owned();
        let last = stated.lines().last().unwrap_or("it says nothing").to_owned();
        Err(miette::miette!("the generators of recordings failed: {last}"))
    }
}

/// What is asked of the generators at once.
struct Order {
    group: Group,
    grade: Grade,
    cases: usize,
    arguments: &'static [&'static str],
}

/// All orders for about that many cases.
fn orders(count: usize) -> Vec<Order> {
    let mut all = Vec::new();
    for (group, share, arguments) in ORDERS {
        let usual = [Grade::USUAL];
        let grades = if group == Group::Graded { Grade::OTHERS.as_slice() } else { &usual };
        let cases = (share * count as f64 / grades.len() as f64).round() as usize;
        all.extend(grades.iter().map(|&grade| Order { group, grade, cases, arguments }));
    }
    all.retain(|order| order.cases > 0);
    all
}

fn read_all(out: &Path, order: &Order) -> miette::Result<Vec<Case>> {
    let mut folders: Vec<PathBuf> = std::fs::read_dir(out)
        .into_diagnostic()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    folders.iter().map(|folder| read_one(folder, order)).collect()
}

/// What the generators tell of a case.
#[derive(Deserialize)]
struct Truth {
    hidden: Option<String>,
    /// Of each recording, of each signal, SI.
    noise: BTreeMap<String, BTreeMap<String, f64>>,
}

fn read_one(folder: &Path, order: &Order) -> miette::Result<Case> {
    let truth = std::fs::read_to_string(folder.join("truth.json")).into_diagnostic()?;
    let truth: Truth = serde_json::from_str(&truth).into_diagnostic()?;
    let options = ReadOptions { columns: Vec::new(), ..ReadOptions::default() };
    let record = |name: &str| -> miette::Result<Record> {
        let (recording, _) =
            read(folder.join(format!("{name}.csv")), &options).map_err(into_report)?;
        let noise = truth.noise.get(name).into_iter().flatten();
        Ok(Record { recording, noise: noise.map(|(name, sd)| (name.clone(), *sd)).collect() })
    };
    Ok(Case {
        group: order.group,
        foreign: true,
        grade: order.grade,
        hidden: truth.hidden.iter().cloned().collect(),
        law: None,
        drive: Drive::read(folder.join("drive.toml")).map_err(into_report)?,
        estimation: record("estimation")?,
        validation: record("validation")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every Python file below a folder but tests, from there on.
    fn python_files(folder: &Path) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).expect("it can be read");
        let of = |path: PathBuf| if path.is_dir() { python_files(&path) } else { vec![path] };
        let all = entries.flat_map(|entry| of(entry.expect("an entry").path()));
        let name = |path: &PathBuf| path.file_name().map(|it| it.to_string_lossy().into_owned());
        let of_python = |name: String| name.ends_with(".py") && !name.starts_with("test_");
        all.filter(|path| name(path).is_some_and(of_python)).collect()
    }

    #[test]
    fn the_package_is_whole() {
        let tools = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools");
        let there = python_files(&tools.join("generators"));
        let names = there.iter().map(|path| path.strip_prefix(&tools).expect("it is below"));
        let mut names: Vec<String> = names.map(|it| it.display().to_string()).collect();
        names.push("make_recordings.py".to_owned());
        names.sort();
        let mut shipped: Vec<&str> = PACKAGE.iter().map(|(name, _)| *name).collect();
        shipped.sort_unstable();
        assert_eq!(shipped, names);
    }

    #[test]
    fn the_generators_that_are_shipped_run() {
        let python = Python::new(crate::benchmark::python());
        // Of three cases one has a hidden effect, and the other groups have none.
        let cases = match python.cases(3, 1) {
            Ok(cases) => cases,
            Err(error) if format!("{error:?}").contains("no numpy") => {
                println!("NOT RUN: no Python with numpy; name one by DRIVESCOPE_PYTHON");
                return;
            }
            Err(error) => panic!("{error:?}"),
        };
        assert_eq!(cases.len(), 1);
        assert!(cases[0].foreign && cases[0].hidden.len() == 1);
    }

    #[test]
    fn a_python_that_is_none_is_said() {
        let python = Python::new(PathBuf::from("no-such-python"));
        let error = format!("{:?}", python.cases(4, 1).expect_err("there is none"));
        assert!(error.contains("DRIVESCOPE_PYTHON"), "{error}");
    }

    #[test]
    fn the_shares_are_all_there_is() {
        let sum: f64 = ORDERS.iter().map(|order| order.1).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }
}
