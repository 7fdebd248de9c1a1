//! Telling faults from signals alone: models of signals, residuals, bands, decision.
//!
//! ```text
//!  u ──┬──> SignalModel ── y_m ──> r = y - y_m ──> band exceeded? ──> 50 in a row? ──> declared
//!  y ──┼───────────────────────────────^                ^
//!      └──> detector of the residual: constant band, error model y_e +- t_beta v, ...
//! ```
//!
//! Nothing here knows a drive: a diagnoser is trained on recordings of healthy signals and sees
//! nothing else, so that it works alike on native runs, FMUs and measurements. A [`SignalModel`]
//! simulates the output from the input alone ([`Arx`] and [`Network`] are such models); [`BandDesign`] and
//! [`ErrorBands`] are model error modelling, [`ConstantThreshold`] the plain alternative; a
//! [`Detector`] puts them to work sample by sample, and its [`Trace`] yields rates and times.
//! [`RobustGmdh`] is a second kind of model that brings its own bounds. Behind a declared fault,
//! an [`Isolator`] names its class and [`fault_size`] its size. A [`Diagnoser`] holds them all for
//! one set of signals and is what the file stores; [`Diagnoser::learn`] makes one from recordings,
//! and [`Diagnoser::with_faults`] teaches it faults that were recorded and labelled.
//!
//! Where the physics of the process is known, a [`bank`] of hypotheses does more: it names the
//! mechanism that failed, its size and its onset without having been shown any fault.
//!
//! ```
//! use drivescope_diagnoser::{Column, Confidence, ConstantThreshold, Data};
//!
//! // A healthy residual, and one to be judged.
//! let residual: Vec<f64> = (0..2000).map(|k| (f64::from(k) * 12.9898).sin()).collect();
//! let column = Column { name: "r", values: &residual };
//! let healthy = Data::new(vec![column], column)?;
//! let band = ConstantThreshold::design(&healthy, 100)?.band(Confidence::new(0.05)?);
//! assert!(!band.is_exceeded_by(0.5) && band.is_exceeded_by(3.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Equation numbers are those of K. Patan, M. Witczak, J. Korbicz, "Towards robustness in neural
//! network based fault diagnosis", Int. J. Appl. Math. Comput. Sci. 18 (2008), 443-454.

mod arx;
pub mod bank;
mod constant_threshold;
mod cusum;
mod data;
mod decision;
mod design;
mod detector;
mod detectors;
mod diagnoser;
mod file;
mod flaw;
mod gmdh;
mod history;
mod identification;
mod interface;
mod isolation;
mod lanes;
mod memory;
mod model;
mod model_error;
mod network;
mod parts;
mod range;
mod recipe;
mod scale;
mod signal_model;
mod stability;
mod stored_error;
#[cfg(test)]
mod testing;
mod threshold;
mod verdict;
mod windows;

pub use arx::{
    Arx, ArxError, ArxFit, ArxRun, FreeRunOrders, FreeRunRow, OrderRow, OrderTable, Orders,
};
pub use constant_threshold::ConstantThreshold;
pub use cusum::{Cusum, CusumError, CusumLanes, CusumStep, Whitening, threshold_for};
pub use data::{Column, Data, DataError};
pub use decision::{Detection, RunRule, SpanError, Trace};
pub use design::{Design, DesignError, DesignReport, ErrorModel};
pub use detector::{Detector, DetectorError};
pub use detectors::{
    DetectorKind, DetectorRun, Elsewhere, Info, Judged, Refusal, ResidualDetector, ResidualTest,
    Stored,
};
pub use diagnoser::{Diagnoser, DiagnosisError};
/// When a Levenberg-Marquardt search stops.
pub use drivescope_numerics::Limits;
pub use file::{FileError, SCHEMA};
pub use flaw::Flaw;
pub use gmdh::{
    Activation, BoundError, BoundOptions, Gmdh, GmdhBands, GmdhError, GmdhNeuron, GmdhOptions,
    GmdhReport, GmdhRun, LayerRow, LocallyRecurrent, NeuronBounds, NeuronOrders, Orthants,
    ParameterSet, Part, RecurrentLayer, Regressor, RobustError, RobustGmdh, Source, Uncertain,
};
pub use identification::{Size, fault_size, size_groups};
pub use interface::{Channel, Interface, InterfaceError};
pub use isolation::{
    Cloud, Discriminant, FaultSymptoms, FaultsError, FaultsReport, FaultyRun, Isolated,
    IsolationError, IsolationMatrix, IsolationReport, Isolator, IsolatorOptions, KnownFaults, Mlp,
    MlpSize, Named, Naming, Partition, Separability, SymptomError, Symptoms, discriminant,
    symptoms_of,
};
pub use lanes::ModelLanes;
pub use memory::{Memory, MemoryError, Walk, recall, remember};
pub use model::{Model, ModelRun};
pub use model_error::{BandDesign, ErrorBands};
pub use network::{
    ApproximationExample, ApproximationRow, FirNeuron, IirNeuron, Method, Network, NetworkRun,
    Selection, StartRow, Structure, StructureRow, Theta, Trained, Training, TrainingError, train,
};
pub use parts::Parts;
pub use range::{OperatingRange, RangeWatch};
pub use recipe::{Learned, Recipe, RecipeError, Sets};
pub use scale::Scale;
pub use signal_model::{SignalModel, Start, free_run, residual};
pub use stored_error::ModelError;
pub use threshold::{Band, Confidence, ConfidenceError, Threshold};
pub use verdict::Verdict;
pub use windows::{
    Baseline, FALSE_RUNS, FOLLOWED, Lag, LagRun, Standstill, WindowError, WindowWatch, Windows,
};
