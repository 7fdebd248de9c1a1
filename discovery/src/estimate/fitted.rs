//! What an estimate answers.

use drivescope_plant::drive::Drive;
use nalgebra::DMatrix;
use serde::Serialize;

use super::NotIdentifiable;
use super::unknowns::set;
use crate::case::Squares;
use crate::start::Start;

/// An estimated parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Standard error of the value; NaN (null in files) at a bound, where there is none.
    pub std_error: f64,
    /// The value it had in the drive file; NaN where that has no such parameter.
    pub before: f64,
    pub unit: String,
    /// Whether the search ended at the limit of what is possible.
    pub at_bound: bool,
}

/// What belongs to one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Parameters that may differ from recording to recording.
    pub own: Vec<Estimate>,
    /// State at the beginning of each piece.
    pub starts: Vec<Start>,
    /// Its squared errors.
    pub squares: Squares,
}

/// A drive on recordings it was not fitted to, or as it was before.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluated {
    pub recordings: Vec<Fit>,
    /// Squared errors over all of them.
    pub squares: Squares,
}

/// A drive fitted to recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The drive with the estimates; of what differs between recordings, their mean.
    pub drive: Drive,
    /// Parameters of the machine, in the drive's order.
    pub parameters: Vec<Estimate>,
    /// Correlations of the errors of [`Self::parameters`].
    pub correlation: DMatrix<f64>,
    /// What the recordings do not tell.
    pub not_identifiable: Vec<NotIdentifiable>,
    pub recordings: Vec<Fit>,
    /// Squared errors over all of them.
    pub squares: Squares,
    /// Length of the blocks of the robust standard errors, s.
    pub block_s: f64,
    /// Starts of the search that were tried.
    pub starts_tried: usize,
    /// Whether the values are those of least squares on the balances, because the least error of
    /// the observed motion would explain these worse.
    pub by_balances: bool,
}

impl Fitted {
    /// The drive with what belongs to that recording.
    pub fn drive_of(&self, recording: usize) -> Drive {
        with_own(&self.drive, &self.recordings[recording])
    }
}

/// The drive with what was estimated for one recording.
pub fn with_own(drive: &Drive, fit: &Fit) -> Drive {
    let mut own = drive.clone();
    for estimate in &fit.own {
        set(&mut own, &estimate.name, estimate.value);
    }
    own
}
