//! What a study finds, as `study.json` holds it. Fractions unless a name says per cent.

use serde::{Deserialize, Serialize};

/// The whole study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyResults {
    /// Seed of every random number.
    pub seed: u64,
    /// The drive.
    pub drive: DriveSummary,
    /// Standard deviations of the noise, SI.
    pub noise: NoiseSummary,
    /// Reading of "torque fault" that the tables use.
    pub torque: TorqueReading,
    /// Confidence level beta of the bands (two-sided).
    pub beta: f64,
    /// When each fault acts.
    pub fault_span: FaultSpan,
    /// Samples in a row outside the threshold that declare a fault.
    pub window: usize,
    /// One row a fault and method.
    pub detection: Vec<DetectionRow>,
    /// The rows of the other readings.
    pub readings: Vec<ReadingRows>,
    /// False alarms on healthy runs.
    pub healthy: HealthySummary,
    /// Share of healthy samples outside the threshold, by method.
    pub r_fd: ByMethod,
    /// How the process model was found and how good it is.
    pub model: ModelSummary,
    /// Size of the symptom (27), by fault.
    pub identification: Vec<IdentificationRow>,
    /// The FMU against the native run, and against fmpy where that was run.
    pub fmu: FmuSummary,
    /// The figures of the reference paper.
    pub paper: PaperFigures,
}

/// A drive in a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveSummary {
    /// Its name.
    pub name: String,
    /// Hexadecimal digest of its file.
    pub digest: String,
    /// Set point of the experiment in the unit of T.
    pub set_point: f64,
    /// Unit of T.
    pub tacho_unit: String,
    /// Sampling time, s.
    pub period_s: f64,
}

/// Standard deviations, SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NoiseSummary {
    /// Reference, rad/s (m/s).
    pub reference: f64,
    /// Tachometer, rad/s (m/s).
    pub omega: f64,
    /// Current, A.
    pub i: f64,
    /// Disturbance torque, N m (N).
    pub torque: f64,
    /// Its correlation time, s.
    pub torque_time: f64,
}

/// The samples over which a fault acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultSpan {
    /// The first.
    pub from: usize,
    /// The first after it.
    pub to: usize,
}

/// What "motor torque increased by a share" means (the paper does not say).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueReading {
    /// Excitation flux: K_m and K_e change.
    Flux,
    /// K_m alone changes.
    TorqueConstant,
    /// The amplifier's gain changes.
    Actuator,
    /// A load of that share of the rated torque.
    Load,
}

impl TorqueReading {
    /// Every reading, the default first.
    pub const ALL: [Self; 4] = [Self::Flux, Self::TorqueConstant, Self::Actuator, Self::Load];

    /// The fault mechanism of the plant.
    pub fn mechanism(self) -> &'static str {
        match self {
            Self::Flux => "flux",
            Self::TorqueConstant => "torque_constant",
            Self::Actuator => "actuator",
            Self::Load => "load",
        }
    }
}

/// A fault by what it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultName {
    /// Mechanism.
    pub kind: String,
    /// Size, a fraction.
    pub size: f64,
    /// The paper's label.
    pub label: String,
}

/// A way of watching the residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Adaptive bands by model error modelling.
    Mem,
    /// Constant thresholds.
    Constant,
}

impl Method {
    /// Every method of the study, in the order of the tables.
    pub const ALL: [Self; 2] = [Self::Mem, Self::Constant];

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Mem => "model error modelling",
            Self::Constant => "constant thresholds",
        }
    }
}

/// How one method saw one fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectionRow {
    /// The fault.
    pub fault: FaultName,
    /// The method.
    pub method: Method,
    /// Share of faulty samples outside the threshold.
    pub r_td: f64,
    /// Sample at which the fault was declared, none if it was not.
    pub t_dt: Option<usize>,
    /// Samples from the fault's start to its declaration.
    pub delay: Option<usize>,
    /// Declarations before the fault started.
    pub false_alarms: usize,
}

/// The rows of one reading of the torque fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReadingRows {
    /// The reading.
    pub torque: TorqueReading,
    /// One row a fault and method.
    pub detection: Vec<DetectionRow>,
}

/// A number for each method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ByMethod<T = f64> {
    /// Model error modelling.
    pub mem: T,
    /// Constant thresholds.
    pub constant: T,
}

impl<T> ByMethod<T> {
    /// One value a method.
    pub fn from_fn(mut value: impl FnMut(Method) -> T) -> Self {
        Self { mem: value(Method::Mem), constant: value(Method::Constant) }
    }
}

impl<T: Copy> ByMethod<T> {
    /// The one of this method.
    pub fn of(&self, method: Method) -> T {
        match method {
            Method::Mem => self.mem,
            Method::Constant => self.constant,
        }
    }
}

/// Healthy evaluation runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HealthySummary {
    /// Samples judged, run-up excluded.
    pub samples: usize,
    /// Runs.
    pub runs: usize,
    /// Samples of each run that are not judged, from its start.
    pub run_up: usize,
    /// Faults declared.
    pub alarms: ByMethod<usize>,
}

/// The process model and its error model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelSummary {
    /// What it is, in words.
    pub process_model: String,
    /// Samples it was trained on.
    pub training_samples: usize,
    /// Standard deviation of its free-run error on the training run, unit of T.
    pub training_sd: f64,
    /// Standard deviation of its residual on healthy closed-loop design data, unit of T.
    pub residual_sd: f64,
    /// Mean of that residual, unit of T.
    pub residual_mean: f64,
    /// Past outputs of the error model.
    pub n_a: usize,
    /// Past inputs of the error model.
    pub n_b: usize,
    /// Sum of squared one-step errors of the error model over the test samples, on signals
    /// scaled to unit variance.
    pub error_model_sse: f64,
    /// Samples of that sum.
    pub error_model_samples: usize,
    /// v of (6), (7): standard deviation of r - y_e on healthy data, unit of T.
    pub v: f64,
    /// p value of the whiteness test on r - y_e.
    pub whiteness_p: f64,
    /// p value of the normality test on r - y_e.
    pub normality_p: f64,
    /// Constant thresholds, unit of T.
    pub constant: (f64, f64),
}

/// Size of a symptom (27).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdentificationRow {
    /// The fault.
    pub fault: FaultName,
    /// Mean of |r| over the constant threshold while the fault acts.
    #[serde(rename = "S")]
    pub s: f64,
    /// The paper's S.
    #[serde(rename = "S_paper")]
    pub s_paper: f64,
}

/// How well the FMU agrees with others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FmuSummary {
    /// Greatest difference from the native runs, relative to each signal's greatest magnitude.
    pub max_relative_difference_native: f64,
    /// Runs in fmpy, if they were made.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fmpy: Vec<FmpyRow>,
}

/// One fmpy run against ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FmpyRow {
    /// The fault.
    pub fault: FaultName,
    /// Version of FMI: 2 or 3.
    pub fmi: u8,
    /// `CS` or `ME`.
    pub kind: String,
    /// Greatest difference, relative to each signal's greatest magnitude.
    pub max_relative_difference: f64,
}

/// Figures of the reference paper, for the tables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PaperFigures {
    /// Table 1, a row a fault and method.
    pub detection: Vec<PaperRow>,
    /// False detection rates.
    pub r_fd: ByMethod,
    /// Sum of squared errors of the paper's ARX error model over 3000 samples.
    pub arx_sse: f64,
}

/// A row of the paper's Table 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PaperRow {
    /// The paper's label.
    pub label: String,
    /// The method.
    pub method: Method,
    /// Share of faulty samples outside the threshold.
    pub r_td: f64,
    /// Sample of the declaration.
    pub t_dt: usize,
}

/// Traces of one run for the pictures of the report: one value a sample, from sample 0.
/// A value that is not finite was not computed (the run-up of a band).
#[derive(Debug, Clone, PartialEq)]
pub struct Pictures {
    /// The fault; none for a healthy run.
    pub fault: Option<FaultName>,
    /// Control signal, V.
    pub c_m: Vec<f64>,
    /// Tachometer signal.
    pub t: Vec<f64>,
    /// Residual r = T - y_m.
    pub residual: Vec<f64>,
    /// Lower adaptive band on the residual.
    pub lower: Vec<f64>,
    /// Upper adaptive band on the residual.
    pub upper: Vec<f64>,
    /// Sample at which model error modelling declared the fault.
    pub declared: Option<usize>,
}
