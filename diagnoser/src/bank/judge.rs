//! Which hypothesis explains what happened, and which others might.

use super::examine::Examined;
use super::hypothesis::{Acting, Case, Fit};
use super::named::Named;
use super::process::{Belief, Process, Row, SENSORS};

/// Rows on either side of the alarm's onset in which the onset is looked for.
const SPREAD: usize = 2;
/// Logarithm of the likelihood by which a hypothesis may lie behind the best and still be the
/// truth: noise alone brings a true one that far behind once in two hundred times.
const CONFUSED: f64 = 4.0;
/// Logarithm of the likelihood by which a fault that grows must lie ahead of the same one that
/// stands, to be taken for it: its onset is sought among all rows that are kept, the other's next to
/// the alarm's, and of a size just above the limit a step hardly differs from a ramp.
const CHOSEN: f64 = 4.0;
/// Repetitions from which a sensor is taken for stuck.
const STUCK: usize = 3;

/// What a judgement names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// No fault: one that acted has ended.
    Healthy,
    /// The mechanism of that number; the first of the candidates.
    Mechanism(usize),
    /// The sensor of that number shows its last value.
    Frozen(usize),
    /// Something acts that no mechanism of the bank explains.
    Unknown,
}

/// A mechanism with the size of its greatest likelihood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Number of the mechanism.
    pub mechanism: usize,
    /// First faulty sample.
    pub onset: usize,
    /// Size, in the unit of the mechanism; of one that grows that at the last sample judged.
    pub size: f64,
    /// Its standard deviation, what is unknown of the machine included.
    pub sd: f64,
    /// Logarithm of the likelihood by which it lies behind the best of all hypotheses.
    pub behind: f64,
}

/// What was found about a change.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// First sample after the change, in the numbers of the candidates.
    pub onset: usize,
    /// What is named.
    pub cause: Cause,
    /// The mechanisms, the likeliest first.
    pub candidates: Vec<Candidate>,
    /// So many of the first candidates cannot be told apart on these samples: the confusion set.
    pub confused: usize,
    /// What the best leaves, as a normal score of its sum of squares.
    pub excess: f64,
    /// Change of the size a sample and its standard deviation, where the fault grows.
    pub growth: Option<(f64, f64)>,
}

impl Judgement {
    /// The candidates that cannot be told apart on these samples, the likeliest first.
    pub fn confusion_set(&self) -> &[Candidate] {
        &self.candidates[..self.confused.max(1).min(self.candidates.len())]
    }

    /// The candidate that is named, if a mechanism is.
    pub fn named(&self) -> Option<&Candidate> {
        let Cause::Mechanism(j) = self.cause else { return None };
        self.candidates.iter().find(|it| it.mechanism == j)
    }
}

/// Half width of a 95 % interval in standard deviations.
pub const TWO_SIDED_95: f64 = 1.959_963_984_540_054;

impl Candidate {
    /// The 95 % interval of the size.
    pub fn interval(&self) -> [f64; 2] {
        [self.size - TWO_SIDED_95 * self.sd, self.size + TWO_SIDED_95 * self.sd]
    }
}

/// A judgement and what goes on from it.
pub(crate) struct Judged<const N: usize> {
    pub(crate) judgement: Judgement,
    /// Belief about the row after the last, under what is named.
    pub(crate) end: Belief<N>,
    /// The fault that is named, if health was before it.
    pub(crate) named: Option<Named>,
}

impl<const N: usize, P: Process<N>> Case<'_, N, P> {
    /// Judges the rows: something changed about row `onset`; row 0 is sample `first`.
    pub(crate) fn judge(&self, onset: usize, first: usize) -> Judged<N> {
        let mechanisms = self.healthy.mechanisms();
        let stands = (0..mechanisms.len()).map(|j| self.best(j, onset, SPREAD));
        let mut fits: Vec<Fit> = stands.collect();
        let most = fits.iter().map(|fit| fit.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
        for grows in self.growing(onset + SPREAD, most) {
            let log_likelihood = grows.log_likelihood - CHOSEN;
            let stands = &mut fits[grows.mechanism];
            if log_likelihood > stands.log_likelihood {
                *stands = Fit { log_likelihood, ..grows };
            }
        }
        for (fit, about) in fits.iter_mut().zip(mechanisms) {
            fit.log_likelihood -= about.rarer;
        }
        fits.sort_by(|a, b| b.log_likelihood.total_cmp(&a.log_likelihood));
        let healthy = self.healthy_again(onset);
        let frozen = self.frozen();
        let known = fits.first().map_or(f64::NEG_INFINITY, |fit| fit.log_likelihood);
        let stuck = frozen.map_or(f64::NEG_INFINITY, |(likelihood, ..)| likelihood);
        let best = known.max(stuck);
        let candidates: Vec<Candidate> = fits
            .iter()
            .map(|fit| Candidate {
                mechanism: fit.mechanism,
                onset: first + fit.onset,
                size: fit.size,
                sd: fit.sd,
                behind: best - fit.log_likelihood,
            })
            .collect();
        let confused = candidates.iter().filter(|it| it.behind <= CONFUSED).count();
        let mut judgement = Judgement {
            onset: first + onset,
            cause: Cause::Unknown,
            candidates,
            confused,
            excess: 0.0,
            growth: None,
        };
        let end_of = |acting, onset| self.run(acting, onset, |_, _, _, _| ()).end;
        if healthy.0 > best - CONFUSED {
            let (_, onset) = healthy;
            (judgement.onset, judgement.cause) = (first + onset, Cause::Healthy);
            judgement.confused = 0;
            return Judged { judgement, end: end_of(Acting::Healthy, onset), named: None };
        }
        if let Some((likelihood, sensor, onset)) = frozen
            && likelihood >= known
        {
            (judgement.onset, judgement.cause) = (first + onset, Cause::Frozen(sensor));
            return Judged {
                judgement,
                end: end_of(Acting::Frozen { sensor }, onset),
                named: None,
            };
        }
        let Some((fit, examined)) = self.explained(&fits) else {
            return Judged { judgement, end: end_of(Acting::Healthy, onset), named: None };
        };
        judgement.onset = first + fit.onset;
        (judgement.excess, judgement.growth) = (examined.excess, examined.fit.growth);
        if let Some(at) = judgement.candidates.iter().position(|it| it.mechanism == fit.mechanism) {
            let Fit { size, sd, .. } = examined.fit;
            judgement.candidates[at] = Candidate { size, sd, ..judgement.candidates[at] };
            if at > 0 {
                // Growing, it overtakes those that stand: they are no candidates any more.
                let named = Candidate { behind: 0.0, ..judgement.candidates.remove(at) };
                judgement.candidates.insert(0, named);
                judgement.confused = 1;
            }
        }
        if examined.explains {
            judgement.cause = Cause::Mechanism(fit.mechanism);
        }
        let named = self.out_of_health(&fit, examined.log_likelihood);
        Judged { judgement, end: examined.end, named: named.filter(|_| examined.explains) }
    }

    /// The likeliest fit and what it leaves. Where it leaves too much, every mechanism is given the
    /// chance to grow from the onset on, with any size there.
    fn explained(&self, fits: &[Fit]) -> Option<(Fit, Examined<N>)> {
        let first = fits.first()?;
        let examined = self.examine(first);
        if examined.explains && examined.gained == 0.0 {
            return Some((*first, examined));
        }
        let likelihood =
            |(fit, examined): &(Fit, Examined<N>)| fit.log_likelihood + examined.gained;
        let growing = fits[1..].iter().map(|fit| (*fit, self.examine(fit)));
        let all = std::iter::once((*first, examined)).chain(growing);
        all.max_by(|a, b| likelihood(a).total_cmp(&likelihood(b)))
    }

    /// Likelihood of no fault from a row on, and that row.
    fn healthy_again(&self, onset: usize) -> (f64, usize) {
        let onsets = onset.saturating_sub(SPREAD).max(self.named.since)..=onset + SPREAD;
        onsets
            .map(|onset| (self.run(Acting::Healthy, onset, |_, _, _, _| ()).log_likelihood, onset))
            .fold((f64::NEG_INFINITY, onset), |best, it| if it.0 > best.0 { it } else { best })
    }

    /// Likelihood of a stuck sensor, its number and its first repetition, if one repeats itself up
    /// to the last row.
    fn frozen(&self) -> Option<(f64, usize, usize)> {
        let repeated = |sensor: usize| {
            let mut pairs = self.kept.windows(2).rev();
            let shown = |kept: &(Belief<N>, Row)| kept.1.shown[sensor];
            let same = |pair: &&[(Belief<N>, Row)]| shown(&pair[0]) == shown(&pair[1]);
            pairs.by_ref().take_while(same).count()
        };
        (0..SENSORS)
            .map(|sensor| (sensor, repeated(sensor)))
            .filter(|(_, count)| *count >= STUCK)
            .map(|(sensor, count)| {
                let onset = (self.kept.len() - count).max(self.named.since);
                let run = self.run(Acting::Frozen { sensor }, onset, |_, _, _, _| ());
                (run.log_likelihood, sensor, onset)
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))
    }
}
