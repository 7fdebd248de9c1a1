//! A fault of one mechanism that grows evenly from an onset on: onset and rate of greatest
//! likelihood.
//!
//! A fault that grows is noticed long after it began, and by then the belief holds some of it: what
//! the alarm tells of the onset is that of the step that resembles it most. So the onset is sought
//! among all rows that are kept, each with the belief before it. Along the process before the change,
//! one pass tells the likelihood ratios of all mechanisms from onsets at ages of a constant ratio;
//! from the best of each, Gauss-Newton steps in rate and onset run the filter with the fault in the
//! process. A size of r (k - o) at row k has the derivative k - o by the rate and -r by the onset.

use std::ops::{Range, RangeInclusive};

use super::columns::Columns;
use super::hypothesis::{Acting, Case, Fit};
use super::process::{MECHANISMS, Process};

/// Ratio of the ages of two onsets that are compared: between them the ratio of a ramp changes
/// little.
const AGES: f64 = 1.25;
/// Gauss-Newton steps at most.
const MOST_STEPS: usize = 8;
/// A step of less than this share of the standard deviation changes nothing that is printed.
const CONVERGED: f64 = 0.02;

/// A mechanism whose linearised likelihood ratio stays below a share of the best of all hypotheses,
/// and by more than so many nats, is not looked at more closely. Onsets that lie apart cost a true one
/// a hundredth, and a ramp explains at most 0.89 of a step.
const NEAR: f64 = 0.95;
/// The same share of one that was named before and has grown large since: what is not linear counts.
const NEAR_WHEN_LARGE: f64 = 0.7;
const APART: f64 = 6.0;

/// Rate, a row, and onset.
type Ramp = (f64, usize);

/// The ramps of all mechanisms that lie far apart, linearised.
struct Coarse {
    /// Logarithm of the likelihood of all rows without them.
    base: f64,
    /// The best of each mechanism, and what it gains.
    best: Vec<(Ramp, f64)>,
}

impl<const N: usize, P: Process<N>> Case<'_, N, P> {
    /// The mechanisms that may have grown from an onset up to row `latest`, of those that are not far
    /// below the likelihood of the best that stands. Where a fault stands already, it alone grows from
    /// what it is; others may have grown in its place, from where it began.
    pub(crate) fn growing(&self, latest: usize, stands: f64) -> Vec<Fit> {
        let latest = latest.min(self.kept.len().saturating_sub(2));
        let all = 0..self.healthy.mechanisms().len();
        let Some((standing, size)) = self.standing else {
            return self.near(all, 0.0, &(0..=latest), (stands, NEAR));
        };
        let since = self.named.since..=latest.max(self.named.since);
        let mut found = self.near(standing..standing + 1, size, &since, (stands, NEAR));
        if self.named.healthy > 0 {
            let out_of_health = 0..=self.named.healthy - 1;
            found.extend(self.near(all, 0.0, &out_of_health, (stands, NEAR_WHEN_LARGE)));
        }
        found
    }

    /// Those of some mechanisms that grow from that size, the onset within a range.
    fn near(
        &self,
        mechanisms: Range<usize>,
        from: f64,
        range: &RangeInclusive<usize>,
        (stands, share): (f64, f64),
    ) -> Vec<Fit> {
        let Coarse { base, best } = self.coarse(range);
        let gains = best[mechanisms.clone()].iter().map(|(_, gain)| *gain);
        let most = gains.fold(stands - base, f64::max);
        let is_near = |j: &usize| best[*j].1 >= share * most - APART;
        mechanisms.filter(is_near).map(|j| self.grown(j, from, best[j].0, range)).collect()
    }

    /// The best rate and onset of every mechanism among onsets of a range that lie far apart,
    /// linearised about the process that acted there.
    fn coarse(&self, range: &RangeInclusive<usize>) -> Coarse {
        let rows = self.kept.len();
        let mut onsets = Vec::new();
        let mut age = (rows - range.end()) as f64;
        while age < (rows - range.start()) as f64 {
            onsets.push(rows - age as usize);
            age *= AGES;
        }
        onsets.push(*range.start());
        // Before anything was named no fault acted, and that process goes on.
        let changes = if *range.start() < self.named.since { 0 } else { rows };
        let mut columns = vec![Columns::<N, MECHANISMS>::new(); onsets.len()];
        let run = self.run_from(*range.start(), Acting::Healthy, changes, |k, s, c, a| {
            for (columns, onset) in columns.iter_mut().zip(&onsets) {
                if k < *onset {
                    continue;
                }
                let grown = |of: &[f64; MECHANISMS]| of.map(|by| (k - onset) as f64 * by);
                let on_sensors = s.columns.each_ref().map(grown);
                let on_states = a.columns.each_ref().map(grown);
                columns.step((&on_sensors, &on_states), s, c, a);
            }
        });
        let mechanisms = 0..self.healthy.mechanisms().len();
        let best = mechanisms.map(|j| {
            let mut best = ((0.0, *range.start()), 0.0);
            for (columns, onset) in columns.iter().zip(&onsets) {
                let (score, gram) = (columns.score[j], columns.gram[j][j]);
                let gain = 0.5 * score * score / gram;
                if gain > best.1 {
                    best = ((score / gram, *onset), gain);
                }
            }
            best
        });
        Coarse { base: run.log_likelihood, best: best.collect() }
    }

    /// The rate and onset of greatest likelihood of a mechanism that grows from that size, from start
    /// values; the onset within a range.
    fn grown(
        &self,
        mechanism: usize,
        from: f64,
        (mut rate, mut onset): Ramp,
        range: &RangeInclusive<usize>,
    ) -> Fit {
        let about = &self.healthy.mechanisms()[mechanism];
        let last = self.kept.len() - 1;
        let (earliest, latest) = (*range.start() as f64, *range.end() as f64);
        let mut best: Option<(Ramp, Fit)> = None;
        for _ in 0..MOST_STEPS {
            let rows = (last - onset).max(1) as f64;
            rate = rate.clamp((about.least - from) / rows, (about.most - from) / rows);
            let mut own = Columns::<N, 2>::new();
            let run = self.run(Acting::Growing { mechanism, from, rate }, onset, |k, s, c, a| {
                if k >= onset {
                    let both = |of: f64| [(k - onset) as f64 * of, of];
                    let on_sensors = s.columns.each_ref().map(|of| both(of[mechanism]));
                    let on_states = a.columns.each_ref().map(|of| both(of[mechanism]));
                    own.step((&on_sensors, &on_states), s, c, a);
                }
            });
            if let Some(((last_rate, last_onset), fit)) = best
                && run.log_likelihood < fit.log_likelihood
            {
                // Too far: half way back.
                let near = (0.5 * (rate + last_rate), last_onset.midpoint(onset));
                if near == (rate, onset) || near == (last_rate, last_onset) {
                    break;
                }
                (rate, onset) = near;
                continue;
            }
            let [[g_rr, g_rl], [_, g_ll]] = own.gram;
            let determinant = g_rr * g_ll - g_rl * g_rl;
            let (var_rate, var_level, shared) =
                (g_ll / determinant, g_rr / determinant, -g_rl / determinant);
            // Of the size at the last row, rows * rate + level.
            let var_size = rows * rows * var_rate + 2.0 * rows * shared + var_level;
            let [s_r, s_l] = own.score;
            let fit = Fit {
                mechanism,
                onset,
                size: from + rate * rows,
                sd: var_size.sqrt(),
                growth: Some((rate, var_rate.sqrt())),
                log_likelihood: run.log_likelihood,
            };
            best = Some(((rate, onset), fit));
            let level = shared * s_r + var_level * s_l;
            let moved = (onset as f64 - level / rate).round().clamp(earliest, latest);
            let moved = if moved.is_nan() { onset } else { moved as usize };
            let step = if moved == onset { s_r / g_rr } else { var_rate * s_r + shared * s_l };
            let is_small = step.abs() <= CONVERGED * var_rate.sqrt();
            if step.is_nan() || (moved == onset && is_small) {
                break;
            }
            (rate, onset) = (rate + step, moved);
        }
        best.map_or(Fit::nothing(mechanism, onset), |(_, fit)| fit)
    }
}
