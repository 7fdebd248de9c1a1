//! Detectors of the residual: what each makes of r = y - y_m, sample by sample.
//!
//! One detector, one file: what it is called, how it is designed from a healthy residual, what the
//! diagnoser file holds of it and what it says of each sample. Everything that names detectors (the
//! file, the command line, tables, FMUs) derives from [`registry`].

mod constant;
mod gmdh;
mod law;
mod mem;
mod mem_recurrent;
mod registry;
mod running;

pub use law::{Elsewhere, Info, Refusal, ResidualDetector};
pub use registry::{DetectorKind, DetectorRun, Stored};
pub use running::{Judged, ResidualTest};
