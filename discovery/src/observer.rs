//! The observer: a fixed correction of the model's state after each sample,
//!
//! x += G (y_measured - y_model).
//!
//! At 0 Hz the model runs free. Where it integrates its errors, a low bandwidth f keeps it at the
//! measurement without hiding what is faster: per sample h, with rho = exp(-2 pi f h),
//! a measured speed corrects the speed by 1 - rho; a position alone corrects position and speed
//! by 1 - rho^2 and (1 - rho)^2 / h, which puts both poles of the double integrator at rho.
//! The current is not corrected: it does not integrate.
//!
//! A correction lets a part of the measured noise into the prediction, so the floor of the error
//! lies above 1 by [`Observer::floor`] even for a perfect model.

use std::f64::consts::TAU;

use serde::Serialize;

use crate::measured::{Measured, Output};

/// Bandwidth where the model cannot run free, Hz: well below the fast dynamics of a drive, well
/// above the drift of an integrated error.
pub const USUAL_HZ: f64 = 10.0;
/// Most of the sampling rate that the bandwidth may be.
const MOST_OF_RATE: f64 = 0.1;

/// Gains of the correction for one sampling time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gains {
    /// Output whose error is fed back.
    pub(crate) output: Output,
    /// To the speed, 1 (or 1/s from a position).
    pub(crate) speed: f64,
    /// To the position, 1.
    pub(crate) position: f64,
}

/// An observer of fixed bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Observer {
    /// Bandwidth, Hz; 0 where the model runs free.
    pub hz: f64,
}

impl Observer {
    /// The free run.
    pub const NONE: Self = Self { hz: 0.0 };

    /// Whether it corrects the model, which else runs free.
    pub(crate) fn follows(self) -> bool {
        self.hz > 0.0
    }

    /// An observer of the usual bandwidth, or less where sampling is slow.
    pub fn usual(recordings: &[Measured]) -> Self {
        let slowest = recordings.iter().map(|one| one.period_s).fold(0.0, f64::max);
        Self { hz: USUAL_HZ.min(MOST_OF_RATE / slowest) }
    }

    pub(crate) fn gains(&self, measured: &Measured) -> Option<Gains> {
        let h = measured.period_s;
        let rho = (-TAU * self.hz * h).exp();
        if self.hz == 0.0 {
            return None;
        }
        let slow = 1.0 - rho;
        if measured.output(Output::Speed).is_some() {
            return Some(Gains { output: Output::Speed, speed: slow, position: 0.0 });
        }
        let (position, speed) = (1.0 - rho * rho, slow * slow / h);
        measured.output(Output::Position)?;
        Some(Gains { output: Output::Position, speed, position })
    }

    /// The error of a perfect model that integrates u twice (once where the speed is measured),
    /// in units of the measured noise: root of 1 plus what the correction lets in.
    pub fn floor(&self, measured: &Measured) -> f64 {
        let Some(gains) = self.gains(measured) else { return 1.0 };
        let h = measured.period_s;
        // Response of the predicted output to one unit of noise at sample 0.
        let (mut speed, mut position) = (gains.speed, gains.position);
        let mut power = 1.0;
        for _ in 0..(SETTLED / (self.hz * h)) as usize {
            position += speed * h;
            let shown = if gains.output == Output::Speed { speed } else { position };
            power += shown * shown;
            position -= gains.position * shown;
            speed -= gains.speed * shown;
        }
        let channels = measured.outputs.len() as f64;
        ((channels - 1.0 + power) / channels).sqrt()
    }
}

/// Time constants of the observer after which a response is over.
const SETTLED: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::Channel;
    use drivescope_recording::{Clock, NoiseGain};

    fn measured(output: Output) -> Measured {
        let values = vec![0.0; 100];
        let outputs =
            vec![Channel { output, name: "y", unit: String::new(), values: values.clone() }];
        let name = String::new();
        Measured {
            name,
            clock: Clock { start_s: 0.0, period_s: 0.001, breaks: Vec::new() },
            period_s: 0.001,
            driving: crate::Driving::Input,
            u: values,
            load: None,
            outputs,
            angle: None,
            pieces: std::iter::once(0..100).collect(),
            by_load: false,
            noise_gain: NoiseGain::NONE,
            remarks: Vec::new(),
        }
    }

    #[test]
    fn the_floor_is_that_of_the_gains() {
        // A speed: a first-order low-pass lets (1 - rho) / (1 + rho) of the power in.
        let rho = (-TAU * 0.01).exp();
        let expected = (1.0 + (1.0 - rho) / (1.0 + rho)).sqrt();
        let found = Observer { hz: 10.0 }.floor(&measured(Output::Speed));
        assert!((found - expected).abs() < 1e-9, "{found} against {expected}");
        assert_eq!(Observer::NONE.floor(&measured(Output::Speed)), 1.0);
        // A position: both poles at rho, so less than 10 % more at 10 Hz.
        let position = Observer { hz: 10.0 }.floor(&measured(Output::Position));
        assert!(position > expected && position < 1.1, "{position}");
    }

    #[test]
    fn a_slowly_sampled_recording_is_corrected_more_slowly() {
        let mut slow = measured(Output::Speed);
        assert_eq!(Observer::usual(&[slow.clone()]).hz, USUAL_HZ);
        slow.period_s = 0.05;
        assert_eq!(Observer::usual(&[measured(Output::Speed), slow]).hz, 2.0);
    }
}
