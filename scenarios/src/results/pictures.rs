//! Traces for the report.

use super::FaultName;

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
