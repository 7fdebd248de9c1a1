//! What a fit of a drive to recordings freezes: the observer and the sub-steps.

use drivescope_plant::drive::Drive;

use crate::balances::{begin, drift};
use crate::case::{Case, Setting};
use crate::estimate::{Evidence, recorded_speeds};
use crate::measured::{Channel, Measured, Output};
use crate::observer::Observer;
use crate::settling::mechanical_time_s;
use crate::start::first_starts;

/// Share of a recording within which a free run must settle.
const MOST_OF_RECORDING: f64 = 0.25;
/// Share of the speed's root mean square by which a torque that nothing explains may move a free
/// run: beyond, it shows that torque summed up and little else.
const MOST_OF_SPEED: f64 = 0.1;
/// By how much a model may run faster than what was measured.
const FASTER: f64 = 1.5;
/// Times the largest measured value beyond which a model has run away.
const RUN_AWAY: f64 = 10.0;

impl Setting {
    /// The setting of a fit of the drive to these recordings. It is chosen at the values that the
    /// balances give, so that it does not depend on where the search begins.
    pub fn of_fit(drive: &Drive, evidence: &Evidence) -> Self {
        let begun = begin(drive, evidence).drive;
        let observer = Observer::choose(&begun, &evidence.recordings, &evidence.noise);
        // What was measured is slower than what limits allow, where the file has any.
        match recorded_speeds(&evidence.recordings, &evidence.noise).1 {
            0.0 => Self::new(&begun, observer),
            fastest => Self::up_to(&begun, observer, FASTER * fastest),
        }
    }
}

impl Observer {
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
}

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
    use drivescope_plant::drive::EffectData;

    use super::*;
    use crate::observer::USUAL_HZ;
    use crate::testing::{bench, dr300, driven};

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

    /// A file without limits says nothing of speeds: a slow machine's recordings do.
    #[test]
    fn a_ripple_is_passed_as_fast_as_recorded() {
        let mut drive = dr300();
        (drive.controller, drive.amplifier) = (None, None);
        let parameters = [("N", 66.0), ("a", 1e-3), ("b", 0.0)].map(|(n, v)| (n.into(), v));
        let (kind, id) = ("cogging".into(), "cogging".into());
        drive.effects.push(EffectData { kind, id, parameters: parameters.into(), law: None });
        let slow: Vec<f64> = (0..2000).map(|k| 2.0 * (0.005 * k as f64).sin()).collect();
        let measured = Measured::new(&drive, &driven(&drive, slow, 0.001)).expect("it can be used");
        let evidence = Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] };
        let setting = Setting::of_fit(&drive, &evidence);
        assert!((20.0..60.0).contains(&setting.speed), "2 V drive 30 rad/s: {}", setting.speed);
        let any = Setting::new(&drive, setting.observer);
        assert!(setting.longest_s > 2.0 * any.longest_s, "{setting:?} {any:?}");
        // What is added has sub-steps of its own, and what is gone leaves none behind.
        let mut plain = drive.clone();
        plain.effects.retain(|effect| effect.id != "cogging");
        let without = any.of(&plain);
        assert!(without.longest_s > 2.0 * any.longest_s, "{without:?}");
        assert_eq!(without.of(&drive), any);
    }
}
