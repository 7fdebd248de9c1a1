//! Scalars, least squares and tests that the diagnoser and the discovery of missing effects share.
//!
//! [`Real`] is the scalar that all physics is written over: `f64` for a run, [`Dual`] where
//! exact derivatives are wanted. [`elementary`] holds its branch-free functions, which the
//! compiler turns into vector code when they stand inside a loop over lanes.

//!
//! [`Regression`] solves linear least squares row by row, [`minimise`] nonlinear ones;
//! [`ljung_box`] and [`omnibus_normality`] test what is left, [`aic`] weighs it against the
//! number of parameters, [`wilson_95`] is the interval of a counted share.

mod dual;
pub mod elementary;
mod information;
mod least_squares;
mod levenberg_marquardt;
mod normality;
mod proportion;
mod real;
mod whiteness;

pub use dual::Dual;
pub use information::aic;
pub use least_squares::{LinearFit, Regression, RegressionError};
pub use levenberg_marquardt::{Limits, Linearisation, Minimum, Residuals, Stop, minimise};
pub use normality::{Normality, normal_quantile, omnibus_normality};
pub use proportion::wilson_95;
pub use real::Real;
pub use whiteness::{Whiteness, ljung_box};
