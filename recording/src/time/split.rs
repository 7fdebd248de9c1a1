//! Runs parted into segments: where samples are missing for long or the rate changes.

use std::collections::VecDeque;
use std::ops::Range;

use crate::clock::parted;

use super::line::median;

/// More lost samples than these are no longer bridged: a new segment begins.
pub(super) const BRIDGED: f64 = 3.0;
/// Rows over which the local rate is taken.
const BLOCK: usize = 32;
/// Blocks to either side over which the median of the rates is taken.
const NEIGHBOURS: usize = 3;
/// Factor between the rates of neighbouring blocks beyond which the rate has changed.
const OTHER_RATE: f64 = 1.4;
/// Steps so many times the block's mean do not count in it.
const OUTLIER: f64 = 4.5;
/// So many steps in a row ...
const SLOW_STEPS: usize = 8;
/// ... that are so many times longer than those around have a rate of their own.
const SLOWER: f64 = 1.5;
/// Steps from one of them to the next, at most.
const SHORT_BETWEEN: usize = 3;
/// Steps below this share of the usual one, so many in a row, are those of rows written at once.
const AT_ONCE: f64 = 0.1;
const SEVERAL: usize = 3;
/// Rows within which stamps that came late catch up.
const CATCH_UP: usize = 256;

/// Ranges of rows that form one segment each; `runs` are the rows at which a run begins.
pub(super) fn split(time: &[f64], runs: &[usize]) -> Vec<Range<usize>> {
    let runs = parted(runs.iter().copied(), time.len());
    runs.into_iter().flat_map(|run| by_rate_and_gaps(time, run)).collect()
}

/// One run parted where its rate changes, then each part at its gaps.
fn by_rate_and_gaps(time: &[f64], run: Range<usize>) -> Vec<Range<usize>> {
    let steps: Vec<f64> = time[run.clone()].windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rates = smoothed(&block_means(&steps));
    let slow = slow_stretches(&steps, &rates);
    let mut cuts = gaps(&steps, &rates, &slow);
    let ends: Vec<usize> = slow.iter().flat_map(|it| it.ends(&steps, &rates)).collect();
    let near = |some: &[usize], at: usize| some.iter().any(|it| it.abs_diff(at) <= BLOCK);
    let mut changes = rate_changes(&steps, &rates);
    changes.retain(|change| !near(&ends, *change));
    changes.extend(ends);
    // The pause before another rate is no step of either.
    changes.retain(|change| !near(&cuts, *change));
    cuts.extend(changes);
    cuts.sort_unstable();
    cuts.dedup();
    let bounds: Vec<usize> =
        [0].into_iter().chain(cuts).chain([run.len()]).map(|cut| run.start + cut).collect();
    bounds.windows(2).map(|pair| pair[0]..pair[1]).filter(|it| !it.is_empty()).collect()
}

/// Mean step of every block, without those that are gaps in it and those with which a logger caught
/// up that stood still.
fn block_means(steps: &[f64]) -> Vec<f64> {
    let mean = |block: &[f64], most: f64| {
        let usual = block.iter().filter(|step| **step <= most);
        let (sum, count) = usual.fold((0.0, 0), |(sum, n), step| (sum + step, n + 1));
        if count == 0 { f64::INFINITY } else { sum / f64::from(count) }
    };
    let of = |block: &[f64]| {
        let block = &without_catching_up(block);
        let mut found = mean(block, f64::INFINITY);
        // A gap that is many times the block hides shorter ones at first.
        for _ in 0..8 {
            let next = mean(block, OUTLIER * found);
            if next == found || !(next > 0.0 && next.is_finite()) {
                break;
            }
            found = next;
        }
        found
    };
    steps.chunks(BLOCK).map(of).collect()
}

/// A block's steps without those of several rows that came all at once.
fn without_catching_up(block: &[f64]) -> Vec<f64> {
    let forward: Vec<f64> = block.iter().copied().filter(|step| *step > 0.0).collect();
    if forward.is_empty() {
        return forward;
    }
    let least = AT_ONCE * median(forward);
    let parts = block.chunk_by(|a, b| (*a < least) == (*b < least));
    parts.filter(|part| part[0] >= least || part.len() < SEVERAL).flatten().copied().collect()
}

/// The median of each block and its neighbours: a logger that stood still is no other rate.
fn smoothed(rates: &[f64]) -> Vec<f64> {
    let median = |k: usize| {
        let reach = NEIGHBOURS.min(k).min(rates.len() - 1 - k);
        let mut around = rates[k - reach..=k + reach].to_vec();
        *around.select_nth_unstable_by(reach, f64::total_cmp).1
    };
    let ends = |k: usize| {
        k.clamp(
            NEIGHBOURS.min(rates.len() / 2),
            rates.len() - 1 - NEIGHBOURS.min((rates.len() - 1) / 2),
        )
    };
    (0..rates.len()).map(|k| median(ends(k))).collect()
}

/// Rows from which on two blocks in a row have another rate than those before.
fn rate_changes(steps: &[f64], rates: &[f64]) -> Vec<usize> {
    let mut changes = Vec::new();
    let Some(mut rate) = rates.first().copied() else { return changes };
    // The last block is short: it alone is no new rate.
    for k in 1..rates.len().saturating_sub(1) {
        let now = rates[k + 1];
        if is_other(rates[k], rate) && is_other(now, rate) && !is_other(rates[k], now) {
            changes.push(boundary(steps, k, rate, now));
            rate = now;
        }
    }
    changes
}

fn is_other(a: f64, b: f64) -> bool {
    (a / b).max(b / a) > OTHER_RATE
}

/// The row in or before that block which parts steps of one rate from steps of the other best.
fn boundary(steps: &[f64], block: usize, before: f64, after: f64) -> usize {
    let (from, to) = ((block - 1) * BLOCK, ((block + 1) * BLOCK).min(steps.len()));
    let off = |step: f64, rate: f64| (step.max(f64::MIN_POSITIVE) / rate).ln().abs().min(1.0);
    let mut misfit: f64 = steps[from..to].iter().map(|step| off(*step, after)).sum();
    let mut best = (misfit, from);
    for k in from..to {
        misfit += off(steps[k], before) - off(steps[k], after);
        if misfit < best.0 {
            best = (misfit, k + 1);
        }
    }
    best.1
}

/// Steps of a slower rate, too few for the blocks to show.
struct Slow {
    steps: Range<usize>,
    /// Their median.
    rate: f64,
}

impl Slow {
    /// Its ends, as rows, where the rate around is another.
    fn ends(&self, steps: &[f64], rates: &[f64]) -> impl Iterator<Item = usize> {
        let Range { start, end } = self.steps;
        let other = |step: usize| is_other(rates[step / BLOCK], self.rate);
        let starts = start > 0 && other(start - 1);
        let ends = end < steps.len() && other(end);
        [starts.then_some(start), ends.then_some(end)].into_iter().flatten()
    }
}

fn slow_stretches(steps: &[f64], rates: &[f64]) -> Vec<Slow> {
    let slow = |k: &usize| steps[*k] > SLOWER * rates[k / BLOCK];
    let all: Vec<usize> = (0..steps.len()).filter(slow).collect();
    let mut found = Vec::new();
    // Where stamps jitter, a step or two between may be short.
    for stretch in all.chunk_by(|a, b| b - a <= SHORT_BETWEEN) {
        let (first, last) = (stretch[0], stretch[stretch.len() - 1]);
        if stretch.len() < SLOW_STEPS || 3 * stretch.len() < 2 * (last + 1 - first) {
            continue;
        }
        let end = if last + SHORT_BETWEEN >= steps.len() { steps.len() } else { last + 1 };
        found.push(Slow { steps: first..end, rate: median(steps[first..end].to_vec()) });
    }
    found
}

/// Rows after a gap. Stamps that came late are told from lost samples by what follows: late ones
/// catch up, so that the least lead over the local clock among the next rows does not rise.
fn gaps(steps: &[f64], rates: &[f64], slow: &[Slow]) -> Vec<usize> {
    let rate = |k: usize| {
        let stretch = slow.partition_point(|it| it.steps.end <= k);
        if let Some(it) = slow.get(stretch).filter(|it| it.steps.contains(&k)) {
            return (it.rate, it.rate);
        }
        let block = k / BLOCK;
        let around = rates[block.saturating_sub(1)..rates.len().min(block + 2)].iter();
        (rates[block], around.copied().filter(|it| it.is_finite()).fold(0.0, f64::max))
    };
    if !steps.iter().enumerate().any(|(k, step)| *step > (1.0 + BRIDGED) * rates[k / BLOCK]) {
        return Vec::new();
    }
    let mut lead = Vec::with_capacity(steps.len() + 1);
    lead.push(0.0);
    for (k, step) in steps.iter().enumerate() {
        let own = rate(k).0;
        lead.push(lead[k] + step - if own.is_finite() { own } else { *step });
    }
    let least = least_ahead(&lead);
    let is_gap = |k: &usize| least[k + 1] - least[*k] > (BRIDGED + 0.5) * rate(*k).1;
    (0..steps.len()).filter(is_gap).map(|k| k + 1).collect()
}

/// The least of each value and the [`CATCH_UP`] after it.
fn least_ahead(values: &[f64]) -> Vec<f64> {
    let mut least = vec![0.0; values.len()];
    let mut window: VecDeque<usize> = VecDeque::new();
    for k in (0..values.len()).rev() {
        while window.back().is_some_and(|last| values[*last] >= values[k]) {
            window.pop_back();
        }
        window.push_back(k);
        if window.front().is_some_and(|first| *first > k + CATCH_UP) {
            window.pop_front();
        }
        least[k] = values[window[0]];
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::testing::jitter;

    fn clock(rows: usize, step: f64) -> Vec<f64> {
        (0..rows).map(|k| k as f64 * step).collect()
    }

    fn one(rows: usize) -> Vec<Range<usize>> {
        std::iter::once(0..rows).collect()
    }

    #[test]
    fn a_steady_clock_and_a_jittering_one_are_one_segment() {
        assert_eq!(split(&clock(1000, 0.01), &[]), one(1000));
        let jittered: Vec<f64> = (0..1000).map(|k| k as f64 + 0.8 * jitter(k)).collect();
        assert_eq!(split(&jittered, &[]), one(1000));
        // 430 Hz stamped in whole milliseconds, and 10 Hz in whole seconds.
        let stamped: Vec<f64> = (0..1000).map(|k| (k as f64 / 0.43).floor() * 1e-3).collect();
        assert_eq!(split(&stamped, &[]), one(1000));
        let seconds: Vec<f64> = (0..1000).map(|k| (k as f64 / 10.0).floor()).collect();
        assert_eq!(split(&seconds, &[]), one(1000));
    }

    #[test]
    fn lost_samples_are_bridged_and_gaps_part() {
        let mut time = clock(1000, 1.0);
        time.iter_mut().skip(300).for_each(|t| *t += 3.0);
        assert_eq!(split(&time, &[]), one(1000));
        time.iter_mut().skip(500).for_each(|t| *t += 5.0);
        time.iter_mut().skip(510).for_each(|t| *t += 4000.0);
        assert_eq!(split(&time, &[]), [0..500, 500..510, 510..1000]);
    }

    #[test]
    fn rows_that_came_late_are_no_gap() {
        // A logger that stands still for 30 samples and then writes them all.
        let late: Vec<f64> =
            (0..600).map(|k| if (200..230).contains(&k) { 230.0 } else { k as f64 }).collect();
        assert_eq!(split(&late, &[]), one(600));
    }

    #[test]
    fn another_rate_is_another_segment() {
        let mut time = clock(333, 0.01);
        let end = time[332];
        time.extend((1..400).map(|k| end + k as f64 * 0.001));
        let parts = split(&time, &[]);
        assert_eq!(parts.len(), 2, "{parts:?}");
        assert!(parts[0].end.abs_diff(333) <= 1, "{parts:?}");
        let mut time = clock(500, 0.001);
        time.extend((1..400).map(|k| 0.499 + k as f64 * 0.01));
        assert_eq!(split(&time, &[]).len(), 2);
    }

    #[test]
    fn a_few_rows_of_a_slow_rate_are_a_segment() {
        let mut time = clock(300, 0.001);
        time.extend((0..20).map(|k| 1.0 + k as f64 * 0.01));
        assert_eq!(split(&time, &[]), [0..300, 300..320]);
    }

    #[test]
    fn runs_part_a_continuous_clock() {
        assert_eq!(split(&clock(100, 1.0), &[40]), [0..40, 40..100]);
    }
}
