//! Model error modelling: bands around what the process model gets wrong.
//!
//! The residual r = y - y_m of a healthy drive is modelled as the response y_e of an error model
//! to the same input u, and
//!
//! T_u = y_m + y_e + t_beta v (6),   T_l = y_m + y_e - t_beta v (7).
//!
//! Readings taken where the paper is silent: y_e is the free-run response to u (a one-step
//! prediction follows the fault and absorbs it), v is the standard deviation of r - y_e on healthy
//! data (with the literal std(y_e) the bands narrow as the model improves), the error model has a
//! constant and is fitted on healthy data of the loop as it runs. (6), (7) presuppose that r - y_e
//! has mean zero: a fit leaves its free run that mean on the data that it was fitted to, not on
//! others, so the mean over the design data, of which there are more, is added to the error model.
//! The level holds only if r - y_e is normal; that it is, and that it is white, is tested and
//! reported.

use drivescope_numerics::{Normality, Whiteness, ljung_box, omnibus_normality};

use crate::data::{Data, DataError};
use crate::memory::{Memory, MemoryError, Walk};
use crate::signal_model::{SignalModel, Start, residual};
use crate::threshold::{Band, Confidence, Threshold, mean_and_deviation};

/// Lags of the whiteness test: a quarter of a second at the usual 5 ms.
const LAGS: usize = 50;

/// What is known of r - y_e on the healthy data that the bands were designed on.
#[derive(Debug, Clone, PartialEq)]
pub struct BandDesign {
    /// v, the standard deviation of r - y_e, output unit.
    pub deviation: f64,
    /// Standard deviation of r itself over the same samples, output unit.
    pub plain: f64,
    /// Mean of r - y_e before it was taken out, output unit; far below `deviation` if the error
    /// model fits.
    pub mean: f64,
    /// Samples, run-up excluded.
    pub samples: usize,
    /// Ljung-Box test over 50 lags; `None` if there are not more samples than that.
    pub whiteness: Option<Whiteness>,
    /// Omnibus test, the correlation over these lags allowed for; `None` below 20 samples.
    pub normality: Option<Normality>,
}

impl BandDesign {
    /// Runs the error model over healthy data whose output is the residual r, from `start` in every
    /// segment, and measures r - y_e from sample `run_up` on.
    pub fn measure(
        error_model: &mut impl SignalModel,
        healthy: &Data,
        (run_up, start): (usize, Start),
    ) -> Result<Self, DataError> {
        healthy.require_samples(run_up + 2, "the design of bands after their run-up")?;
        healthy.require_variation()?;
        let remainder = &healthy.judged(&residual(error_model, healthy, start), run_up)[..];
        let (mean, deviation) = mean_and_deviation(remainder);
        let whiteness = ljung_box(remainder, LAGS);
        let correlation = whiteness.as_ref().map_or(&[][..], |white| &white.autocorrelation);
        let normality = omnibus_normality(remainder, correlation);
        let (_, plain) = mean_and_deviation(&healthy.judged(healthy.output().values, run_up));
        Ok(Self { deviation, plain, mean, samples: remainder.len(), whiteness, normality })
    }
}

/// The bands (6), (7) as a running instance, written for the residual: y_e +- t_beta v.
#[derive(Debug, Clone)]
pub struct ErrorBands<E> {
    error_model: E,
    half_width: f64,
}

impl<E: SignalModel> ErrorBands<E> {
    /// Bands of half width t_beta x `deviation` around the error model's free run.
    pub fn new(error_model: E, deviation: f64, confidence: Confidence) -> Self {
        Self { error_model, half_width: confidence.t_beta() * deviation }
    }
}

impl<E: SignalModel> Threshold for ErrorBands<E> {
    fn reset(&mut self) {
        self.error_model.reset();
    }

    fn settle(&mut self, u: &[f64]) {
        self.error_model.settle(u);
    }

    #[inline]
    fn band(&mut self, u: &[f64]) -> Band {
        let centre = self.error_model.step(u)[0];
        Band { lower: centre - self.half_width, upper: centre + self.half_width }
    }
}

impl<E: Memory> Memory for ErrorBands<E> {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.error_model.walk(walk)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arx::{Arx, Orders};
    use crate::data::Column;
    use crate::testing::noise;

    const RUN_UP: usize = 100;
    const SAMPLES: usize = 6000;

    /// A residual with structure that the input explains, an offset, and white noise of sd 2.
    fn residual_of(u: &[f64], seed: u64) -> Vec<f64> {
        let e = noise(u.len(), seed);
        let mut state = 0.0;
        u.iter()
            .zip(e)
            .map(|(u, e)| {
                let r = state + 5.0 + 2.0 * e;
                state = 0.9 * state + u;
                r
            })
            .collect()
    }

    #[test]
    fn bands_follow_the_input_and_their_width_is_the_noise() {
        let u = noise(SAMPLES, 1);
        let r = residual_of(&u, 2);
        let data =
            Data::new(vec![Column { name: "u", values: &u }], Column { name: "r", values: &r })
                .unwrap();
        let orders = Orders { n_a: 20, n_b: 20, constant: true };
        let mut run = Arx::fit(&data, orders).unwrap().model.run();
        let design = BandDesign::measure(&mut run, &data, (RUN_UP, Start::Rest)).unwrap();
        // The noise is 2; std(r) is near 3, std(y_e) near 2.3.
        assert!((design.deviation - 2.0).abs() < 0.1, "{}", design.deviation);
        assert!(design.mean.abs() < 0.1, "{}", design.mean);
        assert!(design.normality.as_ref().unwrap().p_value > 1e-3, "{:?}", design.normality);
        assert_eq!(design.samples, SAMPLES - RUN_UP);

        let fresh_u = noise(SAMPLES, 3);
        let fresh_r = residual_of(&fresh_u, 4);
        let mut bands = ErrorBands::new(run, design.deviation, Confidence::new(0.05).unwrap());
        bands.reset();
        let outside = fresh_u
            .iter()
            .zip(&fresh_r)
            .map(|(u, r)| bands.band(&[*u]).is_exceeded_by(*r))
            .skip(RUN_UP)
            .filter(|exceeds| *exceeds)
            .count();
        let share = outside as f64 / (SAMPLES - RUN_UP) as f64;
        assert!((share - 0.05).abs() < 0.015, "{share}");
    }

    #[test]
    fn structure_left_in_the_residual_is_reported() {
        let u = noise(SAMPLES, 5);
        let r = residual_of(&u, 6);
        let data =
            Data::new(vec![Column { name: "u", values: &u }], Column { name: "r", values: &r })
                .unwrap();
        let nothing = std::sync::Arc::new(Arx { a: vec![], b: vec![vec![]], constant: 5.0 });
        let design = BandDesign::measure(&mut nothing.run(), &data, (RUN_UP, Start::Rest)).unwrap();
        assert!(design.whiteness.unwrap().p_value < 1e-6);
    }

    #[test]
    fn too_little_data_and_a_dead_residual_are_refused() {
        let u = noise(50, 7);
        let inputs = vec![Column { name: "u", values: &u }];
        let none = std::sync::Arc::new(Arx { a: vec![], b: vec![vec![]], constant: 0.0 });
        let short = Data::new(inputs.clone(), Column { name: "r", values: &u }).unwrap();
        let error = BandDesign::measure(&mut none.run(), &short, (49, Start::Rest)).unwrap_err();
        assert!(matches!(error, DataError::TooFew { needed: 51, samples: 50, .. }));
        let dead = Data::new(inputs, Column { name: "r", values: &[0.0; 50] }).unwrap();
        let error = BandDesign::measure(&mut none.run(), &dead, (10, Start::Rest)).unwrap_err();
        assert!(matches!(error, DataError::Constant { .. }));
    }
}
