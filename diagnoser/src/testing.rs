//! Signals for tests and benchmarks: a motor-like process of its own, a PI loop around it, noise.
//!
//! Deliberately apart from the crate: a second-order linear system with dry friction, integrated
//! by semi-implicit Euler steps, in round numbers.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Sampling time of the loop, s.
pub(crate) const PERIOD: f64 = 0.005;
/// Internal steps a sample: the electrical time constant is a fifth of a sample.
const SUBSTEPS: usize = 50;

/// Standard normal noise.
pub(crate) fn noise(samples: usize, seed: u64) -> Vec<f64> {
    StandardNormal.sample_iter(Pcg64::seed_from_u64(seed)).take(samples).collect()
}

/// Load torque disturbance: standard deviation in N m and correlation time in s.
const DISTURBANCE: (f64, f64) = (1e-3, 0.05);

/// A drive: control signal in V, speed in rpm.
#[derive(Clone, Default)]
pub(crate) struct Motor {
    current: f64,
    speed: f64,
    load: f64,
}

impl Motor {
    /// Holds the control signal for one sample and returns the speed at its end; `shock` is a
    /// standard normal draw that drives the load torque.
    pub(crate) fn hold(&mut self, control: f64, shock: f64) -> f64 {
        let kept = (-PERIOD / DISTURBANCE.1).exp();
        self.load = kept * self.load + DISTURBANCE.0 * (1.0 - kept * kept).sqrt() * shock;
        let h = PERIOD / SUBSTEPS as f64;
        for _ in 0..SUBSTEPS {
            let voltage = 2.4 * control;
            self.current += h / 0.004 * (voltage - 3.0 * self.current - 0.06 * self.speed);
            let friction = 0.016 * (self.speed / 2.0).tanh() + 6e-5 * self.speed;
            self.speed += h / 8e-5 * (0.06 * self.current - friction - self.load);
        }
        self.speed * 30.0 / std::f64::consts::PI
    }
}

/// Control signal and measured speed, one value a sample.
pub(crate) struct Run {
    pub(crate) control: Vec<f64>,
    pub(crate) speed: Vec<f64>,
}

/// Sensor noise, rpm.
const TACHO_NOISE: f64 = 3.0;
/// Noise on the reference, rpm.
const REFERENCE_NOISE: f64 = 20.0;

/// Open loop: three sines, as in (25) with t in seconds, from rest.
pub(crate) fn multisine(samples: usize, seed: u64) -> Run {
    use std::f64::consts::{PI, TAU};
    let (e, shocks) = (noise(samples, 3 * seed), noise(samples, 3 * seed + 1));
    let mut motor = Motor::default();
    let mut shown = 0.0;
    let (mut control, mut speed) = (Vec::new(), Vec::new());
    for (k, e) in e.iter().enumerate() {
        let t = k as f64 * PERIOD;
        let c = 3.0 * (TAU * 1.7 * t).sin()
            + 3.0 * (TAU * 1.1 * t - PI / 7.0).sin()
            + 3.0 * (TAU * 0.3 * t + PI / 3.0).sin();
        control.push(c);
        speed.push(shown + TACHO_NOISE * e);
        shown = motor.hold(c, shocks[k]);
    }
    Run { control, speed }
}

/// Closed loop at 2000 rpm with a noisy reference; from `onset` on the tachometer shows
/// (1 + `fault`) times the speed.
pub(crate) fn closed_loop(samples: usize, seed: u64, onset: usize, fault: f64) -> Run {
    let [sensor, reference, shocks] = [0, 1, 2].map(|part| noise(samples, 3 * seed + part));
    let mut motor = Motor::default();
    let (mut shaft, mut integral) = (0.0, 0.0);
    let (mut control, mut speed) = (Vec::new(), Vec::new());
    for k in 0..samples {
        let gain = if k >= onset { 1.0 + fault } else { 1.0 };
        let measured = gain * shaft + TACHO_NOISE * sensor[k];
        let error = 2000.0 + REFERENCE_NOISE * reference[k] - measured;
        let wanted = 0.004 * error + integral;
        let c = wanted.clamp(-10.0, 10.0);
        if c == wanted {
            integral += 0.05 * PERIOD * error;
        }
        control.push(c);
        speed.push(measured);
        shaft = motor.hold(c, shocks[k]);
    }
    Run { control, speed }
}
