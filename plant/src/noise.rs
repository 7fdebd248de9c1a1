//! Noise: drawn before a run, from a stream of its own a scenario.
//!
//! The stream is a function of (seed, scenario index) alone, so the same seed gives the same
//! bytes on any number of threads. Sensors and reference have white noise; the disturbance
//! torque is an Ornstein-Uhlenbeck process, sampled exactly:
//! T_{k+1} = a T_k + sd sqrt(1 - a^2) n_k, a = e^(-h / torque_time).

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::drive::NoiseData;
use crate::lanes::lanes;

lanes! {
    /// The noise of one sample; SI units.
    Noise / NoiseLanes {
        /// On the reference, rad/s (m/s).
        reference,
        /// On the tachometer, rad/s (m/s).
        omega,
        /// On the current sensor, A.
        i,
        /// On the position sensor, rad (m).
        theta,
        /// Disturbance torque, N m (N).
        torque,
    }
}

/// An endless stream of noise samples.
#[derive(Debug, Clone)]
pub struct NoiseStream {
    random: Pcg64Mcg,
    deviations: NoiseData,
    /// Memory of the disturbance over one sample, and what refreshes it.
    memory: f64,
    refresh: f64,
    torque: Option<f64>,
}

/// Odd constant (2^64 over the golden ratio) that spreads neighbouring seeds and indices.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

impl NoiseStream {
    /// The stream of scenario `index` under `seed`, sampled every `period_s`.
    pub fn new(deviations: &NoiseData, period_s: f64, seed: u64, index: u64) -> Self {
        let memory = if deviations.torque_time > 0.0 {
            (-period_s / deviations.torque_time).exp()
        } else {
            0.0
        };
        let mixed = seed.wrapping_mul(SPREAD).rotate_left(31) ^ index.wrapping_mul(SPREAD);
        Self {
            random: Pcg64Mcg::seed_from_u64(mixed),
            deviations: *deviations,
            memory,
            refresh: deviations.torque * (1.0 - memory * memory).sqrt(),
            torque: None,
        }
    }

    #[inline]
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }
}

impl Iterator for NoiseStream {
    type Item = Noise<f64>;

    /// The noise of the next sample; the stream never ends.
    #[inline]
    fn next(&mut self) -> Option<Noise<f64>> {
        let [reference, omega, i, theta, fresh] = std::array::from_fn(|_| self.normal());
        let torque = match self.torque {
            None => self.deviations.torque * fresh,
            Some(last) => self.memory * last + self.refresh * fresh,
        };
        self.torque = Some(torque);
        let sd = &self.deviations;
        Some(Noise {
            reference: sd.reference * reference,
            omega: sd.omega * omega,
            i: sd.i * i,
            theta: sd.theta * theta,
            torque,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVIATIONS: NoiseData = NoiseData {
        omega: 0.3,
        i: 0.01,
        theta: 1e-3,
        reference: 2.0,
        torque: 1e-3,
        torque_time: 0.05,
    };

    #[test]
    fn a_stream_is_a_function_of_seed_and_index() {
        let draw = |seed, index| {
            NoiseStream::new(&DEVIATIONS, 0.005, seed, index).take(50).collect::<Vec<_>>()
        };
        assert_eq!(draw(1, 2), draw(1, 2));
        assert_ne!(draw(1, 2), draw(1, 3));
        assert_ne!(draw(1, 2), draw(2, 2));
        assert_ne!(draw(1, 2), draw(2, 1));
    }

    #[test]
    fn deviations_and_correlation_are_as_asked() {
        let n = 200_000;
        let drawn: Vec<_> = NoiseStream::new(&DEVIATIONS, 0.005, 7, 0).take(n).collect();
        let deviation = |of: fn(&Noise<f64>) -> f64| {
            (drawn.iter().map(|x| of(x).powi(2)).sum::<f64>() / n as f64).sqrt()
        };
        // One part in a hundred is four standard errors or more (the torque has n / 20 free).
        assert!((deviation(|x| x.reference) / 2.0 - 1.0).abs() < 0.01);
        assert!((deviation(|x| x.omega) / 0.3 - 1.0).abs() < 0.01);
        assert!((deviation(|x| x.torque) / 1e-3 - 1.0).abs() < 0.03);
        let product: f64 = drawn.windows(2).map(|w| w[0].torque * w[1].torque).sum();
        let correlation = product / n as f64 / 1e-6;
        assert!((correlation - (-0.1f64).exp()).abs() < 0.03, "{correlation}");
    }
}
