//! The plan file: which scenarios a campaign has.
//!
//! Scenario k lies at point k mod P of the grid (the product of all grids of the plan, P points) and
//! is draw k / P there, so that more draws add scenarios behind those there were. What is drawn is a
//! function of (seed, k) alone.

mod check;
mod draw;
mod error;
mod layout;
mod quantity;
mod schema;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use drivescope_plant::drive::Drive;
use drivescope_plant::parameters::NamedParameter;
use sha2::{Digest, Sha256};

use super::foreign::{Entering, ForeignPlant};
use crate::experiment::Experiment;
use crate::profile::Profile;
pub use draw::{Scenario, ScenarioFault, Settings};
pub(super) use draw::{stream_of_fault, stream_of_noise};
use error::Flaw;
pub use error::{PlanError, Problem};
use quantity::{Quantity, Words};
pub use schema::schema_json;

/// Scenarios of a campaign at most.
pub const MOST_SCENARIOS: u64 = 100_000_000;

/// A way to watch a scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Mean +- t_beta std of the residual.
    Constant,
    /// Bands of model error modelling, (6) and (7).
    Bands,
    /// Two-sided CUSUM of whitened innovations.
    Cusum,
    /// Bank of hypotheses on the drive's equations, its machine learned in the run-up.
    Bank,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Constant, Self::Bands, Self::Cusum, Self::Bank];
    /// Those that test the residual of the process model: they watch where a plan names none.
    pub const OF_RESIDUAL: [Self; 3] = [Self::Constant, Self::Bands, Self::Cusum];

    /// Its name in plans and columns.
    pub fn id(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Bands => "bands",
            Self::Cusum => "cusum",
            Self::Bank => "bank",
        }
    }
}

/// A plan that was read and checked.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Name for people.
    pub name: String,
    /// Drive, sampling time and usual set point.
    pub experiment: Experiment,
    /// The drive as the plan names it: one that comes with the program, or a file.
    pub drive_name: String,
    /// The FMU that is the machine in place of the drive, if the plan has one.
    pub foreign: Option<ForeignPlant>,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Samples of a scenario.
    pub samples: usize,
    /// Samples at its start that are not judged.
    pub run_up: usize,
    /// Detectors, in the order of their columns.
    pub methods: Vec<Method>,
    /// Seed of the healthy runs that detectors are designed on.
    pub design_seed: u64,
    /// Healthy samples that widths are measured on.
    pub design_samples: usize,
    /// Hexadecimal digest of what the plan and its drive say, comments and order of keys aside.
    pub digest: String,
    /// The text of the file.
    pub text: String,
    draws: u64,
    points: u64,
    traces: f64,
    set_point: Quantity,
    noise_seed: Option<Quantity>,
    parameters: Vec<(NamedParameter, Quantity)>,
    faults: Vec<FaultPlan>,
    detector: DetectorPlan,
}

/// A fault of a plan.
#[derive(Debug, Clone)]
struct FaultPlan {
    /// Numbers among the mechanisms; nothing for health.
    kind: Words<Option<usize>>,
    size: Quantity,
    onset_s: Quantity,
    duration_s: Option<Quantity>,
    profile: Words<Profile>,
    probability: f64,
}

/// Settings of the detectors.
#[derive(Debug, Clone)]
struct DetectorPlan {
    beta: Quantity,
    window: Quantity,
    arl_0: Quantity,
    kappa: Quantity,
}

impl Plan {
    /// Reads a plan file; its drive is looked for beside it.
    ///
    /// # Errors
    /// [`PlanError`], with line, column and what to do about the first thing that is wrong.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, PlanError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&text, &file, path.parent().unwrap_or(Path::new(""))),
            Err(source) => Err(PlanError::Read { file, source }),
        }
    }

    /// Reads the text of a plan file; `file` is for errors, `folder` where its drive is looked for.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Self, PlanError> {
        check::plan(text, folder).map_err(|flaw: Flaw| flaw.within(file, text))
    }

    /// Scenarios of the campaign.
    pub fn scenarios(&self) -> u64 {
        self.points * self.draws
    }

    /// Parameters of the drive that the plan changes.
    pub fn parameters(&self) -> impl Iterator<Item = &NamedParameter> {
        self.parameters.iter().map(|(parameter, _)| parameter)
    }

    /// Faults that a scenario may have at once.
    pub fn most_faults(&self) -> usize {
        self.faults.len()
    }

    /// Numbers of the mechanisms that its faults may be, in ascending order.
    pub(super) fn mechanisms(&self) -> Vec<usize> {
        let kinds = self.faults.iter().flat_map(|fault| fault.kind.values().iter().flatten());
        let mut kinds: Vec<usize> = kinds.copied().collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// Whether a number of the drive that is `nominal` in its file is above 0 in any scenario.
    pub(super) fn may_be_above_zero(&self, name: &str, nominal: f64) -> bool {
        let changed = self.parameters.iter().find(|(parameter, _)| parameter.name == name);
        changed.map_or(nominal, |(_, quantity)| quantity.bounds().1) > 0.0
    }

    /// What enters a foreign machine: the reference, the noises that there are, its faults.
    pub(super) fn entering(&self) -> Vec<Entering> {
        let noise = &self.drive().noise;
        let noises = [
            (Entering::NoiseReference, "noise.reference", noise.reference),
            (Entering::NoiseSpeed, "noise.omega", noise.omega),
            (Entering::NoiseCurrent, "noise.i", noise.i),
            (Entering::NoiseLoad, "noise.torque", noise.torque),
        ];
        let acts =
            |(_, name, nominal): &(Entering, &str, f64)| self.may_be_above_zero(name, *nominal);
        let noises = noises.into_iter().filter(acts).map(|(noise, ..)| noise);
        let faults = self.mechanisms().into_iter().map(Entering::Fault);
        std::iter::once(Entering::Reference).chain(noises).chain(faults).collect()
    }

    /// Whether scenarios have numbers of noise beside their own.
    pub fn has_noise_seed(&self) -> bool {
        self.noise_seed.is_some()
    }

    /// Whether the signals of a scenario are kept.
    pub fn keeps_trace(&self, scenario: u64) -> bool {
        draw::share_of(self.seed, scenario) < self.traces
    }
}

/// Hexadecimal digest of a drive.
fn digest(parts: &[&str]) -> String {
    let mut sum = Sha256::new();
    for part in parts {
        sum.update((part.len() as u64).to_le_bytes());
        sum.update(part);
    }
    sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Where a drive's file may lie: as given, or beside the plan.
fn places(given: &str, folder: &Path) -> [PathBuf; 2] {
    [folder.join(given), PathBuf::from(given)]
}

impl Plan {
    /// Whether a method tests the residual of the process model.
    pub(super) fn tests_residual(&self) -> bool {
        self.methods.iter().any(|method| Method::OF_RESIDUAL.contains(method))
    }

    /// The nominal drive.
    pub fn drive(&self) -> &Drive {
        &self.experiment.drive
    }
}
