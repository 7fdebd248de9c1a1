//! What makes a recording doubtful for a drive: units that cannot be right, too little in it.

use std::fmt;

use drivescope_plant::drive::{Drive, EffectData, Input};
use drivescope_plant::effects::registry::Entry;
use serde::Serialize;

use crate::error::Error;
use crate::measured::{Measured, Output};
use crate::settling::mechanical_time_s;

/// Times the no-load speed at the greatest u that a drive may be driven beyond by a load, or its
/// voltage constant be wrong in the file.
const BEYOND: f64 = 5.0;
/// Share of the largest speeds that may be disturbances of the sensor.
const SPIKES: f64 = 0.01;
/// Factors by which a speed is too large if its unit is mistaken, and how.
const MISTAKES: [(f64, &str); 3] = [
    (60.0 / std::f64::consts::TAU, "revolutions a minute, not rad/s"),
    (180.0 / std::f64::consts::PI, "degrees a second, not rad/s"),
    (60.0, "a value for a minute, not a second"),
];
/// Factor within which a ratio is one of these.
const ALIKE: f64 = 2.0;

/// Samples beyond which the work is one of minutes and gigabytes.
const LONG: usize = 3_000_000;

/// Why little may follow from a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Doubt {
    /// u does not change.
    ConstantInput { recording: String, value: f64 },
    /// The recording ends before the speed has settled once.
    Short {
        recording: String,
        /// Its longest stretch, s.
        duration_s: f64,
        /// Time in which the drive's speed settles, s.
        time_s: f64,
    },
    /// So many samples that the work takes minutes and gigabytes.
    Long {
        recording: String,
        samples: usize,
        /// Its sampling time, s.
        period_s: f64,
    },
    /// The validation recordings are explained much better by parameters of their own.
    OtherMachine {
        /// Their error in units of the noise, with the parameters of the other recordings.
        error: f64,
        /// With their own.
        own_error: f64,
        /// The parameter that differs most beyond chance.
        parameter: String,
        /// Its value in the other recordings.
        here: f64,
        /// In these.
        there: f64,
        unit: String,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ConstantInput { recording, value } => write!(
                f,
                "{recording}: u is constant at {value}: but for how the drive starts and settles, \
                 inductance and inertia do not show, and resistance, voltage constant and \
                 friction only together; record steps or a sweep"
            ),
            Self::Short { recording, duration_s, time_s } => write!(
                f,
                "{recording}: {duration_s:.3} s are {}: friction and inertia can hardly be told apart; record for longer",
                if time_s.is_finite() {
                    format!("shorter than the {time_s:.3} s in which the speed settles")
                } else {
                    "too short for a speed that nothing brakes".to_owned()
                }
            ),
            Self::Long { recording, samples, period_s } => write!(
                f,
                "{recording}: {samples} samples take minutes and gigabytes; record less, or take \
                 fewer of them, as --resample {} would",
                5.0 * period_s
            ),
            Self::OtherMachine { error, own_error, parameter, here, there, unit } => write!(
                f,
                "the validation recordings look like another machine's, or another state of it: \
                 their error is {error:.2} with these parameters and {own_error:.2} with their \
                 own, {parameter} {here:.4e} against {there:.4e} {unit}; validate on the machine \
                 that was fitted, or mark what may differ with [fit] per_recording"
            ),
        }
    }
}

/// The doubts about a recording.
///
/// # Errors
/// [`Error::ImpossibleSpeed`] if the speed is far beyond what u can give.
pub fn doubts(drive: &Drive, measured: &Measured) -> Result<Vec<Doubt>, Error> {
    check_speed(drive, measured)?;
    let mut doubts = Vec::new();
    let recording = || measured.name.clone();
    let u = || measured.pieces.iter().flat_map(|piece| &measured.u[piece.clone()]);
    let value = measured.u[measured.pieces[0].start];
    if u().all(|u| *u == value) {
        doubts.push(Doubt::ConstantInput { recording: recording(), value });
    }
    let longest = measured.pieces.iter().map(|piece| piece.len()).max().unwrap_or(0);
    let (duration_s, time_s) = (longest as f64 * measured.period_s, mechanical_time_s(drive));
    // Dry friction brakes where nothing brakes the more the faster.
    let braked = time_s.is_infinite() && drive.effects.iter().any(brakes);
    if duration_s < time_s && !braked {
        doubts.push(Doubt::Short { recording: recording(), duration_s, time_s });
    }
    if measured.len() > LONG {
        let (samples, period_s) = (measured.len(), measured.period_s);
        doubts.push(Doubt::Long { recording: recording(), samples, period_s });
    }
    Ok(doubts)
}

/// Whether an effect takes power from the moving shaft.
fn brakes(effect: &EffectData) -> bool {
    Entry::find(&effect.kind).is_some_and(|law| law.info.dissipates)
}

/// A voltage-driven motor does not turn much faster than u / K_e.
fn check_speed(drive: &Drive, measured: &Measured) -> Result<(), Error> {
    let (Input::Voltage, Some(k_e)) = (drive.motor.input, drive.motor.k_e) else { return Ok(()) };
    let Some(speed) = measured.output(Output::Speed) else { return Ok(()) };
    let u = measured.u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
    let largest = exceeded(&speed.values);
    let ratio = largest * k_e / u;
    if ratio <= BEYOND || u == 0.0 {
        return Ok(());
    }
    let near = |(factor, _): &&(f64, &str)| (ratio / factor).max(factor / ratio) < ALIKE;
    let meaning = MISTAKES.iter().filter(near).map(|(_, meaning)| *meaning).collect::<Vec<_>>();
    Err(Error::ImpossibleSpeed {
        file: measured.name.clone(),
        name: speed.name,
        unit: speed.unit.clone(),
        largest,
        possible: u / k_e,
        meaning: match meaning.as_slice() {
            [] => String::new(),
            some => format!(" (it looks like {})", some.join(", or ")),
        },
    })
}

/// The magnitude that few values exceed.
fn exceeded(values: &[f64]) -> f64 {
    let mut all: Vec<f64> = values.iter().map(|y| y.abs()).filter(|y| y.is_finite()).collect();
    let few = (all.len() as f64 * SPIKES) as usize;
    let at = all.len() - 1 - few;
    *all.select_nth_unstable_by(at, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, driven};

    #[test]
    fn a_speed_that_u_cannot_give_is_refused_with_its_likely_unit() {
        let drive = dr300();
        let mut recording = bench(&drive, 3.0, 0.001);
        let right = Measured::new(&drive, &recording).expect("usable");
        assert_eq!(doubts(&drive, &right), Ok(vec![]));
        for (factor, word) in [(60.0, "minute"), (30.0 / std::f64::consts::PI, "rad/s")] {
            let mut wrong = recording.clone();
            wrong.signals[2].values.iter_mut().for_each(|omega| *omega *= factor);
            let wrong = Measured::new(&drive, &wrong).expect("usable");
            let text = doubts(&drive, &wrong).expect_err("impossible").to_string();
            assert!(text.contains("looks like") && text.contains(word), "{text}");
            assert!(text.contains("--columns omega="), "{text}");
        }
        recording.signals[2].values[7] = 1e6;
        let spiked = Measured::new(&drive, &recording).expect("usable");
        assert_eq!(doubts(&drive, &spiked), Ok(vec![]), "one spike is no unit");
    }

    #[test]
    fn too_little_is_said() {
        let drive = dr300();
        let still = Measured::new(&drive, &driven(&drive, vec![5.0; 50], 0.001)).expect("usable");
        let found = doubts(&drive, &still).expect("possible");
        assert!(matches!(found[0], Doubt::ConstantInput { value: 5.0, .. }), "{found:?}");
        let Doubt::Short { duration_s, time_s, .. } = found[1] else { panic!("{found:?}") };
        assert!(duration_s == 0.05 && (0.06..0.08).contains(&time_s), "{found:?}");
        assert!(found.iter().all(|doubt| doubt.to_string().contains("record")));
    }

    #[test]
    fn dry_friction_brakes_too() {
        let mut drive = dr300();
        (drive.motor.b_m, drive.motor.r, drive.motor.k_e) = (0.0, None, None);
        drive.motor.input = Input::Force;
        drive.effects.retain(|effect| effect.kind == "coulomb");
        let mut recording = bench(&dr300(), 3.0, 0.001);
        recording.signals.retain(|it| it.name != "u");
        let short = |drive: &Drive| {
            let measured = Measured::new(drive, &recording).expect("usable");
            let doubts = doubts(drive, &measured).expect("a possible speed");
            doubts.iter().any(|it| matches!(it, Doubt::Short { .. }))
        };
        assert!(!short(&drive));
        drive.effects.clear();
        assert!(short(&drive));
    }

    #[test]
    fn too_much_is_said() {
        let drive = dr300();
        let mut much = Measured::new(&drive, &bench(&drive, 3.0, 0.001)).expect("usable");
        let n = LONG + 1;
        much.u = much.u.iter().copied().cycle().take(n).collect();
        much.outputs.iter_mut().for_each(|channel| channel.values = vec![0.0; n]);
        much.pieces = std::iter::once(0..n).collect();
        let found = doubts(&drive, &much).expect("possible");
        assert!(matches!(found[..], [Doubt::Long { samples, .. }] if samples == n), "{found:?}");
        assert!(found[0].to_string().contains("--resample 0.005"), "{}", found[0]);
    }
}
