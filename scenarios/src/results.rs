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
    /// The same at other significance levels.
    pub levels: Vec<LevelRows>,
    /// False alarms on healthy runs.
    pub healthy: HealthySummary,
    /// Share of healthy samples outside the threshold, by method.
    pub r_fd: ByMethod,
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
    /// Adaptive bands by model error modelling, ARX error model.
    Mem,
    /// The same with a recurrent error model.
    MemRecurrent,
    /// Constant thresholds.
    Constant,
    /// Intervals of the GMDH network with bounded parameters.
    Gmdh,
}

impl Method {
    /// Every method of the study, in the order of the tables.
    pub const ALL: [Self; 4] = [Self::Mem, Self::MemRecurrent, Self::Constant, Self::Gmdh];
    /// Those of which the paper has figures.
    pub const IN_PAPER: [Self; 2] = [Self::Mem, Self::Constant];

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Mem => "model error modelling",
            Self::MemRecurrent => "recurrent error model",
            Self::Constant => "constant thresholds",
            Self::Gmdh => "robust GMDH network",
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

/// What changes where the bands are designed for another significance level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelRows {
    /// Significance level beta.
    pub beta: f64,
    /// Share of healthy samples outside, by method.
    pub r_fd: ByMethod,
    /// Faults declared on healthy runs.
    pub alarms: ByMethod<usize>,
    /// One row a fault and method.
    pub detection: Vec<DetectionRow>,
    /// The rows of the other readings.
    pub readings: Vec<ReadingRows>,
}

/// A number for each method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ByMethod<T = f64> {
    /// Model error modelling, ARX error model.
    pub mem: T,
    /// The same with a recurrent error model.
    pub mem_recurrent: T,
    /// Constant thresholds.
    pub constant: T,
    /// Robust GMDH network.
    pub gmdh: T,
}

impl<T> ByMethod<T> {
    /// One value a method.
    pub fn from_fn(mut value: impl FnMut(Method) -> T) -> Self {
        Self {
            mem: value(Method::Mem),
            mem_recurrent: value(Method::MemRecurrent),
            constant: value(Method::Constant),
            gmdh: value(Method::Gmdh),
        }
    }

    /// The one of this method.
    pub fn get(&self, method: Method) -> &T {
        match method {
            Method::Mem => &self.mem,
            Method::MemRecurrent => &self.mem_recurrent,
            Method::Constant => &self.constant,
            Method::Gmdh => &self.gmdh,
        }
    }

    /// The one of this method, to change.
    pub fn get_mut(&mut self, method: Method) -> &mut T {
        match method {
            Method::Mem => &mut self.mem,
            Method::MemRecurrent => &mut self.mem_recurrent,
            Method::Constant => &mut self.constant,
            Method::Gmdh => &mut self.gmdh,
        }
    }
}

impl<T: Copy> ByMethod<T> {
    /// The one of this method.
    pub fn of(&self, method: Method) -> T {
        *self.get(method)
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
    /// Samples that v and the constant thresholds were measured on.
    pub design_samples: usize,
    /// Constant thresholds, unit of T.
    pub constant: (f64, f64),
    /// The recurrent error model.
    pub recurrent_error: Option<RecurrentErrorSummary>,
    /// The GMDH network.
    pub gmdh: Option<GmdhSummary>,
}

/// The recurrent error model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecurrentErrorSummary {
    /// IIR neurons.
    pub v1: usize,
    /// FIR neurons.
    pub v2: usize,
    /// Order of their filters.
    pub order: usize,
    /// v of (6), (7), unit of T.
    pub v: f64,
    /// p value of the whiteness test on r - y_e.
    pub whiteness_p: f64,
    /// p value of the normality test on r - y_e.
    pub normality_p: f64,
}

/// The GMDH network and the bounds of its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GmdhSummary {
    /// Validation error of the best neuron of every layer tried, root mean square, unit of T.
    pub layers: Vec<f64>,
    /// Layers kept.
    pub kept: usize,
    /// Neurons left after pruning.
    pub neurons: usize,
    /// Validation error after all were trained together, unit of T.
    pub validation: f64,
    /// epsilon^m and epsilon^M (10) of the runs that are watched, unit of T.
    pub noise: [f64; 2],
    /// Vertices of the parameter set of the output neuron.
    pub vertices: usize,
}

/// One structure of the process model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StructureSummary {
    /// IIR neurons.
    pub v1: usize,
    /// FIR neurons.
    pub v2: usize,
    /// Order of their filters.
    pub order: usize,
    /// Parameters as written.
    pub parameters: usize,
    /// Parameters that the behaviour depends on: K.
    pub effective_parameters: usize,
    /// N ln(SSE / N) + 2 K on estimation data.
    pub aic: f64,
    /// Free-run error on validation data, root mean square, unit of T.
    pub validation: f64,
    /// Whether it is the paper's.
    pub paper: bool,
    /// Whether it has the smallest AIC.
    pub best: bool,
}

/// Theorem 1 on an example: z(k+1) = tanh(0.6 z(k) + 0.8 u(k)), inputs that no network was trained on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TheoremSummary {
    /// The error that was to be reached.
    pub epsilon: f64,
    /// Samples I over which the greatest error is taken.
    pub horizon: usize,
    /// Networks, the larger the later.
    pub rows: Vec<TheoremRow>,
}

/// A network in place of the example.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TheoremRow {
    /// IIR neurons.
    pub v1: usize,
    /// FIR neurons.
    pub v2: usize,
    /// Order of their filters.
    pub order: usize,
    /// Greatest error over the horizon and all test inputs.
    pub max_error: f64,
}

/// Symptoms of one fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SymptomPoints {
    /// The fault.
    pub fault: FaultName,
    /// (C_m, r), V and unit of T.
    pub points: Vec<[f64; 2]>,
}

/// Two faults that share a class, by their names.
pub type Pair = [String; 2];

/// Which faults can be told apart by their symptoms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeparabilitySummary {
    /// Share of samples of a fault taken for another from which on the two share a class.
    pub limit: f64,
    /// Share of samples of fault i taken for fault j, faults in the order of `symptoms`.
    pub confusion: Vec<Vec<f64>>,
    /// Our classes, by the names of their faults.
    pub classes: Vec<Vec<String>>,
    /// The paper's.
    pub classes_paper: Vec<Vec<String>>,
    /// Pairs that share a class here and not in the paper.
    pub merged_only_here: Vec<Pair>,
    /// Pairs that share a class in the paper and not here.
    pub merged_only_in_paper: Vec<Pair>,
}

/// Answers of a classifier to samples of every fault that it was not trained on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IsolationTable {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// Names of the faults, a row each.
    pub faults: Vec<String>,
    /// Shares: rows true faults, columns answered classes, the last column `unknown`.
    pub matrix: Vec<Vec<f64>>,
    /// Class of each fault.
    pub class_of: Vec<usize>,
}

impl IsolationTable {
    /// Share of the samples of a fault that were answered with its class.
    pub fn right(&self, fault: usize) -> f64 {
        let row = self.matrix.get(fault).zip(self.class_of.get(fault));
        row.and_then(|(row, class)| row.get(*class).copied()).unwrap_or(f64::NAN)
    }
}

/// Size of a fault relative to the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SizeGroup {
    /// Of the smallest.
    Small,
    /// Between.
    Medium,
    /// Of the largest.
    Large,
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
    /// Its group among the twelve.
    pub group: SizeGroup,
    /// The paper's group.
    pub group_paper: SizeGroup,
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
    pub r_fd: PaperRates,
    /// Sum of squared errors of the paper's ARX error model over 3000 samples.
    pub arx_sse: f64,
    /// Table 2: shares, a row a fault, a column a class C_1 .. C_10.
    pub isolation: Vec<Vec<f64>>,
}

/// The paper's false detection rates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaperRates {
    /// Model error modelling.
    pub mem: f64,
    /// Constant thresholds.
    pub constant: f64,
}

impl PaperRates {
    /// The one of this method, if the paper has it.
    pub fn of(&self, method: Method) -> Option<f64> {
        match method {
            Method::Mem => Some(self.mem),
            Method::Constant => Some(self.constant),
            Method::MemRecurrent | Method::Gmdh => None,
        }
    }
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
