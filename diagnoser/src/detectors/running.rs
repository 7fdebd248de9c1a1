//! Detectors of the residual at work, sample by sample.

use crate::threshold::{Band, Threshold};

/// What a test says of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Where a healthy residual lies at this sample, output unit.
    pub band: Band,
    /// Whether this one is none.
    pub exceeds: bool,
}

impl Judged {
    /// Judged by whether the residual lies outside the band; NaN does.
    #[inline]
    pub fn by(band: Band, residual: f64) -> Self {
        Self { band, exceeds: band.is_exceeded_by(residual) }
    }
}

/// A detector of the residual as a running instance; its clone is its state.
pub trait ResidualTest: Clone {
    /// Forgets the past.
    fn reset(&mut self);

    /// Begins in the steady state of inputs held at `u`.
    fn settle(&mut self, u: &[f64]);

    /// Takes inputs and residual of the next sample, the residual in the unit of the output.
    fn step(&mut self, u: &[f64], residual: f64) -> Judged;

    /// Forgets the residuals, not the inputs: those of samples that are not judged (while models
    /// settle, at operating points never shown) are to count for nothing later.
    #[inline]
    fn disregard(&mut self) {}

    /// What the residual of a healthy machine is expected to be where its band is this one.
    #[inline]
    fn middle(&self, band: Band) -> f64 {
        0.5 * (band.lower + band.upper)
    }
}

/// A band that follows the inputs alone is a test of the residual.
impl<T: Threshold> ResidualTest for T {
    fn reset(&mut self) {
        Threshold::reset(self);
    }

    fn settle(&mut self, u: &[f64]) {
        Threshold::settle(self, u);
    }

    #[inline]
    fn step(&mut self, u: &[f64], residual: f64) -> Judged {
        Judged::by(self.band(u), residual)
    }
}
