//! What a fit of a drive to recordings freezes: the observer and the sub-steps.

use drivescope_plant::drive::Drive;

use crate::balances::{begin, drift};
use crate::case::{Case, Setting};
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured, Output};
use crate::observer::Observer;
use crate::settling::mechanical_time_s;
use crate::start::first_starts;

/// Share of a recording within which a free run must settle.
const MOST_OF_RECORDING: f64 = 0.25;
/// Share of the speed's root mean square by which a torque that nothing explains may move a free
/// run: beyond, it shows that torque summed up and little else.
const MOST_OF_SPEED: f64 = 0.1;
/// Times the largest measured value beyond which a model has run away.
const RUN_AWAY: f64 = 10.0;

impl Setting {
    /// The setting of a fit of the drive to these recordings. It is chosen at the values that the
    /// balances give, so that it does not depend on where the search begins.
    pub fn of_fit(drive: &Drive, evidence: &Evidence) -> Self {
        let begun = begin(drive, evidence).drive;
        Self::new(&begun, Observer::choose(&begun, &evidence.recordings, &evidence.noise))
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
    use super::*;
    use crate::observer::USUAL_HZ;
    use crate::testing::{bench, dr300};

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
