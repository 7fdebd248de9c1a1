//! One model of what is missing: the drive with a random load and a random voltage as a state
//! space, and the evidence of laws and free curves in it.
//!
//! ```text
//!  fitted drive, recordings ──> scene ──> randomness: load, voltage, noise by likelihood
//!                                 └─> filter ──> tracks: innovations, gains, derivatives
//!  plant's laws as duals ──> columns ──whitened by the same filter──> gram: products
//!                                                  └─> marginal: evidence of any set of columns
//! ```
//!
//! [`weigh()`] judges every law at its null and every curve; [`optimum()`] a law that was fitted.

mod base;
mod columns;
mod filter;
mod gram;
mod marginal;
mod optimum;
mod randomness;
mod scene;
#[cfg(test)]
mod tests;
mod weigh;

pub(crate) use gram::References;
pub(crate) use optimum::{Law, Optimum, optimum};
pub(crate) use randomness::Randomness;
pub(crate) use scene::Scene;
pub(crate) use weigh::{CurveWeight, LawWeight, Weights, weigh};
