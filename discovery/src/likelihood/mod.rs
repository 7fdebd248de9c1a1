//! One model of what is missing: the drive with a random load and a random voltage as a state
//! space, and the evidence of laws and free curves in it.
//!
//! ```text
//!  fitted drive, recordings ──averaged──> scene ──> ground: randomness by likelihood and parameters
//!                                           │       by Gauss and Newton, in turn
//!                                           └─> filter ──> tracks: innovations, gains, derivatives
//!  plant's laws as duals ──> columns ──whitened by the same filter──> gram: products
//!                                                  └─> marginal: evidence of any set of columns
//! ```
//!
//! [`weigh()`] judges every law at its null and every curve; [`Filtered::with`] a law at its own best.

mod alongside;
mod averaged;
mod base;
mod beginning;
mod climb;
mod columns;
mod cycle;
mod direction;
mod exponential;
mod filter;
mod gram;
mod ground;
mod guess;
mod inverse;
mod judge;
mod linear;
mod marginal;
mod noise;
mod optimum;
mod passes;
mod plant;
mod randomness;
mod rates;
mod refine;
mod rows;
mod scene;
mod search;
mod share;
mod state;
mod stepper;
#[cfg(test)]
mod tests;
mod track;
mod weigh;
mod weighing;
mod weights;

pub(crate) use alongside::{Alongside, GroupEvidence};
pub(crate) use columns::Series;
pub(crate) use ground::Filtered;
pub(crate) use inverse::Inverse;
pub(crate) use optimum::{Law, Optimum};
pub(crate) use randomness::Randomness;
pub(crate) use scene::{Recorded, Scene};
pub(crate) use track::Tick;
pub(crate) use weigh::weigh;
pub(crate) use weights::{CurveWeight, LawWeight, Weights};
