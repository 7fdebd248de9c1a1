//! Least squares, linear and not, and what tests its residuals.

mod information;
mod least_squares;
mod levenberg_marquardt;
mod normality;
mod proportion;
mod whiteness;

pub use information::aic;
pub use least_squares::{LinearFit, Regression, RegressionError};
pub use levenberg_marquardt::{Limits, Linearisation, Minimum, Residuals, Stop, minimise};
pub use normality::{Normality, normal_quantile, omnibus_normality};
pub use proportion::wilson_95;
pub use whiteness::{Whiteness, ljung_box};
