//! Which motion the recordings hold together: none, one speed, one direction; and which parameters
//! of the base they cannot tell therefore.

use std::ops::Range;

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::{constant_load, coulomb};
use drivescope_plant::units::for_motion;
use drivescope_recording::rounded_to;

use super::averaged::Averaged;
use super::finding::{Consequence, SignalFinding, Size, What};
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured, Output, bridged};

/// Share of the greatest speed below which a direction is not certain.
pub(super) const SLOW: f64 = 0.03;
/// Windows over which a speed is averaged, at most.
const WINDOWS: usize = 400;
/// The same where it is asked whether anything moves at all.
const REST_WINDOWS: usize = 100;
/// Standard deviations of noise within which a signal stays that does not move.
const STILL: f64 = 6.0;
/// Changes of the speed's magnitude below this share of its mean are one speed: friction that
/// grows by as much as the speed does changes by less than other things change it.
const ONE_SPEED: f64 = 0.1;
/// Share of the windows that may be something else: starts and ends.
const FEW: f64 = 0.02;

/// The findings.
pub(super) fn check(drive: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    let still = evidence.recordings.iter().zip(&evidence.noise);
    if still.clone().all(|(measured, sds)| rests(measured, sds)) {
        return evidence.recordings.first().map(|it| at_rest(it, evidence)).into_iter().collect();
    }
    let speeds = speeds(evidence);
    let Some(shown) = evidence.recordings.first().and_then(shown) else { return Vec::new() };
    let several = Several { evidence, channel: shown.name, drive };
    [several.one_speed(&speeds), several.one_direction(&speeds)].into_iter().flatten().collect()
}

/// Whether the speed hardly changes.
pub(crate) fn is_one_speed(evidence: &Evidence) -> bool {
    changes(&speeds(evidence)).is_some_and(|(_, share)| share < ONE_SPEED)
}

/// Speeds, averaged over windows.
fn speeds(evidence: &Evidence) -> Vec<f64> {
    let averaged = evidence.recordings.iter().filter_map(|it| Averaged::of(it, WINDOWS));
    averaged.flat_map(|it| it.speed).collect()
}

/// Mean magnitude of the speeds, and the share of it by which it changes.
fn changes(speeds: &[f64]) -> Option<(f64, f64)> {
    let mut all: Vec<f64> = speeds.iter().map(|speed| speed.abs()).collect();
    all.sort_by(f64::total_cmp);
    let few = (FEW * all.len() as f64) as usize;
    let usual = &all[few..all.len() - few];
    let n = usual.len() as f64;
    let mean = usual.iter().sum::<f64>() / n;
    let variance = usual.iter().map(|speed| (speed - mean).powi(2)).sum::<f64>() / n;
    (n > 0.0).then(|| (mean, variance.sqrt() / mean))
}

/// The channel that shows the motion.
fn shown(measured: &Measured) -> Option<&Channel> {
    [Output::Speed, Output::Position].into_iter().find_map(|it| measured.output(it))
}

/// Whether the shaft never moves by more than the sensor's noise, averaged over windows: a speed
/// from differences of counts is noisy, and yet no noise.
fn rests(measured: &Measured, sds: &[f64]) -> bool {
    let Some(channel) = shown(measured) else { return false };
    let index = measured.outputs.iter().position(|it| it.output == channel.output);
    let sd = index.and_then(|k| sds.get(k)).copied().unwrap_or(0.0);
    let samples: usize = measured.pieces.iter().map(|piece| piece.len()).sum();
    let length = samples.div_ceil(REST_WINDOWS);
    let values = bridged(&channel.values);
    let of = |piece: &Range<usize>| {
        let means = values[piece.clone()].chunks_exact(length);
        means.map(|some| some.iter().sum::<f64>() / length as f64).collect::<Vec<_>>()
    };
    let means: Vec<f64> = measured.pieces.iter().flat_map(of).collect();
    let (low, high) = means
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(*it), high.max(*it)));
    let noise = STILL * sd / (length as f64).sqrt();
    // A position rests anywhere, a speed at zero.
    match channel.output {
        Output::Position => high - low <= noise,
        _ => high.max(-low) <= noise,
    }
}

fn at_rest(first: &Measured, evidence: &Evidence) -> SignalFinding {
    let channel = shown(first).map_or("u", |it| it.name);
    SignalFinding {
        recording: names(evidence),
        channel: channel.to_owned(),
        what: What::AtRest,
        at: None,
        size: Size { value: 0.0, of: "speed" },
        consequence: Consequence::NotJudged,
        sentence: format!(
            "the shaft never moves: {channel} shows noise only, and friction, inertia and the \
             voltage constant do not show at rest"
        ),
        next: "record with a u that is large enough to turn it, in steps both ways".to_owned(),
    }
}

fn names(evidence: &Evidence) -> String {
    let mut all: Vec<&str> = evidence.recordings.iter().map(|it| it.name.as_str()).collect();
    all.dedup();
    all.join(", ")
}

/// Recordings together.
struct Several<'a> {
    evidence: &'a Evidence,
    channel: &'static str,
    drive: &'a Drive,
}

impl Several<'_> {
    fn one_speed(&self, speeds: &[f64]) -> Option<SignalFinding> {
        let (mean, share) = changes(speeds)?;
        (share < ONE_SPEED).then(|| {
            self.limits(
                What::OneSpeed,
                Size { value: share, of: "share of the speed by which it changes" },
                format!(
                    "the speed hardly changes ({:.1} % about {} {}): inertia and what grows with \
                     the speed are not told from what does not{}",
                    100.0 * share,
                    rounded_to(3, mean),
                    for_motion(self.drive.motion, "rad/s"),
                    self.of_base(&["J", "B_m", coulomb::LEVEL])
                ),
                "record steps to several speeds as well",
            )
        })
    }

    fn one_direction(&self, speeds: &[f64]) -> Option<SignalFinding> {
        let greatest = speeds.iter().fold(0.0_f64, |most, speed| most.max(speed.abs()));
        let certain = |sign: f64| {
            speeds.iter().filter(|speed| sign * **speed > SLOW * greatest).count() as f64
        };
        let (forward, backward) = (certain(1.0), certain(-1.0));
        let back = forward.min(backward) / (forward + backward);
        (back < FEW).then(|| {
            self.limits(
                What::OneDirection,
                Size { value: back, of: "share of the time the other way" },
                format!(
                    "the shaft turns one way only: dry friction is not told from a constant load, \
                     and nothing that depends on the direction shows{}",
                    self.of_base(&[coulomb::LEVEL, constant_load::OFFSET])
                ),
                "record both directions",
            )
        })
    }

    /// Those of these parameters that the drive has.
    fn of_base(&self, names: &[&str]) -> String {
        let fitted = self.drive.fitted();
        let has = |name: &&&str| fitted.iter().any(|it| it.name == **name);
        let some: Vec<&str> = names.iter().filter(has).copied().collect();
        if some.is_empty() { String::new() } else { format!(" ({})", some.join(", ")) }
    }

    fn limits(&self, what: What, size: Size, sentence: String, next: &str) -> SignalFinding {
        SignalFinding {
            recording: names(self.evidence),
            channel: self.channel.to_owned(),
            what,
            at: None,
            size,
            consequence: Consequence::Limits,
            sentence,
            next: next.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, driven, noisy};
    use drivescope_recording::Recording;

    fn found(recordings: &[&Recording]) -> Vec<SignalFinding> {
        let drive = dr300();
        let read = |it: &&Recording| Measured::new(&drive, it).expect("usable");
        let recordings: Vec<Measured> = recordings.iter().map(read).collect();
        let noise = vec![vec![0.01, 0.3]; recordings.len()];
        check(&drive, &Evidence { recordings, noise })
    }

    fn kinds(recordings: &[&Recording]) -> Vec<What> {
        found(recordings).iter().map(|it| it.what).collect()
    }

    #[test]
    fn rest_one_speed_and_one_direction_are_told_over_all_recordings() {
        let drive = dr300();
        let of = |u: Vec<f64>| noisy(driven(&drive, u, 0.001), [0.01, 0.3], 8);
        let bench = noisy(bench(&drive, 3.0, 0.001), [0.01, 0.3], 7);
        assert_eq!(kinds(&[&bench]), []);
        let still = of(vec![0.3; 2000]);
        assert_eq!(kinds(&[&still]), [What::AtRest]);
        assert!(found(&[&still])[0].forbids());
        let forward = of((0..4000).map(|k| 6.0 + 3.0 * (0.002 * f64::from(k)).sin()).collect());
        assert_eq!(kinds(&[&forward]), [What::OneDirection]);
        let words = found(&[&forward])[0].to_string();
        assert!(words.contains("T_c") && words.contains("both directions"), "{words}");
        let backward = of((0..4000).map(|k| -6.0 - 3.0 * (0.002 * f64::from(k)).sin()).collect());
        assert_eq!(kinds(&[&forward, &backward]), []);
        let steady = of(vec![8.0; 40_000]);
        assert_eq!(kinds(&[&steady]), [What::OneSpeed, What::OneDirection]);
        assert!(found(&[&steady])[0].to_string().contains("(J, B_m, coulomb.T_c)"));
        // Beside a rest the bench moves.
        assert_eq!(kinds(&[&still, &bench]), []);
    }
}
