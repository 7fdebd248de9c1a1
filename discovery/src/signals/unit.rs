//! A channel in another unit than it says: all parameters that the balances tell are off from
//! those of the drive file by powers of the same conversion factor.
//!
//! A file of rough start values is off by any factors: only where several parameters agree on one
//! channel and on one conversion is it the unit. The values are those of [`begin`], one recording
//! at a time.

use std::f64::consts::{PI, TAU};

use drivescope_plant::drive::{Drive, Input, Motion};
use drivescope_plant::effects::coulomb;
use drivescope_recording::rounded_to;
use rayon::prelude::*;

use super::finding::{Consequence, SignalFinding, Size, What};
use crate::balances::begin;
use crate::estimate::Evidence;
use crate::measured::{Measured, Output};

/// Conversions by which a value is too large, how, and how if it is as much too small.
type Mistake = (f64, &'static str, &'static str);
/// Of any signal.
const ANY: [Mistake; 2] = [
    (1000.0, "in thousandths (mA, mV, mm), not in whole units", "converted from thousandths twice"),
    (100.0, "in hundredths, not in whole units", "converted from hundredths twice"),
];
/// Of what has a time in it.
const SPEED: [Mistake; 1] =
    [(60.0, "for a minute, not for a second", "converted from minutes twice")];
/// Of what turns.
const ROTARY: [Mistake; 3] = [
    (
        60.0 / TAU,
        "in revolutions a minute, not in rad/s",
        "converted from revolutions a minute twice",
    ),
    (180.0 / PI, "in degrees, not in radians", "converted from degrees twice"),
    (TAU, "in radians times 2 pi", "in revolutions, not in radians"),
];
/// Standard error over value up to which a parameter is told well enough.
const IDENTIFIED: f64 = 0.2;
/// Factor by which each parameter may be off from what the conversion says: start values, what the
/// drive lacks, and the balances' own errors.
const WITHIN: f64 = 1.7;
/// Factor by which their mean may be: two conversions lie further apart, but for 57.3 and 60.
const MEAN_WITHIN: f64 = 1.25;
/// Parameters that must agree, and that may not.
const AGREEING: usize = 3;
const ASIDE: usize = 1;

/// The channel that is `factor` times too large, and by which power of the factor each parameter is
/// then off.
struct Hypothesis {
    channel: &'static str,
    powers: Vec<(&'static str, f64)>,
    mistakes: Vec<Mistake>,
}

/// The findings.
pub(super) fn check(drive: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    let each = evidence.recordings.par_iter().zip(&evidence.noise);
    each.filter_map(|(measured, sds)| of(drive, measured, sds)).collect()
}

fn of(drive: &Drive, measured: &Measured, sds: &[f64]) -> Option<SignalFinding> {
    let alone = Evidence { recordings: vec![measured.clone()], noise: vec![sds.to_vec()] };
    let begun = begin(drive, &alone);
    let all = begun.drive.parameters();
    let identified = begun.identified.iter().filter_map(|it| {
        let now = all.iter().find(|one| one.name == it.name)?.value;
        let file = drive.parameters().iter().find(|one| one.name == it.name)?.value;
        let ratio = now / file;
        (it.std_error < IDENTIFIED * now.abs() && ratio.is_finite() && ratio > 0.0)
            .then(|| (it.name.as_str(), ratio.ln()))
    });
    let identified: Vec<(&str, f64)> = identified.collect();
    let found = hypotheses(drive, measured)
        .into_iter()
        .flat_map(|it| {
            let fits: Vec<_> = it.fits(&identified).collect();
            fits.into_iter().map(move |(factor, words, agree)| (it.channel, factor, words, agree))
        })
        .max_by_key(|(.., agree)| *agree);
    let (channel, factor, words, agree) = found?;
    Some(SignalFinding {
        recording: measured.name.clone(),
        channel: channel.to_owned(),
        what: What::Unit,
        at: None,
        size: Size { value: factor, of: "factor" },
        consequence: Consequence::NotJudged,
        sentence: format!(
            "{channel} looks {words}: {agree} parameters are off from the drive file's as they \
             would be if {channel} were {} times too large",
            rounded_to(4, factor)
        ),
        next: format!(
            "name the unit by --columns {channel}=COLUMN:UNIT, or correct the drive file if the \
             recording is right"
        ),
    })
}

impl Hypothesis {
    /// Factors that explain what is told, with the mistake in words and how many agree.
    fn fits<'a>(
        &'a self,
        identified: &'a [(&str, f64)],
    ) -> impl Iterator<Item = (f64, &'static str, usize)> + 'a {
        let both = self
            .mistakes
            .iter()
            .flat_map(|(factor, large, small)| [(*factor, *large), (1.0 / factor, *small)]);
        both.filter_map(|(factor, words)| {
            let known = identified.iter().filter_map(|(name, off)| {
                let (_, power) = self.powers.iter().find(|(one, _)| one == name)?;
                Some((*power, *off))
            });
            let known: Vec<(f64, f64)> = known.collect();
            let near =
                |(power, off): &&(f64, f64)| (off - power * factor.ln()).abs() <= WITHIN.ln();
            let agree: Vec<&(f64, f64)> = known.iter().filter(near).collect();
            let squares: f64 = agree.iter().map(|(power, _)| power * power).sum();
            let mean = agree.iter().map(|(power, off)| power * off).sum::<f64>() / squares;
            let count = agree.len();
            let is_it = count >= AGREEING
                && known.len() - count <= ASIDE
                && (mean - factor.ln()).abs() <= MEAN_WITHIN.ln();
            is_it.then_some((mean.exp(), words, count))
        })
    }
}

/// What could be in another unit. A parameter that follows the torque is multiplied by what the
/// torque is, and divided by what the speed is; K_m goes with K_e where they are tied.
fn hypotheses(drive: &Drive, measured: &Measured) -> Vec<Hypothesis> {
    let tied = f64::from(u8::from(drive.motor.tie_k));
    let has_current = measured.output(Output::Current).is_some();
    // Powers of R and L, of K_e, of torques (dry friction), and of torques over the speed.
    let powers = |r: f64, k: f64, torque: f64, speed: f64| {
        let over = torque - speed;
        let (r, k) = ([("R", r), ("L", r)], [("K_e", k)]);
        let torques = [(coulomb::LEVEL, torque), ("J", over), ("B_m", over)];
        r.into_iter().chain(k).chain(torques).collect::<Vec<_>>()
    };
    let shown = [Output::Speed, Output::Position].into_iter().find_map(|it| measured.output(it));
    let u = measured.driving.channel();
    let (of_u, of_motion) = match (drive.motor.input, has_current) {
        (Input::Force, _) => (powers(1.0, 1.0, 1.0, 0.0), powers(0.0, 0.0, 0.0, 1.0)),
        (Input::Voltage, true) => (powers(1.0, 1.0, tied, 0.0), powers(0.0, -1.0, -tied, 1.0)),
        // The resistance is that of the file: the torque is K_m u / R.
        (Input::Voltage, false) => {
            (powers(0.0, 1.0, 1.0 + tied, 0.0), powers(0.0, -1.0, -tied, 1.0))
        }
    };
    let rotary: &[Mistake] = if drive.motion == Motion::Rotary { &ROTARY } else { &[] };
    let of_motion = shown.map(|channel| Hypothesis {
        channel: channel.name,
        powers: of_motion,
        mistakes: [&ANY[..], &SPEED, rotary].concat(),
    });
    let of_current = has_current.then(|| Hypothesis {
        channel: "i",
        powers: powers(-1.0, 0.0, 1.0, 0.0),
        mistakes: ANY.to_vec(),
    });
    let of_u = Hypothesis { channel: u, powers: of_u, mistakes: ANY.to_vec() };
    of_motion.into_iter().chain(of_current).chain([of_u]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    fn found(spoil: &str, factor: f64, drive: &Drive) -> Vec<(What, String, f64)> {
        let mut recording = noisy(bench(&dr300(), 6.0, 0.001), [0.02, 0.5], 3);
        recording.signals.retain(|it| it.name != "theta");
        for signal in recording.signals.iter_mut().filter(|it| it.name == spoil) {
            signal.values.iter_mut().for_each(|it| *it *= factor);
        }
        let sds = ["i", "omega"].map(|it| if it == spoil { factor } else { 1.0 });
        let noise = vec![vec![0.02 * sds[0], 0.5 * sds[1]]];
        let measured = Measured::new(drive, &recording).expect("usable");
        let found = check(drive, &Evidence { recordings: vec![measured], noise });
        found.into_iter().map(|it| (it.what, it.channel, it.size.value)).collect()
    }

    #[test]
    fn each_channel_s_unit_is_told_by_the_pattern() {
        let mut drive = dr300();
        // Rough start values.
        drive.motor.r = drive.motor.r.map(|r| 1.2 * r);
        drive.motor.j *= 0.8;
        assert_eq!(found("none", 1.0, &drive), []);
        let right = 60.0 / TAU;
        for (channel, factor) in [
            ("i", 1000.0),
            ("i", 0.001),
            ("u", 1000.0),
            ("omega", right),
            ("omega", 1.0 / right),
            ("omega", 180.0 / PI),
        ] {
            let identified = found(channel, factor, &drive);
            let [(What::Unit, name, size)] = &identified[..] else {
                panic!("{channel} {factor}: {identified:?}")
            };
            assert_eq!(name, channel);
            assert!((size / factor).ln().abs() < 1.2_f64.ln(), "{factor} {size}");
        }
    }

    #[test]
    fn values_that_are_merely_rough_are_no_unit() {
        for (r, k, j, t_c) in [(9.5, 1.0, 1.0, 1.0), (3.0, 0.3, 9.5, 4.0), (0.1, 10.0, 1000.0, 5.0)]
        {
            let mut drive = dr300();
            drive.motor.r = drive.motor.r.map(|it| r * it);
            drive.motor.k_e = drive.motor.k_e.map(|it| k * it);
            drive.motor.j *= j;
            let dry = drive.parameters().into_iter().find(|it| it.name == "coulomb.T_c");
            let dry = dry.expect("it has dry friction").value;
            drive.set("coulomb.T_c", t_c * dry).expect("possible");
            assert_eq!(found("none", 1.0, &drive), [], "{r} {k} {j} {t_c}");
        }
    }
}
