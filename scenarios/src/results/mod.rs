//! What a study finds, as `study.json` holds it. Fractions unless a name says per cent.

mod by_detector;
mod detection;
mod fmu;
mod isolation;
mod models;
mod paper;
mod pictures;
mod setting;

use serde::{Deserialize, Serialize};

use crate::profile::Profile;
use crate::trials::HiddenEffect;

pub use by_detector::ByDetector;
pub use detection::{DetectionRow, FurtherRun, HealthySummary, LevelRows, ReadingRows};
/// A way of watching the residual.
pub use drivescope_diagnoser::DetectorKind;
pub use fmu::{FmpyRow, FmuSummary};
pub use isolation::{
    IdentificationRow, IsolationTable, Merge, Pair, SeparabilitySummary, SizeGroup, SymptomPoints,
};
pub use models::{
    GmdhSummary, ModelSummary, RecurrentErrorSummary, StructureSummary, TheoremRow, TheoremSummary,
};
pub use paper::{DESCRIBED, IN_PAPER, PaperFigures, PaperRates, PaperRow};
pub use pictures::Pictures;
pub use setting::{DriveSummary, FaultName, FaultSpan, NoiseSummary, TorqueReading};

/// The profile of a study that names none.
fn step() -> String {
    Profile::Step.to_string()
}

/// The whole study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyResults {
    /// Seed of every random number.
    pub seed: u64,
    pub drive: DriveSummary,
    /// Standard deviations of the noise, SI.
    pub noise: NoiseSummary,
    /// Reading of "torque fault" that the tables use.
    pub torque: TorqueReading,
    /// Confidence level beta of the bands (two-sided).
    pub beta: f64,
    /// When each fault acts.
    pub fault_span: FaultSpan,
    /// How its size goes over them: `step`, `ramp=5`, ...
    #[serde(default = "step")]
    pub profile: String,
    /// Samples in a row outside the threshold that declare a fault.
    pub window: usize,
    /// One row a fault and detector.
    pub detection: Vec<DetectionRow>,
    /// The rows of the other readings.
    pub readings: Vec<ReadingRows>,
    /// Runs beside the twelve, that were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<FurtherRun>,
    /// The same at other significance levels.
    pub levels: Vec<LevelRows>,
    /// False alarms on healthy runs.
    pub healthy: HealthySummary,
    /// Share of healthy samples outside the threshold, by detector.
    pub r_fd: ByDetector,
    /// How the process model was found and how good it is.
    pub model: ModelSummary,
    /// Structures of the process model that were compared, the paper's among them.
    pub structures: Vec<StructureSummary>,
    /// Theorem 1 on an example.
    pub theorem: TheoremSummary,
    /// Symptoms of every fault (Fig. 5): points (C_m, r).
    pub symptoms: Vec<SymptomPoints>,
    /// Which faults can be told apart by them.
    pub separability: SeparabilitySummary,
    /// Isolation with every fault a class of its own.
    pub isolation: IsolationTable,
    /// Isolation with the paper's ten classes.
    pub isolation_paper: IsolationTable,
    /// Isolation with the classes of our separability test.
    pub isolation_merged: IsolationTable,
    /// Size of the symptom (27), by fault.
    pub identification: Vec<IdentificationRow>,
    /// Smallest detectable faults before and after an effect was added to the model, where that was
    /// asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hidden_effect: Option<HiddenEffect>,
    /// The FMU against the native run, and against fmpy where that was run.
    pub fmu: FmuSummary,
    /// The figures of the reference paper.
    pub paper: PaperFigures,
}
