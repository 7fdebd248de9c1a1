//! Scalars, least squares and tests that the diagnoser and the discovery of missing effects share.
//!
//! [`Real`] is the scalar that all physics is written over: `f64` for a run, [`Dual`] where
//! exact derivatives are wanted. [`elementary`] holds its branch-free functions, which the
//! compiler turns into vector code when they stand inside a loop over lanes.

mod dual;
pub mod elementary;
mod real;

pub use dual::Dual;
pub use real::Real;
