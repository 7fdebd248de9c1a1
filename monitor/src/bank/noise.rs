//! Noise learned from healthy recordings: the values under which they are most likely.

use drivescope_diagnoser::bank::{LearnedNoise, Row};
use drivescope_plant::drive::{Drive, NoiseData};
use drivescope_plant::sampled::{rated_torque, speed_bound};
use rayon::prelude::*;

use super::mechanisms::greatest_current;
use super::process::{ProcessError, QUIET, USUAL_TIME_S};
use super::sizes::process;

/// Rows of a recording that the noise is learned from, and recordings.
const ROWS: usize = 2000;
const RECORDINGS: usize = 6;
/// Factors by which a value is tried higher and lower, from coarse to fine: 5 % of a standard
/// deviation changes no decision.
const FACTORS: [f64; 5] = [3.0, 1.7, 1.3, 1.12, 1.05];
/// Gain in log-likelihood below which a value stays what it was.
const GAIN: f64 = 0.5;
/// Passes over the values with each factor at most.
const PASSES: usize = 6;

/// The drive with that noise in place of its own.
pub fn with_noise(drive: &Drive, noise: &LearnedNoise) -> Drive {
    let LearnedNoise { omega, i, torque, torque_time } = *noise;
    let noise = NoiseData { omega, i, torque, torque_time, ..drive.noise };
    Drive { noise, ..drive.clone() }
}

/// The noise under which healthy recordings, each of a machine of its own, are most likely; what
/// they do not tell stays what the drive file says.
///
/// # Errors
/// As [`process`].
pub fn learn_noise(
    drive: &Drive,
    period_s: f64,
    healthy: &[Vec<Row>],
) -> Result<LearnedNoise, ProcessError> {
    let likelihood = |noise: &[f64; 4]| -> Result<f64, ProcessError> {
        let of_noise = process(&with_noise(drive, &named(*noise)), period_s, &[])?;
        let rows: Vec<&[Row]> =
            healthy.iter().take(RECORDINGS).map(|rows| &rows[..rows.len().min(ROWS)]).collect();
        let each: Vec<f64> = rows.par_iter().map(|rows| of_noise.log_likelihood(rows)).collect();
        Ok(each.iter().sum())
    };
    let given = drive.noise;
    let or = |value: f64, otherwise: f64| if value > 0.0 { value } else { otherwise };
    // Ten times what counts as none, where the file says nothing.
    let small = 10.0 * QUIET;
    let mut best = [
        or(given.omega, small * speed_bound(drive)),
        or(given.i, small * greatest_current(drive)),
        or(given.torque, small * rated_torque(drive).unwrap_or(1.0)),
        or(given.torque_time, USUAL_TIME_S),
    ];
    let mut top = likelihood(&best)?;
    for factor in FACTORS {
        for _ in 0..PASSES {
            let before = top;
            for k in 0..best.len() {
                for by in [factor, 1.0 / factor] {
                    let mut other = best;
                    other[k] *= by;
                    let found = likelihood(&other)?;
                    if found > top + GAIN {
                        (best, top) = (other, found);
                        break;
                    }
                }
            }
            if top <= before {
                break;
            }
        }
    }
    Ok(named(best))
}

fn named([omega, i, torque, torque_time]: [f64; 4]) -> LearnedNoise {
    LearnedNoise { omega, i, torque, torque_time }
}
