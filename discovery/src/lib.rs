//! Measured against modelled: fit a drive to recordings, and see where it fails.
//!
//! ```text
//!  Recording ──> Measured ──┐
//!  drive file ──> Drive ────┼──> Case ──> residuals in units of the noise
//!  Noise (given, estimated) ┤         └─> columns: exact derivatives by parameters, starts, and
//!  Setting (frozen) ────────┘             series added to a balance
//! ```
//!
//! [`Measured`] is a recording as that drive's; [`Case`] steps the model along it, corrected by an
//! [`Observer`] of fixed bandwidth where it cannot run free, and yields residuals and, for every
//! [`Direction`], exact derivatives through stick-slip.

mod balances;
mod beside;
mod canonical;
mod case;
mod choice;
pub mod compare;
mod discover;
mod doubt;
mod driving;
mod error;
mod estimate;
mod force;
mod formula;
mod likelihood;
mod measured;
mod noise;
mod observer;
mod residuals;
mod response;
#[cfg(test)]
mod rig;
mod run;
mod sensitivity;
mod settling;
pub mod signals;
mod start;
#[cfg(test)]
mod testing;

pub use balances::{
    Begun, BothUnexplained, Identified, Unexplained, begin, small_inertia, unexplained,
};
pub use canonical::with_canonical_names;
pub use case::{Case, PACE, PASSING_PACE, Setting, Squares};
pub use discover::{
    Balance, Coefficient, Discovery, LearnedCurve, NextExperiment, NotJudged, Oscillation,
    RandomLoad, Ranked, Rule, RuleNumber, Rung, Step, Unwatched, Verdict, Watch, add, bic_of,
    discover, discover_by,
};
pub use doubt::{Doubt, doubts};
pub use driving::{Driving, driving};
pub use error::Error;
pub use estimate::{
    Estimate, Evaluated, Evidence, Fit, Fitted, NotIdentifiable, Options, OutputFits, Seen,
    evaluate, fit, fit_seen, output_fits, with_own,
};
pub use force::{USUAL_BAND_HZ, relative_force_error};
pub use formula::{Formula, FormulaLaw};
pub use measured::{Channel, Measured, Output, Purpose};
pub use noise::{Noise, NoiseSource, noise};
pub use observer::{Observer, USUAL_HZ};
pub use sensitivity::{BLOCK, Direction, Rows};
pub use settling::mechanical_time_s;
pub use start::{Start, first_starts};
