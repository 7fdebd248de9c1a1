//! Whether the outputs answer what drives: which of them belongs to another run or to none, is
//! seconds off, or has its sign reversed.
//!
//! The motion is held against the current and against the voltage ([`super::standing`]). Of three
//! signals the one is wrong that stands in both relations that fail; of two nobody can tell which.

use drivescope_plant::drive::{Drive, Input};
use rayon::prelude::*;

use super::averaged::Averaged;
use super::finding::{Consequence, SignalFinding, Size, What};
use super::standing::{SCALES, Standing, standing};
use crate::estimate::Evidence;
use crate::measured::{Measured, Output};

const SAME_RUN: &str = "check that all columns are of the same run, and record u and the outputs \
                        with one clock, with steps of u both ways";

/// The findings.
pub(super) fn check(drive: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    let is_torque = drive.motor.input == Input::Force;
    evidence.recordings.par_iter().filter_map(|it| of(it, is_torque)).collect()
}

/// Of a recording whose driving signal may be a torque, or a current.
fn of(measured: &Measured, is_torque: bool) -> Option<SignalFinding> {
    // A load behind a spring moves against its motor beyond the resonance.
    if measured.by_load {
        return None;
    }
    let each: Vec<Averaged> =
        SCALES.iter().filter_map(|most| Averaged::of(measured, *most)).collect();
    let shown = [Output::Speed, Output::Position].into_iter().find_map(|it| measured.output(it));
    let (motion, u) = (shown?.name, measured.driving.channel());
    let by_u = standing(&each, is_torque, |it| Some(&it.driver));
    let by_current = match measured.output(Output::Current) {
        Some(_) => standing(&each, true, |it| it.current.as_deref()),
        None => Standing::Untold,
    };
    let has_current = measured.output(Output::Current).is_some();
    let found = Found { measured, motion, u };
    match (by_u, by_current) {
        (Standing::Follows | Standing::Untold, Standing::Follows | Standing::Untold) => None,
        // The current fails alone, or the voltage.
        (Standing::Follows, it) => found.says("i", &format!("{motion} and {u}"), it),
        (it, Standing::Follows) => found.says(u, &format!("i and {motion}"), it),
        (it, _) if has_current => {
            let standing = if it == Standing::Untold { by_current } else { it };
            found.says(motion, &format!("{u} and i"), standing)
        }
        (it, _) => found.says(motion, u, it),
    }
}

/// Where something was found.
struct Found<'a> {
    measured: &'a Measured,
    motion: &'static str,
    u: &'static str,
}

impl Found<'_> {
    /// What is said of a channel that stands so to the others.
    fn says(&self, channel: &str, others: &str, standing: Standing) -> Option<SignalFinding> {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let motion = self.motion;
        let driver = if channel == "i" { "i" } else { self.u };
        let (what, size, sentence, next) = match standing {
            Standing::Not(share) => (
                What::NoAnswer,
                Size { value: share, of: "share explained" },
                format!(
                    "{channel} does not go with {others}: inertia and friction explain {} of \
                     {driver} by {motion}, as much as by chance",
                    percent(share)
                ),
                SAME_RUN.to_owned(),
            ),
            Standing::Late(late_s, share) => {
                // What drives is late where the motion is early.
                let late_s = if channel == motion { late_s } else { -late_s };
                let word = if late_s > 0.0 { "late" } else { "early" };
                let by = late_s.abs();
                (
                    What::Shifted,
                    Size { value: late_s, of: "s late" },
                    format!(
                        "{channel} comes {by:.2} s too {word} for {others}: there inertia and \
                         friction explain {} of {driver}, and nothing like it at once",
                        percent(share)
                    ),
                    format!("move {channel} by {by:.2} s, or record all with one clock"),
                )
            }
            Standing::Reversed(share) => (
                What::Sign,
                Size { value: -1.0, of: "factor" },
                format!(
                    "the sign of {channel} is opposite to what {others} say: with it turned, \
                     inertia and friction explain {} of {driver}",
                    percent(share)
                ),
                format!("multiply {channel} by -1, or exchange its wires and record anew"),
            ),
            Standing::Follows | Standing::Untold => return None,
        };
        Some(SignalFinding {
            recording: self.measured.name.clone(),
            channel: channel.to_owned(),
            what,
            at: None,
            size,
            consequence: Consequence::NotJudged,
            sentence,
            next,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, gaussian, noisy};
    use drivescope_recording::Recording;

    fn found(recording: &Recording) -> Vec<(What, String, f64)> {
        let measured = Measured::new(&dr300(), recording).expect("usable");
        let evidence = Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] };
        let found = check(&dr300(), &evidence);
        assert!(found.iter().all(SignalFinding::forbids));
        found.into_iter().map(|it| (it.what, it.channel, it.size.value)).collect()
    }

    fn good() -> Recording {
        let mut recording = noisy(bench(&dr300(), 6.0, 0.001), [0.02, 0.5], 3);
        recording.signals.retain(|it| it.name != "theta");
        recording
    }

    fn spoiled(names: &[&str], spoil: impl Fn(&[f64]) -> Vec<f64>) -> Recording {
        let mut recording = good();
        for signal in recording.signals.iter_mut().filter(|it| names.contains(&it.name.as_str())) {
            signal.values = spoil(&signal.values);
        }
        recording
    }

    #[test]
    fn a_good_recording_raises_nothing() {
        assert_eq!(found(&good()), []);
        let mut without = good();
        without.signals.retain(|it| it.name != "i");
        assert_eq!(found(&without), []);
    }

    #[test]
    fn the_channel_with_a_turned_sign_is_named() {
        let reversed = |values: &[f64]| values.iter().map(|it| -it).collect();
        for name in ["u", "i", "omega"] {
            assert_eq!(found(&spoiled(&[name], reversed)), [(What::Sign, name.to_owned(), -1.0)]);
        }
    }

    /// At one speed the current answers what disturbs the speed, by the sign of the controller; and
    /// a current that holds a load says little else.
    #[test]
    fn neither_a_controller_nor_a_load_that_is_held_turns_a_sign() {
        let (speed_noise, ripple) = (gaussian(6000, 7), gaussian(6000, 8));
        let recording = |u: Vec<f64>, omega: Vec<f64>| {
            let one = |name: &str, unit: &str, values| drivescope_recording::Signal {
                name: name.into(),
                unit: unit.into(),
                values,
            };
            let signals =
                vec![one("u", "V", u.clone()), one("i", "A", u), one("omega", "rad/s", omega)];
            Recording::new("one", 0.0, 0.001, signals)
        };
        let omega: Vec<f64> = speed_noise.iter().map(|it| 6.0 + 3.0 * it).collect();
        let controlled: Vec<f64> = omega.iter().map(|it| 0.2 - 0.1 * (it - 6.0)).collect();
        assert_eq!(found(&recording(controlled, omega)), []);
        // Lowered and lifted: the current holds the load, and friction hardly shows.
        let omega: Vec<f64> =
            (0..6000).map(|k| if (k / 1500) % 2 == 0 { 5.0 } else { -5.0 }).collect();
        let mut held = recording(vec![], omega);
        held.signals.retain(|it| it.name != "u" && it.name != "i");
        let torque: Vec<f64> = ripple.iter().map(|it| -17.0 + 1.5 * it).collect();
        let (name, unit) = ("i".to_owned(), "A".to_owned());
        held.signals.push(drivescope_recording::Signal { name, unit, values: torque });
        let mut drive = dr300();
        drive.motor.input = Input::Force;
        let measured = Measured::new(&drive, &held).expect("usable");
        let evidence = Evidence { recordings: vec![measured], noise: vec![vec![0.3]] };
        assert_eq!(check(&drive, &evidence).len(), 0);
    }

    #[test]
    fn what_answers_nothing_is_named() {
        let random =
            |values: &[f64]| gaussian(values.len(), 5).iter().map(|it| 50.0 * it).collect();
        for name in ["i", "omega"] {
            let found = found(&spoiled(&[name], random));
            assert!(matches!(&found[..], [(What::NoAnswer, it, _)] if it == name), "{found:?}");
        }
        // The outputs begin 1.5 s after u, and end with it.
        let late = |values: &[f64]| {
            [&values[values.len() - 1500..], &values[..values.len() - 1500]].concat()
        };
        let [(what, channel, by)] = &found(&spoiled(&["i", "omega"], late))[..] else {
            panic!("one finding")
        };
        // The voltage is early by what the outputs are late.
        assert_eq!((*what, channel.as_str()), (What::Shifted, "u"));
        assert!((by + 1.5).abs() < 0.02, "{by}");
    }
}
