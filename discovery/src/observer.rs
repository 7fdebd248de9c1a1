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

use drivescope_plant::drive::Drive;
use serde::Serialize;

use crate::balances::drift;
use crate::case::{Case, Setting};
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured, Output};
use crate::start::first_starts;

/// Bandwidth where the model cannot run free, Hz: well below the fast dynamics of a drive, well
/// above the drift of an integrated error.
pub const USUAL_HZ: f64 = 10.0;
/// Most of the sampling rate that the bandwidth may be.
const MOST_OF_RATE: f64 = 0.1;

/// Share of a recording within which a free run must settle.
const MOST_OF_RECORDING: f64 = 0.25;
/// Share of the speed's root mean square by which a torque that nothing explains may move a free
/// run: beyond, it shows that torque summed up and little else.
const MOST_OF_SPEED: f64 = 0.1;
/// Times the largest measured value beyond which a model has run away.
const RUN_AWAY: f64 = 10.0;

/// The torque that brakes a drive a unit of its speed, N m s/rad (N s/m): viscous friction, and the
/// back-EMF through the armature.
pub(crate) fn damping(drive: &Drive) -> f64 {
    let motor = &drive.motor;
    let braking = match (motor.r, motor.k_e) {
        (Some(r), Some(k_e)) => motor.k_m * k_e / r,
        _ => 0.0,
    };
    motor.b_m + braking
}

/// The time in which the speed of a drive settles, s: J over what brakes it.
pub fn mechanical_time_s(drive: &Drive) -> f64 {
    drive.motor.j / damping(drive)
}

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

    /// An observer of the usual bandwidth, or less where sampling is slow.
    pub fn usual(recordings: &[Measured]) -> Self {
        let slowest = recordings.iter().map(|one| one.period_s).fold(0.0, f64::max);
        Self { hz: USUAL_HZ.min(MOST_OF_RATE / slowest) }
    }

    /// The observer for a base drive: none where the drive returns to its input by itself, the
    /// usual one where it integrates (a position is measured alone, the speed takes a good part
    /// of the recording to settle, or it is braked so little that the torque the drive leaves
    /// unexplained moves it far) or runs away. `noise` is that of each recording's outputs.
    pub fn choose(drive: &Drive, recordings: &[Measured], noise: &[Vec<f64>]) -> Self {
        let settles = mechanical_time_s(drive);
        let integrates = |one: &Measured| {
            let longest = one.pieces.iter().map(|piece| piece.len()).max().unwrap_or(0);
            shows_an_integral(one) || settles > MOST_OF_RECORDING * longest as f64 * one.period_s
        };
        let away = |(one, noise): (&Measured, &Vec<f64>)| runs_away(drive, one, noise);
        let each = || recordings.iter().zip(noise);
        let far = || {
            let (recordings, noise) = (recordings.to_vec(), noise.to_vec());
            let share = drift(drive, &Evidence { recordings, noise });
            share.is_some_and(|share| share > MOST_OF_SPEED)
        };
        if recordings.iter().any(integrates) || far() || each().any(away) {
            Self::usual(recordings)
        } else {
            Self::NONE
        }
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

/// Whether a recording shows a position alone, an integral that nothing in the model returns.
fn shows_an_integral(measured: &Measured) -> bool {
    measured.output(Output::Speed).is_none() && measured.output(Output::Position).is_some()
}

/// Whether the model runs away from the measurement: an overflow, or an error far beyond the
/// signal itself.
fn runs_away(drive: &Drive, measured: &Measured, noise: &[f64]) -> bool {
    let setting = &Setting::new(drive, Observer::NONE);
    let starts = &first_starts(drive, measured, noise, setting);
    let case = Case { drive, measured, noise, starts, setting };
    let shown = case.trajectory();
    let far = |channel: &Channel| {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        largest(&shown[channel.output as usize]) > RUN_AWAY * largest(&channel.values)
    };
    case.squares().sum.is_infinite() || measured.outputs.iter().any(far)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300};
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

    #[test]
    fn what_integrates_is_observed_and_what_settles_runs_free() {
        let mut drive = dr300();
        let recording = bench(&drive, 2.0, 0.001);
        let of = |drive: &Drive, names: &[&str]| {
            let mut some = recording.clone();
            some.signals.retain(|signal| names.contains(&signal.name.as_str()));
            let one = Measured::new(drive, &some).expect("it can be used");
            let noise = vec![0.01; one.outputs.len()];
            Observer::choose(drive, &[one], &[noise])
        };
        assert_eq!(of(&drive, &["u", "i", "omega"]), Observer::NONE);
        assert_eq!(of(&drive, &["u", "theta"]).hz, USUAL_HZ);
        assert_eq!(of(&drive, &["u", "i", "theta"]).hz, USUAL_HZ);
        drive.motor.b_m = -0.01;
        assert_eq!(of(&drive, &["u", "omega"]).hz, USUAL_HZ, "it runs away");
        drive.motor.b_m = 0.0;
        drive.motor.j = 1e-3;
        assert_eq!(of(&drive, &["u", "omega"]).hz, USUAL_HZ, "0.87 s are much of 2 s");
    }
}
