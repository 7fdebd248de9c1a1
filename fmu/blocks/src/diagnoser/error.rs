//! What can go wrong inside an exported diagnoser.

use std::path::PathBuf;

use drivescope_diagnoser::{FileError, MemoryError};
use drivescope_monitor::MonitorError;
use thiserror::Error;

use super::files::DIAGNOSER_FILE;

/// What can go wrong inside an exported diagnoser.
#[derive(Debug, Error)]
pub enum DiagnoserError {
    /// There is no resources folder.
    #[error(
        "the FMU has no `resources` folder, where its diagnoser file `{DIAGNOSER_FILE}` belongs: unpack it whole"
    )]
    NoResources,
    /// The diagnoser file cannot be used.
    #[error(transparent)]
    File(#[from] FileError),
    /// The stored baseline cannot be read.
    #[error("cannot read the baseline {}: {what}", path.display())]
    Baseline {
        /// Where it should be.
        path: PathBuf,
        /// Why not.
        what: String,
    },
    /// The machine cannot be watched.
    #[error(transparent)]
    Monitor(#[from] MonitorError),
    /// Samples would be passed over.
    #[error(
        "a communication step of {step_s} s passes over samples: the diagnoser takes a row every {period_s} s, let steps be that long or shorter"
    )]
    Step {
        /// The step, s.
        step_s: f64,
        /// Sampling time, s.
        period_s: f64,
    },
    /// Bytes that are no saved state of this diagnoser.
    #[error(transparent)]
    Memory(#[from] MemoryError),
}
