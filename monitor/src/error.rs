//! Why a machine cannot be watched.

use drivescope_diagnoser::bank::BaselineError;
use drivescope_diagnoser::{
    ConfidenceError, DetectorError, InterfaceError, IsolationError, WindowError,
};
use drivescope_plant::file::DriveFileError;
use thiserror::Error;

use crate::bank::{ProcessError, RowsError};
use crate::method::Method;

/// Why a machine cannot be watched.
#[derive(Debug, Error)]
pub enum MonitorError {
    /// No significance level.
    #[error(transparent)]
    Confidence(#[from] ConfidenceError),
    /// A detector refuses.
    #[error(transparent)]
    Detector(#[from] DetectorError),
    /// The known faults refuse.
    #[error(transparent)]
    Isolation(#[from] IsolationError),
    /// A signal of the training is missing.
    #[error("there is no signal `{name}`")]
    Signal {
        /// The signal.
        name: String,
    },
    /// A signal in another unit.
    #[error("`{name}` is in {unit}, the diagnoser was trained on {trained}")]
    Unit {
        /// The signal.
        name: String,
        unit: String,
        /// Unit of the training.
        trained: String,
    },
    /// Other signals than those of the training.
    #[error(transparent)]
    Interface(#[from] InterfaceError),
    /// Signals that a bank cannot use.
    #[error(transparent)]
    Rows(#[from] RowsError),
    /// The drive in the diagnoser cannot be read.
    #[error(transparent)]
    Drive(#[from] DriveFileError),
    /// The drive in the diagnoser makes no process.
    #[error(transparent)]
    Process(#[from] ProcessError),
    /// A baseline that windows cannot use.
    #[error("{baseline}: {source}")]
    Windows {
        /// Its name.
        baseline: String,
        /// What is wrong with it.
        source: WindowError,
    },
    /// A baseline that shows no healthy machine of this kind.
    #[error("{baseline}: {source}")]
    Machine {
        /// Its name.
        baseline: String,
        /// What is wrong with it.
        source: BaselineError,
    },
    /// The diagnoser does not hold what was asked for.
    #[error("the diagnoser holds no {}{}", method.label(), if *method == Method::Windows { ", or no baseline was given" } else { "" })]
    Missing { method: Method },
}
