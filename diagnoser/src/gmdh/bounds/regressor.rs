//! A regressor that may be off by a bounded error (13), (14), and why a set may not exist.

use thiserror::Error;

/// Why there is no parameter set.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BoundError {
    /// No parameters respect the noise bounds.
    #[error(
        "no parameters respect the noise bounds: the set became empty at sample {sample} of recording {recording}; widen the bounds or check the data there"
    )]
    Empty {
        /// Recording of the design data, from 0.
        recording: usize,
        sample: usize,
    },
    /// The data leave a direction of the parameters free.
    #[error("the design data do not bound the parameters: give data that excite the neuron more")]
    Unbounded,
    /// The linear program for the smallest noise bound failed.
    #[error("the smallest noise bound cannot be computed: {0}")]
    Program(#[from] microlp::Error),
    /// Stored numbers that describe no set.
    #[error("the stored facets do not describe a bounded parameter set: design it again")]
    Damaged,
}

/// r(k) and the bounds e^m, e^M of what it is off by; no bounds at all if it is exact.
#[derive(Debug, Clone, Copy)]
pub struct Regressor<'a> {
    /// r(k).
    pub values: &'a [f64],
    /// e_i^m, e_i^M, or empty.
    pub errors: &'a [[f64; 2]],
}

impl Regressor<'_> {
    /// r - e with e such that (r - e)^T p is largest (`up`) or smallest over an orthant.
    pub(super) fn extreme(&self, signs: &[i8], up: bool) -> Vec<f64> {
        let Self { values, errors } = *self;
        if errors.is_empty() {
            return values.to_vec();
        }
        let pairs = values.iter().zip(errors).zip(signs);
        pairs.map(|((r, e), sign)| r - e[usize::from((*sign >= 0) != up)]).collect()
    }
}
