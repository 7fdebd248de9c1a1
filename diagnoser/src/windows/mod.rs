//! Windows of the residual against a healthy baseline of the same machine or day.
//!
//! What differs from machine to machine and from day to day shifts the residual of a model by far
//! more than its noise within one run. A short healthy run tells that shift and the spread; then
//! the mean and the logarithm of the standard deviation over a window are judged. Their limits are
//! such that of healthy runs, each judged by its own begin, a designed share raises any alarm: the
//! greatest values of runs have a Gumbel distribution, whose two parameters the lower four fifths of
//! them give, so that a run that is not healthy after all does not widen them. A drive that rests or
//! runs down is not judged.
//!
//! A healthy machine warms up, and its residual drifts with it by more than it changes within a few
//! seconds. While windows lie inside, the mean that they are held against follows them over
//! [`FOLLOWED`] windows, in the design and at work: what comes at once is seen when it is small. How
//! far a mean may drift from the baseline, however slowly, has a limit of its own.

use std::collections::VecDeque;

use drivescope_numerics::Regression;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::data::Data;
use crate::memory::{Memory, MemoryError, Walk};

mod lag;
mod standstill;

pub use lag::{Lag, LagRun};
pub use standstill::Standstill;

/// Time of a window and of a baseline, s.
pub(crate) const WINDOW_S: f64 = 2.0;
pub(crate) const BASELINE_S: f64 = 4.0;
/// Share of healthy runs that raise an alarm.
pub const FALSE_RUNS: f64 = 0.035;
/// Runs below which long ones are cut into stretches, and below which there is no design.
const FEW: usize = 8;
const FEWEST: usize = 5;
/// A baseline may be so many times shorter than those of the design.
const SHORTER: usize = 4;
/// Stretches are so many windows long.
const STRETCH: usize = 10;
/// Windows over which the mean of a healthy residual is followed.
pub const FOLLOWED: usize = 2;
/// Part of the greatest values that tell their distribution.
const PLOTTED: f64 = 0.8;
/// Statistics of a window, which share the runs that may raise an alarm.
const STATISTICS: usize = 3;

/// Mean and standard deviation of a healthy residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Baseline {
    /// Mean, output unit.
    pub mean: f64,
    /// Standard deviation, output unit.
    pub deviation: f64,
}

/// Length and limits of the windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Windows {
    /// Samples of a window.
    pub samples: usize,
    /// Samples at least that a baseline is taken from.
    pub baseline: usize,
    /// Greatest departure of a window's mean from the followed one, output unit: what comes at once.
    pub mean: f64,
    /// Greatest departure of a window's mean from the baseline's, output unit: what comes slowly. Older
    /// files hold none.
    #[serde(default)]
    pub drift: Option<f64>,
    /// Greatest logarithm of a window's standard deviation over the baseline's.
    pub spread: f64,
    /// Samples over which the mean of a healthy residual is followed; 0 if it is not.
    #[serde(default)]
    pub followed: usize,
    /// Healthy runs that the limits rest on.
    pub runs: usize,
    /// Model of the output.
    pub model: Lag,
}

/// Why a baseline is none.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WindowError {
    /// Too few samples.
    #[error("{samples} samples, a baseline is taken from {needed} or more")]
    TooShort {
        /// Samples given.
        samples: usize,
        /// Samples needed.
        needed: usize,
    },
    /// Nothing moves.
    #[error("it was recorded at rest: let the drive run")]
    AtRest,
    /// Its halves differ by more than health allows.
    #[error(
        "something changes within it: its halves differ by {by:.3}, healthy ones by {limit:.3} at most"
    )]
    Changes {
        /// Difference of the means of the residual, output unit.
        by: f64,
        /// What is healthy.
        limit: f64,
    },
}

impl Baseline {
    /// That of a residual.
    pub fn of(residual: &[f64]) -> Self {
        let n = residual.len() as f64;
        let mean = residual.iter().sum::<f64>() / n;
        let squares: f64 = residual.iter().map(|r| (r - mean).powi(2)).sum();
        Self { mean, deviation: (squares / n).sqrt() }
    }
}

impl Windows {
    /// Fits the model and designs the limits on healthy runs, the segments of `data`; nothing if
    /// there are too few.
    pub fn design(data: &[&Data], (samples, baseline): (usize, usize)) -> Option<Self> {
        let model = Lag::fit(data, 0.5 * samples as f64)?;
        let mut runs = Vec::new();
        for data in data {
            let residual = model.residual(data);
            for segment in data.segments() {
                let first = segment.start..segment.end.min(segment.start + baseline);
                let mean =
                    |values: &[f64]| values[first.clone()].iter().sum::<f64>() / first.len() as f64;
                // A run that begins at rest is no example of how one goes on from its begin.
                if !model.is_at_rest(data.inputs().iter().map(|column| mean(column.values))) {
                    let mut rest = Standstill::default();
                    let sample = |k: usize| {
                        let u = data.inputs().iter().map(|it| it.values[k]);
                        (residual[k], rest.step(&model, u, data.output().values[k], samples))
                    };
                    runs.push(segment.clone().map(sample).collect::<Vec<_>>());
                }
            }
        }
        let long = |run: &Vec<(f64, bool)>| run.len() >= baseline + 2 * samples;
        runs.retain(long);
        if runs.len() < FEW {
            let stretch = baseline + STRETCH * samples;
            let cut = |run: &Vec<(f64, bool)>| -> Vec<Vec<(f64, bool)>> {
                run.chunks(stretch).map(<[_]>::to_vec).collect()
            };
            runs = runs.iter().flat_map(cut).filter(long).collect();
        }
        if runs.len() < FEWEST {
            return None;
        }
        let unlimited = Self {
            samples,
            baseline,
            mean: f64::INFINITY,
            drift: Some(f64::INFINITY),
            spread: f64::INFINITY,
            followed: FOLLOWED * samples,
            runs: runs.len(),
            model,
        };
        let greatest = |run: &Vec<(f64, bool)>| {
            let (first, rest) = run.split_at(baseline);
            let first: Vec<f64> = first.iter().map(|(residual, _)| *residual).collect();
            let mut watch = unlimited.watch(Baseline::of(&first));
            rest.iter()
                .filter_map(|(residual, rests)| watch.unless(*rests, *residual))
                .fold([0.0_f64; STATISTICS], |top, of| std::array::from_fn(|k| top[k].max(of[k])))
        };
        let all: Vec<[f64; STATISTICS]> = runs.iter().map(greatest).collect();
        let limit = |which: usize| gumbel_limit(all.iter().map(|of| of[which]).collect());
        Some(Self { mean: limit(0)?, drift: Some(limit(1)?), spread: limit(2)?, ..unlimited })
    }

    /// What a healthy run tells of the machine and the day.
    ///
    /// # Errors
    /// A run that is too short, at rest, or not healthy.
    pub fn baseline_of(&self, data: &Data) -> Result<Baseline, WindowError> {
        let (samples, needed) = (data.len(), (self.baseline / SHORTER).max(2));
        if samples < needed {
            return Err(WindowError::TooShort { samples, needed });
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        if self.model.is_at_rest(data.inputs().iter().map(|column| mean(column.values))) {
            return Err(WindowError::AtRest);
        }
        let residual = self.model.residual(data);
        let (first, second) = residual.split_at(samples / 2);
        let by = (mean(first) - mean(second)).abs();
        // Means over less than a window scatter.
        let scatter = (self.samples as f64 / first.len() as f64).sqrt().max(1.0);
        let limit = scatter * (self.mean + if self.followed > 0 { self.drift() } else { 0.0 });
        if by > limit {
            return Err(WindowError::Changes { by, limit });
        }
        // A drive that is still running in is as it goes on: its end stands for it.
        let settles = by > scatter * self.mean && second.len() >= needed;
        Ok(Baseline::of(if settles { second } else { &residual }))
    }

    /// Greatest departure that comes slowly; in files that hold no limit of it, twice what may come at
    /// once: a mean that was followed up to one limit is seen at two.
    fn drift(&self) -> f64 {
        self.drift.unwrap_or(2.0 * self.mean)
    }

    fn is_exceeded(&self, [mean, drift, spread]: [f64; STATISTICS]) -> bool {
        mean > self.mean || drift > self.drift() || spread > self.spread
    }

    /// Windows from here on.
    pub fn watch(&self, baseline: Baseline) -> WindowWatch {
        let last = VecDeque::with_capacity(self.samples);
        WindowWatch { design: self.clone(), baseline, drift: 0.0, last }
    }
}

/// The value that a Gumbel variable exceeds with the designed share: the line through the lower part of
/// its probability plot, at the plotting positions of Gringorten. What lies above, runs among them that
/// are not healthy after all, does not tilt it, and it uses twice the runs that quartiles do.
fn gumbel_limit(mut greatest: Vec<f64>) -> Option<f64> {
    greatest.sort_by(f64::total_cmp);
    let n = greatest.len() as f64;
    // The value below which a Gumbel variable lies with probability p is location - scale ln(-ln p).
    let standard = |p: f64| -(-p.ln()).ln();
    let mut line = Regression::new(2);
    for (k, value) in greatest.iter().enumerate() {
        let p = (k as f64 + 0.56) / (n + 0.12);
        if p < PLOTTED {
            line.push([1.0, standard(p)], *value);
        }
    }
    let line = line.solve().ok()?.parameters;
    Some(line[0] + line[1] * standard(1.0 - FALSE_RUNS / STATISTICS as f64))
}

/// The last window.
#[derive(Debug, Clone)]
pub struct WindowWatch {
    design: Windows,
    baseline: Baseline,
    /// What the healthy mean has moved by since the baseline, output unit.
    drift: f64,
    last: VecDeque<f64>,
}

impl WindowWatch {
    /// Samples of a window.
    pub fn samples(&self) -> usize {
        self.design.samples
    }

    /// After a gap the window is empty.
    pub fn reset(&mut self) {
        self.last.clear();
    }

    /// The same where the sample is judged; else the window begins anew.
    fn unless(&mut self, unjudged: bool, residual: f64) -> Option<[f64; STATISTICS]> {
        if unjudged {
            self.reset();
            return None;
        }
        self.measured(residual)
    }

    /// Departures of the mean from the followed one and from the baseline's, and logarithm of the
    /// spread, once the window is full; the healthy mean follows one that lies inside.
    fn measured(&mut self, residual: f64) -> Option<[f64; STATISTICS]> {
        if self.last.len() == self.design.samples {
            self.last.pop_front();
        }
        self.last.push_back(residual);
        if self.last.len() < self.design.samples {
            return None;
        }
        let Baseline { mean, deviation } = Baseline::of(self.last.make_contiguous());
        let drifted = mean - self.baseline.mean;
        let departure = drifted - self.drift;
        let spread = (deviation / self.baseline.deviation).ln();
        let measured = [departure.abs(), drifted.abs(), spread];
        let followed = self.design.followed;
        if followed > 0 && !self.design.is_exceeded(measured) {
            self.drift += departure / followed as f64;
        }
        Some(measured)
    }

    /// Departure of the mean of the last window from the baseline, once it is full, and what is
    /// healthy of it.
    pub fn departure(&self) -> Option<(f64, f64)> {
        let full = self.last.len() == self.design.samples;
        let mean = self.last.iter().sum::<f64>() / self.last.len() as f64;
        full.then_some((mean - self.baseline.mean - self.drift, self.design.mean))
    }

    /// Takes a residual; whether the window that it closes lies outside, once there is one. An
    /// `unjudged` one empties the window.
    pub fn step(&mut self, residual: f64, unjudged: bool) -> Option<bool> {
        let measured = self.unless(unjudged, residual)?;
        Some(self.design.is_exceeded(measured))
    }
}

impl Memory for WindowWatch {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.drift.walk(walk)?;
        walk.list(&mut self.last, self.design.samples, || 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::testing::noise;

    fn design() -> Windows {
        let model = Lag { pole: 0.9, constant: 0.0, gains: vec![2.0], zones: vec![0.5] };
        Windows {
            samples: 100,
            baseline: 200,
            mean: 0.6,
            drift: Some(1.2),
            spread: 0.4,
            followed: 1000,
            runs: 10,
            model,
        }
    }

    #[test]
    fn a_shift_and_a_wider_spread_show_within_a_window() {
        let health = noise(1000, 1);
        let baseline = Baseline::of(&health[..200]);
        let outside = |change: fn(f64) -> f64| {
            let mut watch = design().watch(baseline);
            let rows = health[200..].iter().enumerate();
            let changed = rows.map(|(k, r)| if k < 400 { *r } else { change(*r) });
            changed.map(|r| watch.step(r, false) == Some(true)).collect::<Vec<_>>()
        };
        assert!(outside(|r| r).iter().all(|outside| !outside));
        for change in [|r| r + 1.0, |r| r - 1.0, |r| 2.0 * r] {
            let found = outside(change);
            assert!(found[..400].iter().all(|outside| !outside) && found[499..].iter().all(|o| *o));
        }
    }

    #[test]
    fn a_slow_drift_is_followed_up_to_a_limit_of_its_own() {
        let health = noise(20_000, 7);
        let baseline = Baseline::of(&health[..200]);
        let first = |per_sample: f64| {
            let mut watch = design().watch(baseline);
            health.iter().enumerate().position(|(k, r)| {
                let drift = (per_sample * k as f64).min(3.0);
                watch.step(0.3 * r + drift, false) == Some(true)
            })
        };
        // 0.6 is the limit of what comes at once, 1.2 of what has grown.
        assert!(first(0.0).is_none());
        let seen = first(0.0002).expect("it grows to 3");
        assert!((4500..7000).contains(&seen), "{seen}");
        assert!(first(0.01).expect("at once") < 200);
    }

    #[test]
    fn the_model_finds_gain_lag_and_dead_zone() {
        let u: Vec<f64> = (0..3000).map(|k| 3.0 * (0.01 * k as f64).sin()).collect();
        let exact = Lag { pole: 0.95, constant: 0.0, gains: vec![4.0], zones: vec![0.6] };
        let mut run = LagRun::new(exact.clone());
        let e = noise(u.len(), 3);
        let y: Vec<f64> = u.iter().zip(e).map(|(u, e)| run.step(&[*u]) + 0.1 * e).collect();
        let (input, output) = (Column { name: "u", values: &u }, Column { name: "y", values: &y });
        let data = Data::new(vec![input], output).expect("finite");
        let found = Lag::fit(&[&data], 60.0).expect("it tells one");
        assert!(
            (found.gains[0] - 4.0).abs() < 0.3 && (found.zones[0] - 0.6).abs() < 0.2,
            "{found:?}"
        );
        assert!(Baseline::of(&found.residual(&data)).deviation < 0.3);
        assert!(exact.is_at_rest([0.5].into_iter()) && !exact.is_at_rest([0.7].into_iter()));
    }

    #[test]
    fn baselines_that_are_none_are_refused() {
        let design = design();
        let of = |u: f64, y: &[f64]| {
            let u = vec![u; y.len()];
            let (input, output) =
                (Column { name: "u", values: &u }, Column { name: "y", values: y });
            design.baseline_of(&Data::new(vec![input], output).expect("finite"))
        };
        let health: Vec<f64> = noise(300, 5).iter().map(|e| 5.0 + e).collect();
        assert!((of(3.0, &health).expect("it is one").mean).abs() < 0.3);
        assert_eq!(of(3.0, &health[..40]), Err(WindowError::TooShort { samples: 40, needed: 50 }));
        assert_eq!(of(0.2, &health), Err(WindowError::AtRest));
        let changed: Vec<f64> =
            health.iter().enumerate().map(|(k, y)| if k < 150 { *y } else { y + 4.0 }).collect();
        assert!(matches!(of(3.0, &changed), Err(WindowError::Changes { .. })));
        // One that is still running in is as its end.
        let settling: Vec<f64> =
            health.iter().enumerate().map(|(k, y)| if k < 150 { *y + 1.4 } else { *y }).collect();
        assert!(of(3.0, &settling).expect("it is one").mean.abs() < 0.3);
    }

    /// Maxima of 100 exponential numbers are Gumbel distributed about ln 100.
    #[test]
    fn the_limit_is_that_of_the_designed_share_and_minds_no_outlier() {
        let uniform = |k: usize| (k as f64 + 0.5) / 200.0;
        let mut maxima: Vec<f64> =
            (0..200).map(|k| 100_f64.ln() - (-uniform(k).ln()).ln()).collect();
        let exact = 100_f64.ln() - (-(1.0 - FALSE_RUNS / STATISTICS as f64).ln()).ln();
        let limit = |maxima: &[f64]| gumbel_limit(maxima.to_vec()).expect("finite");
        assert!((limit(&maxima) - exact).abs() < 0.1);
        maxima.push(1e3);
        assert!((limit(&maxima) - exact).abs() < 0.2);
    }
}
