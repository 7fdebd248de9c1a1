//! What a detector says.

/// What a detector says about one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// r = y - y_m, output unit.
    pub residual: f64,
    /// Lower bound of a healthy residual, output unit; y_m + lower is T_l (7).
    pub lower: f64,
    /// Upper bound of a healthy residual, output unit; y_m + upper is T_u (6).
    pub upper: f64,
    /// Whether the residual lies outside; never during the run-up.
    pub exceeds: bool,
    /// Whether a fault stands declared.
    pub declared: bool,
}
