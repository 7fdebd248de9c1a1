//! Ripples over the position, for many numbers of periods at little cost.
//!
//! At its null a ripple is a known torque (and voltage) along the run of the base drive:
//! cos(N theta) averaged over each sample, (sin(N theta_k+1) - sin(N theta_k)) / (N dtheta), so
//! that what passes within a sample averages out as it does in the drive. The response to these
//! series is its signature, and the base drive's own steps serve.

use drivescope_plant::drive::Drive;
use rayon::prelude::*;

use super::columns::At;
use crate::response::{Forcing, Linearised};

/// Angle within a sample below which its average is its middle, rad.
const SMALL: f64 = 1e-4;

/// What the base drive does in one recording.
#[derive(Debug, Clone)]
pub(crate) struct Trajectory {
    /// Current, A (the commanded signal where force-driven).
    pub(crate) current: Vec<f64>,
    /// Speed, rad/s (m/s).
    pub(crate) speed: Vec<f64>,
    /// Position, rad (m): measured where it is.
    pub(crate) position: Vec<f64>,
    /// Acceleration, rad/s^2 (m/s^2).
    pub(crate) acceleration: Vec<f64>,
    /// What a torque or a voltage would do to it.
    pub(crate) linearised: Option<Linearised>,
}

/// The trajectories of all recordings; 0 where there is none.
pub(crate) fn trajectories(at: &At<'_>) -> Vec<Trajectory> {
    let finite = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().map(|value| if value.is_finite() { value } else { 0.0 }).collect()
    };
    let of = |recording: usize| {
        at.with_case(recording, |case| {
            let [current, speed, position, ..] = case.trajectory().map(finite);
            let position = case.measured.angle.clone().unwrap_or(position);
            let acceleration = differences(&speed, case.measured.period_s);
            Trajectory { current, speed, position, acceleration, linearised: Linearised::of(case) }
        })
    };
    (0..at.fits.len()).into_par_iter().map(of).collect()
}

/// Central differences.
fn differences(values: &[f64], period_s: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
        (values[b] - values[a]) / ((b - a).max(1) as f64 * period_s)
    };
    (0..values.len()).map(at).collect()
}

/// cos(N theta) and sin(N theta), averaged from each sample to the next.
pub(crate) fn waves(position: &[f64], n: f64) -> [Vec<f64>; 2] {
    let last = position.len().saturating_sub(1);
    let mut waves = [vec![0.0; position.len()], vec![0.0; position.len()]];
    let (mut sin, mut cos) = position.first().map_or((0.0, 1.0), |theta| (n * theta).sin_cos());
    for k in 0..position.len() {
        let next = position[(k + 1).min(last)];
        let (sin_next, cos_next) = (n * next).sin_cos();
        let passed = n * (next - position[k]);
        if passed.abs() < SMALL {
            (waves[0][k], waves[1][k]) = (cos, sin);
        } else {
            waves[0][k] = (sin_next - sin) / passed;
            waves[1][k] = (cos - cos_next) / passed;
        }
        (sin, cos) = (sin_next, cos_next);
    }
    waves
}

/// The cosine's, then the sine's part of the signature of a ripple of N periods in that recording:
/// a torque, and for a ripple of the flux a voltage too.
pub(crate) fn forcings(kind: &str, n: f64, drive: &Drive, run: &Trajectory) -> Vec<Forcing> {
    let product = |wave: &[f64], with: &[f64], factor: f64| -> Vec<f64> {
        wave.iter().zip(with).map(|(wave, with)| factor * wave * with).collect()
    };
    let of = |wave: Vec<f64>| match drive.motor.k_e {
        _ if kind == "cogging" => Forcing::torque(wave.iter().map(|wave| -wave).collect()),
        k_e => Forcing {
            torque: product(&wave, &run.current, drive.motor.k_m),
            voltage: k_e.map_or(Vec::new(), |k_e| product(&wave, &run.speed, -k_e)),
        },
    };
    waves(&run.position, n).map(of).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_is_averaged_over_each_sample() {
        let position: Vec<f64> = (0..200).map(|k| 1e-4 * f64::from(k * k)).collect();
        let [cos, sin] = waves(&position, 24.0);
        for k in [0, 50, 150] {
            // The average by a fine sum, the angle going evenly from sample to sample.
            let mean = |f: fn(f64) -> f64| {
                let at = |j: usize| (j as f64 + 0.5) / 1000.0;
                let angle = |s: f64| position[k] + s * (position[k + 1] - position[k]);
                (0..1000).map(|j| f(24.0 * angle(at(j)))).sum::<f64>() / 1000.0
            };
            assert!((cos[k] - mean(f64::cos)).abs() < 1e-6, "{k}");
            assert!((sin[k] - mean(f64::sin)).abs() < 1e-6, "{k}");
        }
    }
}
