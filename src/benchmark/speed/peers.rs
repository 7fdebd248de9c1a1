//! Programs of other people, in Python: a script that ships inside this one times them.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use drivescope_fmu::description::Version;
use drivescope_plant::drive::Drive;
use miette::IntoDiagnostic as _;
use serde::{Deserialize, Serialize};

use super::super::python;
use super::{Held, SAMPLES};
use crate::fmu_file;

const SCRIPT: &str = include_str!("../../../tools/peers/speed.py");
/// Samples where a quick look is enough.
const SHORT: usize = 500;

/// Seconds a sample; absent where there is no such program, and why.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Peers {
    /// `solve_ivp` at 1e-6 under the same held inputs, anew over every sample.
    pub(crate) scipy_s: Option<f64>,
    /// A loop over `doStep` of the drive's own FMU in `fmpy`, one output read.
    pub(crate) fmpy_loop_s: Option<f64>,
    /// `fmpy.simulate_fmu` of the same.
    pub(crate) fmpy_simulate_s: Option<f64>,
    /// Versions.
    pub(crate) scipy: Option<String>,
    pub(crate) fmpy: Option<String>,
    pub(crate) scipy_why: Option<String>,
    pub(crate) fmpy_why: Option<String>,
}

impl Peers {
    pub(super) fn measure(drive: &Drive, held: &Held, short: bool) -> Self {
        measured(&python(), drive, held, short).unwrap_or_else(|error| {
            let why = Some(error.to_string());
            Self { scipy_why: why.clone(), fmpy_why: why, ..Self::default() }
        })
    }
}

fn measured(python: &Path, drive: &Drive, held: &Held, short: bool) -> miette::Result<Peers> {
    let folder = tempfile::tempdir().into_diagnostic()?;
    let path = |name: &str| folder.path().join(name);
    fmu_file::write(drive, false, Version::Two, &path("drive.fmu"))?;
    let mut rows = String::new();
    for [u, load] in &held.inputs {
        let _ = writeln!(rows, "{u},{load}");
    }
    std::fs::write(path("inputs.csv"), rows).into_diagnostic()?;
    std::fs::write(path("speed.py"), SCRIPT).into_diagnostic()?;
    let mut motor = serde_json::Map::new();
    for it in drive.parameters() {
        // Without the effect that it belongs to: the script has these laws.
        let name = it.name.rsplit('.').next().unwrap_or_default().to_owned();
        motor.entry(name).or_insert(it.value.into());
    }
    for (name, value) in [("i", held.start[0]), ("omega", held.start[1]), ("period", held.period_s)]
    {
        motor.insert(name.to_owned(), value.into());
    }
    let samples = if short { SHORT } else { SAMPLES };
    let ran = Command::new(python)
        .current_dir(folder.path())
        .args(["speed.py", "drive.fmu", "inputs.csv", &samples.to_string()])
        .env("DRIVE", serde_json::Value::Object(motor).to_string())
        .output()
        .map_err(|error| miette::miette!("{}: {error}", python.display()))?;
    if !ran.status.success() {
        let said = String::from_utf8_lossy(&ran.stderr).into_owned();
        return Err(miette::miette!("{}", said.lines().last().unwrap_or("it says nothing")));
    }
    serde_json::from_slice(&ran.stdout).into_diagnostic()
}
