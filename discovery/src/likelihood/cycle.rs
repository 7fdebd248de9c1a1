//! A load that oscillates: where it may, from the spectrum of what the filter takes for the load.

use std::f64::consts::TAU;

use super::gram::References;
use super::guess::slowest;
use super::judge::{FINE, Judge};
use super::noise::Cycle;
use super::randomness::Randomness;
use super::scene::{Recorded, Scene};
use super::state::LOAD;
use super::track::Track;

/// Share of what a cycle must gain that the best of the first guesses gains where something oscillates.
const PROMISING: f64 = 0.25;
/// Peaks of the spectrum that are tried.
const PEAKS: usize = 3;
/// Frequencies to a period of the recording's inverse length.
const A_LINE: f64 = 2.0;
/// Periods in a recording from which on something oscillates: what comes again a few times may be
/// what the drive was made to do.
const OFTEN: f64 = 8.0;
/// The same in all of what keeps its phase over that share of a recording: a line of it.
const OFTEN_ALIKE: f64 = 16.0;
const FORGETS: f64 = 0.5;
/// Highest frequency over that of the samples.
const HIGHEST: f64 = 0.2;
/// Neighbours on either side among which a peak stands out.
const NEAR: usize = 12;
/// Memories that are tried, in periods of the oscillation.
const PERIODS: [f64; 2] = [2.0, 20.0];
/// Factor on the rest of the load beside the cycle.
const REST: [f64; 2] = [1.0, 0.3];

impl Randomness {
    /// With a cycle where one makes the recordings that much more probable; itself otherwise.
    pub(super) fn oscillating(&self, scene: &Scene, references: &References) -> Option<Self> {
        let judge = Judge::of(scene, references, self)?;
        let before = judge.of_randomness(self)?;
        let mut best = (before, *self);
        for (hz, sd) in peaks(scene, judge.tracks()) {
            for (periods, rest) in PERIODS.into_iter().flat_map(|it| REST.map(|rest| (it, rest))) {
                let cycle = Some(Cycle { sd, hz, s: periods / hz });
                let tried = Self { cycle, load_sd: rest * self.load_sd, ..*self };
                let evidence = judge.of_randomness(&tried).unwrap_or(f64::NEG_INFINITY);
                if evidence > best.0 {
                    best = (evidence, tried);
                }
            }
        }
        if best.0 + PROMISING * best.1.ln_prior() <= before {
            return Some(*self);
        }
        let searched = best.1.searched(scene, references, FINE)?;
        // One that leaves the peak it was tried for is a slow load of another form.
        let (longest_s, all_s) = lengths_s(scene, judge.tracks());
        let at_peak =
            |from: Cycle, it: Cycle| (it.hz - from.hz).abs() < 1.0 / longest_s + 1.0 / (TAU * it.s);
        let random = |it: Cycle| it.s < FORGETS * longest_s || it.hz * all_s > OFTEN_ALIKE;
        let oscillates = |(from, it): (Cycle, Cycle)| at_peak(from, it) && random(it);
        let oscillates = best.1.cycle.zip(searched.cycle).is_some_and(oscillates);
        let worth = oscillates && judge.of_randomness(&searched)? + searched.ln_prior() > before;
        Some(if worth { searched } else { *self })
    }
}

/// The longest stretch, and all of them, s.
fn lengths_s(scene: &Scene, tracks: &[Track]) -> (f64, f64) {
    let length_s =
        |(track, it): (&Track, &Recorded)| track.ticks.len() as f64 * it.measured.period_s;
    let each = tracks.iter().zip(&scene.recordings).map(length_s);
    each.fold((0.0, 0.0), |(longest, all), it| (f64::max(longest, it), all + it))
}

/// Frequencies that stand out of the load's spectrum most, Hz, with the standard deviation of what
/// stands there.
fn peaks(scene: &Scene, tracks: &[Track]) -> Vec<(f64, f64)> {
    let apart = 1.0 / (A_LINE * lengths_s(scene, tracks).0);
    let count = (HIGHEST / slowest(scene) / apart) as usize;
    let frequencies: Vec<f64> =
        ((OFTEN * A_LINE) as usize..count).map(|k| k as f64 * apart).collect();
    let samples: usize = tracks.iter().map(|track| track.ticks.len()).sum();
    let power = |hz: &f64| -> f64 {
        let of = |(track, it): (&Track, &Recorded)| {
            let step = (TAU * hz * it.measured.period_s).sin_cos();
            let (mut turn, mut sum) = ((0.0, 1.0), (0.0, 0.0));
            for tick in &track.ticks {
                let load = tick.filtered[LOAD];
                sum = (sum.0 + load * turn.0, sum.1 + load * turn.1);
                turn = (turn.0 * step.1 + turn.1 * step.0, turn.1 * step.1 - turn.0 * step.0);
            }
            // The mean square of a sinus is half of that of its amplitude.
            2.0 * (sum.0 * sum.0 + sum.1 * sum.1) / track.ticks.len().max(1) as f64
        };
        tracks.iter().zip(&scene.recordings).map(of).sum::<f64>() / samples.max(1) as f64
    };
    let powers: Vec<f64> = frequencies.iter().map(power).collect();
    let out = |k: usize| {
        let mut near: Vec<f64> =
            powers[k.saturating_sub(NEAR)..(k + NEAR + 1).min(powers.len())].to_vec();
        near.sort_by(f64::total_cmp);
        powers[k] / near[near.len() / 2].max(f64::MIN_POSITIVE)
    };
    let is_peak = |k: &usize| {
        (*k == 0 || powers[*k] >= powers[*k - 1])
            && powers.get(*k + 1).is_none_or(|next| powers[*k] > *next)
    };
    let mut found: Vec<(f64, usize)> =
        (0..powers.len()).filter(is_peak).map(|k| (out(k), k)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(PEAKS);
    found.into_iter().map(|(_, k)| (frequencies[k], powers[k].sqrt())).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::direction::Direction;
    use super::super::judge::COARSE;
    use super::super::scene::longest;
    use super::super::state::SENSORS;
    use super::*;
    use crate::measured::Measured;
    use crate::testing::{dr300, loaded, noisy, random_load};

    const SDS: [f64; SENSORS] = [0.01, 0.3, 1.0];
    const PERIOD_S: f64 = 0.002;
    const SAMPLES: usize = 4000;
    /// Standard deviation of the load that is not recorded, N m.
    const LOAD: f64 = 0.01;

    /// What is found of the drive under that load besides a random one, in one direction.
    fn found(load: impl Fn(usize) -> f64) -> Option<Cycle> {
        let drive = dr300();
        let u = (0..SAMPLES).map(|k| 12.0 + 4.0 * (0.005 * k as f64).sin()).collect();
        let load: Vec<f64> = (0..SAMPLES).map(load).collect();
        let [i, omega, _] = SDS;
        let recording = noisy(loaded(&drive, u, &load, PERIOD_S), [i, omega], 3);
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let recorded = Recorded {
            place: 0,
            drive: drive.clone(),
            own: Vec::new(),
            direction: Arc::new(Direction::of(&measured, &SDS)),
            measured: Arc::new(measured),
            noise: SDS,
            held_out: false,
        };
        let names = ["R", "K_m", "J", "B_m"].map(str::to_owned).to_vec();
        let speed = 200.0;
        let longest_s = longest(&drive, speed);
        let scene = Scene { drive, names, recordings: vec![recorded], speed, longest_s };
        let (begin, references) = Randomness::begin(&scene).expect("it does not overflow");
        let searched = begin.searched(&scene, &references, COARSE).expect("the same");
        searched.oscillating(&scene, &references).expect("the same").cycle
    }

    /// A random load that forgets what it was after that time, s.
    fn wandering(time_s: f64, seed: u64) -> Vec<f64> {
        random_load(SAMPLES, PERIOD_S, (LOAD, time_s), seed)
    }

    #[test]
    fn a_load_that_oscillates_is_found_with_its_frequency() {
        let slow = wandering(0.2, 4);
        let hz = 6.0;
        let cycle = found(|k| slow[k] + LOAD * (TAU * hz * k as f64 * PERIOD_S).sin());
        let cycle = cycle.expect("it oscillates");
        assert!((cycle.hz - hz).abs() < 0.5, "{cycle:?}");
        assert!(cycle.s > 3.0 / hz, "{cycle:?}");
    }

    #[test]
    fn a_random_load_does_not_oscillate() {
        for seed in 5..9 {
            let load = wandering(0.1, seed);
            assert_eq!(found(|k| load[k]), None, "seed {seed}");
        }
    }
}
