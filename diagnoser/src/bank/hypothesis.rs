//! A fault of one mechanism that stands from one onset on: its size of greatest likelihood.
//!
//! The filter runs over the rows with the fault in the process, so that nothing is linearised in
//! the size at the end; Gauss-Newton steps in the size take the derivative of the innovations,
//! which is propagated through the same filter.

use super::columns::Columns;
use super::filter::Correction;
use super::named::Named;
use super::process::{Advanced, Belief, Process, Row, SENSORS, Sensed};

/// Steps in which the size of a growing fault is filtered: they leave of its likelihood ratio 1 / 4 of the
/// inverse square of this number, and a process under another fault costs more than a row.
const STAIRS: usize = 128;
/// Gauss-Newton steps at most; three are usual for a fault of a fifth.
const MOST_STEPS: usize = 8;
/// A step of less than this share of the standard deviation changes nothing that is printed.
const CONVERGED: f64 = 0.02;

/// Rows about a change, and the two processes before and after which it happened.
#[derive(Debug)]
pub(crate) struct Case<'a, const N: usize, P> {
    /// The process without a fault.
    pub(crate) healthy: &'a P,
    /// The process that acted before the change.
    pub(crate) before: &'a P,
    /// The fault that acts in it: mechanism and size.
    pub(crate) standing: Option<(usize, f64)>,
    /// One row or more, each with the belief before it.
    pub(crate) kept: &'a [(Belief<N>, Row)],
    /// A fault that was named among them.
    pub(crate) named: Named,
    /// Logarithm of the likelihood of the rows before each, and of all, under the process of their
    /// beliefs; what was named holds for all rows before that.
    told: Vec<f64>,
}

/// A fault and how well it explains the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fit {
    pub(crate) mechanism: usize,
    /// First faulty row.
    pub(crate) onset: usize,
    /// Size at the last row.
    pub(crate) size: f64,
    /// Standard deviation of the size.
    pub(crate) sd: f64,
    /// Change of the size a row and its standard deviation; none of a fault that stands.
    pub(crate) growth: Option<(f64, f64)>,
    /// Logarithm of the likelihood of all rows.
    pub(crate) log_likelihood: f64,
}

/// What a fault does from a row on: a mechanism of that size, one that changes its size by `rate` a
/// row, a sensor that is stuck, or nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Acting {
    Healthy,
    Fault { mechanism: usize, size: f64 },
    Growing { mechanism: usize, from: f64, rate: f64 },
    Frozen { sensor: usize },
}

/// What a run of the filter over a case came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run<const N: usize> {
    pub(crate) log_likelihood: f64,
    /// Belief about the row after the last.
    pub(crate) end: Belief<N>,
}

impl<'a, const N: usize, P: Process<N>> Case<'a, N, P> {
    /// The rows after which a change is judged.
    pub(crate) fn new(
        (healthy, before): (&'a P, &'a P),
        standing: Option<(usize, f64)>,
        kept: &'a [(Belief<N>, Row)],
        named: Named,
    ) -> Self {
        let mut told = vec![0.0; kept.len() + 1];
        let mut tell = |from: usize, to: usize, process: &P, start: f64| {
            let (mut process, mut sum) = (process.clone(), start);
            for (k, (belief, row)) in kept.iter().enumerate().take(to).skip(from) {
                told[k] = sum;
                let sensed = process.sense(&belief.mean, row);
                sum += density(&belief.clone().correct(&sensed, row));
            }
            told[to] = sum;
            sum
        };
        let until_named = tell(0, named.healthy, healthy, 0.0) + named.gain;
        tell(named.since, kept.len(), before, until_named);
        Self { healthy, before, standing, kept, named, told }
    }

    /// What is kept of a fault that is named after the last row; nothing if it did not follow health.
    pub(crate) fn out_of_health(&self, fit: &Fit, log_likelihood: f64) -> Option<Named> {
        let since = self.kept.len();
        let healthy = if self.standing.is_none() { since } else { self.named.healthy };
        let gain = log_likelihood - self.told[healthy];
        (fit.onset < healthy).then_some(Named { onset: fit.onset, healthy, since, gain })
    }

    /// Filters the rows from the one before row `onset` with what acts from there on; `each` is told
    /// of every row, with its number. What is kept of the rows before stands.
    pub(crate) fn run(
        &self,
        acting: Acting,
        onset: usize,
        each: impl FnMut(usize, &Sensed<N>, &Correction<N>, &Advanced<N>),
    ) -> Run<N> {
        // A row under another process than the onset's says nothing of what acted before it.
        let earliest = if onset >= self.named.since { self.named.since } else { 0 };
        self.run_from(onset.saturating_sub(1).max(earliest), acting, onset, each)
    }

    /// The same from row `first` on.
    pub(crate) fn run_from(
        &self,
        first: usize,
        acting: Acting,
        onset: usize,
        mut each: impl FnMut(usize, &Sensed<N>, &Correction<N>, &Advanced<N>),
    ) -> Run<N> {
        let before = if first < self.named.since { self.healthy } else { self.before };
        let mut before = before.clone();
        let mut after = match acting {
            Acting::Fault { mechanism, size } => self.healthy.with_fault(mechanism, size),
            Acting::Healthy | Acting::Growing { .. } | Acting::Frozen { .. } => {
                self.healthy.clone()
            }
        };
        let quanta = self.healthy.quanta();
        let stair = self.kept.len().saturating_sub(onset).div_ceil(STAIRS).max(1);
        let first = first.min(self.kept.len() - 1);
        let mut belief = self.kept[first].0;
        let mut log_likelihood = self.told[first];
        for (k, (_, row)) in self.kept.iter().enumerate().skip(first) {
            if let Acting::Growing { mechanism, from, rate } = acting
                && k >= onset
                && (k - onset).is_multiple_of(stair)
            {
                let middle = (k - onset) as f64 + 0.5 * (stair - 1) as f64;
                after.set_fault(mechanism, from + rate * middle);
            }
            let process = if k < onset { &mut before } else { &mut after };
            let mut row = *row;
            if let Acting::Frozen { sensor } = acting
                && k >= onset
            {
                // The stuck value was certain: what is left is the quantum that it lies in.
                if row.shown[sensor].is_finite() && quanta[sensor] > 0.0 {
                    log_likelihood -= quanta[sensor].ln();
                }
                row.shown[sensor] = f64::NAN;
            }
            let sensed = process.sense(&belief.mean, &row);
            let correction = belief.correct(&sensed, &row);
            let mut advanced = process.advance(&belief, &row);
            if let Acting::Fault { mechanism, size } = acting
                && k + 1 == onset
            {
                begin_within(&mut advanced, mechanism, size);
            }
            log_likelihood += density(&correction);
            each(k, &sensed, &correction, &advanced);
            belief = belief.moved(&advanced);
        }
        Run { log_likelihood, end: belief }
    }

    /// What a fit says that acts.
    pub(crate) fn acting(&self, fit: &Fit) -> Acting {
        let Fit { mechanism, onset, size, .. } = *fit;
        fit.growth.map_or(Acting::Fault { mechanism, size }, |(rate, _)| {
            let from = size - rate * (self.kept.len() - 1 - onset) as f64;
            Acting::Growing { mechanism, from, rate }
        })
    }

    /// The size of greatest likelihood of a mechanism from that onset, from a start value.
    pub(crate) fn fit(&self, mechanism: usize, onset: usize, start: f64) -> Fit {
        let about = &self.healthy.mechanisms()[mechanism];
        let mut size = start;
        let mut best: Option<Fit> = None;
        for _ in 0..MOST_STEPS {
            let mut own = Columns::<N, 1>::new();
            let run = self.run(Acting::Fault { mechanism, size }, onset, |k, s, c, a| {
                if k >= onset {
                    let on_sensors = s.columns.each_ref().map(|of| [of[mechanism]]);
                    let on_states = a.columns.each_ref().map(|of| [of[mechanism]]);
                    own.step((&on_sensors, &on_states), s, c, a);
                }
            });
            let (score, gram) = (own.score[0], own.gram[0][0]);
            let log_likelihood = run.log_likelihood;
            if let Some(last) = best.filter(|last| log_likelihood < last.log_likelihood) {
                // Too far: half way back.
                if (size - last.size).abs() < CONVERGED * last.sd {
                    break;
                }
                size = 0.5 * (size + last.size);
                continue;
            }
            // Not a number where the mechanism does not show at all.
            let (step, sd) = (score / gram, 1.0 / gram.sqrt());
            best = Some(Fit { mechanism, onset, size, sd, growth: None, log_likelihood });
            let next = (size + step).clamp(about.least, about.most);
            if step.is_nan() || step.abs() <= CONVERGED * sd || next == size {
                break;
            }
            size = next;
        }
        best.unwrap_or(Fit::nothing(mechanism, onset))
    }

    /// The same over onsets within `spread` rows of one.
    pub(crate) fn best(&self, mechanism: usize, onset: usize, spread: usize) -> Fit {
        let mut best = self.fit(mechanism, onset, 0.0);
        let last = (onset + spread).min(self.kept.len() - 1);
        for other in onset.saturating_sub(spread).max(self.named.since)..=last {
            if other != onset {
                let fit = self.fit(mechanism, other, best.size);
                if fit.log_likelihood > best.log_likelihood {
                    best = fit;
                }
            }
        }
        best
    }
}

impl Fit {
    /// One that explains nothing.
    pub(crate) fn nothing(mechanism: usize, onset: usize) -> Self {
        Self {
            mechanism,
            onset,
            size: 0.0,
            sd: f64::INFINITY,
            growth: None,
            log_likelihood: f64::NEG_INFINITY,
        }
    }
}

/// Logarithm of the density of what the sensors showed at a row.
fn density<const N: usize>(correction: &Correction<N>) -> f64 {
    (0..SENSORS).map(|m| correction.log_density(m)).sum()
}

/// A fault may begin anywhere between two rows: the share of the first interval over which it
/// acted is uniform, and its mean square a third.
fn begin_within<const N: usize>(advanced: &mut Advanced<N>, mechanism: usize, size: f64) {
    for r in 0..N {
        for c in 0..N {
            let (b_r, b_c) = (advanced.columns[r][mechanism], advanced.columns[c][mechanism]);
            advanced.added[r][c] += size * size / 3.0 * b_r * b_c;
        }
    }
}
