//! A fault of one mechanism from one onset: its size of greatest likelihood.
//!
//! The filter runs over the rows with the fault in the process, so that nothing is linearised in
//! the size at the end; Gauss-Newton steps in the size take the derivative of the innovations,
//! which is propagated through the same filter.

use super::columns::Columns;
use super::filter::Correction;
use super::process::{Advanced, Belief, Process, Row, SENSORS, Sensed};

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
    /// Belief about the first row.
    pub(crate) belief: Belief<N>,
    pub(crate) rows: &'a [Row],
}

/// A fault and how well it explains the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fit {
    pub(crate) mechanism: usize,
    /// First faulty row.
    pub(crate) onset: usize,
    pub(crate) size: f64,
    /// Standard deviation of the size.
    pub(crate) sd: f64,
    /// Logarithm of the likelihood of all rows.
    pub(crate) log_likelihood: f64,
}

/// What a fault does from a row on: a mechanism of that size, a sensor that is stuck, or nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Acting {
    Healthy,
    Fault { mechanism: usize, size: f64 },
    Frozen { sensor: usize },
}

/// What a run of the filter over a case came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run<const N: usize> {
    pub(crate) log_likelihood: f64,
    /// Belief about the row after the last.
    pub(crate) end: Belief<N>,
}

impl<const N: usize, P: Process<N>> Case<'_, N, P> {
    /// Filters the rows with what acts from row `onset` on; `each` is told of every row, with its
    /// number.
    pub(crate) fn run(
        &self,
        acting: Acting,
        onset: usize,
        mut each: impl FnMut(usize, &Sensed<N>, &Correction<N>, &Advanced<N>),
    ) -> Run<N> {
        let mut before = self.before.clone();
        let mut after = match acting {
            Acting::Fault { mechanism, size } => self.healthy.with_fault(mechanism, size),
            Acting::Healthy | Acting::Frozen { .. } => self.healthy.clone(),
        };
        let quanta = self.healthy.quanta();
        let mut belief = self.belief;
        let mut log_likelihood = 0.0;
        for (k, row) in self.rows.iter().enumerate() {
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
            log_likelihood += (0..SENSORS).map(|m| correction.log_density(m)).sum::<f64>();
            each(k, &sensed, &correction, &advanced);
            belief = belief.moved(&advanced);
        }
        Run { log_likelihood, end: belief }
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
            best = Some(Fit { mechanism, onset, size, sd, log_likelihood });
            let next = (size + step).clamp(about.least, about.most);
            if step.is_nan() || step.abs() <= CONVERGED * sd || next == size {
                break;
            }
            size = next;
        }
        best.unwrap_or(Fit {
            mechanism,
            onset,
            size: 0.0,
            sd: f64::INFINITY,
            log_likelihood: f64::NEG_INFINITY,
        })
    }

    /// The same over onsets within `spread` rows of one.
    pub(crate) fn best(&self, mechanism: usize, onset: usize, spread: usize) -> Fit {
        let mut best = self.fit(mechanism, onset, 0.0);
        let last = (onset + spread).min(self.rows.len().saturating_sub(1));
        for other in onset.saturating_sub(spread)..=last {
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
