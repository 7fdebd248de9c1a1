//! What a model shows at its recordings, run once however often it is looked at.

use std::sync::OnceLock;

use super::columns::{At, Columns};
use super::ripple::{Trajectory, trajectories};

/// A model at recordings, looked at.
pub(crate) struct Sight<'a> {
    pub(crate) at: At<'a>,
    /// Its parameters that were fitted and that all recordings share.
    pub(crate) shared: Vec<String>,
    columns: OnceLock<Columns>,
    runs: OnceLock<Vec<Trajectory>>,
}

impl<'a> Sight<'a> {
    pub(crate) fn new(at: At<'a>, shared: Vec<String>) -> Self {
        Self { at, shared, columns: OnceLock::new(), runs: OnceLock::new() }
    }

    /// Residuals, and the columns of what was fitted.
    pub(crate) fn columns(&self) -> &Columns {
        self.columns.get_or_init(|| Columns::base(&self.at, &self.shared))
    }

    /// Its runs, linearised.
    pub(crate) fn runs(&self) -> &[Trajectory] {
        self.runs.get_or_init(|| trajectories(&self.at))
    }
}
