//! What a model shows at its recordings, run once however often it is looked at.

use std::sync::OnceLock;

use super::columns::{At, Columns};
use super::inverse::Inverse;
use super::ripple::{Trajectory, trajectories};

/// A model at recordings, looked at.
pub(crate) struct Sight<'a> {
    pub(crate) at: At<'a>,
    /// Its parameters that were fitted and that all recordings share.
    pub(crate) shared: Vec<String>,
    columns: OnceLock<Columns>,
    runs: OnceLock<Vec<Trajectory>>,
    inverse: OnceLock<Option<Inverse>>,
}

impl<'a> Sight<'a> {
    pub(crate) fn new(at: At<'a>, shared: Vec<String>) -> Self {
        let (columns, runs, inverse) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Self { at, shared, columns, runs, inverse }
    }

    /// Residuals, and the columns of what was fitted.
    pub(crate) fn columns(&self) -> &Columns {
        self.columns.get_or_init(|| Columns::base(&self.at, &self.shared))
    }

    /// Its runs, linearised.
    pub(crate) fn runs(&self) -> &[Trajectory] {
        self.runs.get_or_init(|| trajectories(&self.at))
    }

    /// Its inverse form, where noise does not cover what is left there.
    pub(crate) fn inverse(&self) -> Option<&Inverse> {
        self.inverse.get_or_init(|| Inverse::of(self)).as_ref()
    }
}
