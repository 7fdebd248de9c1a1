//! Scalars, least squares and tests that the diagnoser and the discovery of missing effects share.
//!
//! [`Real`] is the scalar that all physics is written over: `f64` for a run, [`Dual`] where
//! exact derivatives are wanted. [`elementary`] holds its branch-free functions, which the
//! compiler turns into vector code when they stand inside a loop over lanes; [`dispatch`] compiles that
//! code for what the processor has.
//!
//! With the feature `estimation`, which the physics does without, `Regression` solves linear least
//! squares row by row, `minimise` nonlinear ones; `ljung_box` and `omnibus_normality` test what is
//! left, `aic` weighs it against the number of parameters, `wilson_95` is the interval of a counted
//! share.
//!
//! ```
//! use drivescope_numerics::{Dual, Real};
//!
//! /// A drag and its slope, in one pass.
//! fn drag<R: Real>(omega: R) -> R {
//!     R::constant(3e-6) * omega * omega
//! }
//!
//! let torque = drag(Dual::<1>::parameter(100.0, 0));
//! assert!((torque.v - 0.03).abs() < 1e-15 && (torque.d[0] - 6e-4).abs() < 1e-15);
//! ```

pub mod dispatch;
mod dual;
pub mod elementary;
#[cfg(feature = "estimation")]
mod estimation;
mod real;

pub use dual::Dual;
#[cfg(feature = "estimation")]
pub use estimation::*;
pub use real::Real;
