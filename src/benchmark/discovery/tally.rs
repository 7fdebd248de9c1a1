//! The table: rates with their intervals.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Group, Outcome};
use drivescope_discovery::Verdict;

/// Normal quantile of a two-sided 95 % interval.
const NORMAL_95: f64 = 1.959_964;

/// A rate with its 95 % interval (Wilson, 1927).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Rate {
    what: String,
    hits: usize,
    of: usize,
    rate: Option<f64>,
    interval: Option<[f64; 2]>,
}

impl Rate {
    fn new(what: &str, hits: usize, of: usize) -> Self {
        let rate = (of > 0).then(|| hits as f64 / of as f64);
        let interval = rate.map(|p| wilson(p, of as f64));
        Self { what: what.to_owned(), hits, of, rate, interval }
    }
}

fn wilson(p: f64, n: f64) -> [f64; 2] {
    let z = NORMAL_95 * NORMAL_95;
    let middle = (p + z / (2.0 * n)) / (1.0 + z / n);
    let half = NORMAL_95 / (1.0 + z / n) * (p * (1.0 - p) / n + z / (4.0 * n * n)).sqrt();
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

/// The published table.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Table {
    seed: u64,
    rates: Vec<Rate>,
    by_effect: Vec<Rate>,
    /// Median share of the held-out excess that the added effects remove.
    excess_removed: Option<f64>,
    /// Median of what is left over the noise floor, in detectable cases.
    left_over: Option<f64>,
    seconds_median: Option<f64>,
    cases: Vec<Outcome>,
}

impl Table {
    pub(crate) fn new(seed: u64, cases: Vec<Outcome>) -> Self {
        let of = |groups: &[Group]| -> Vec<&Outcome> {
            cases.iter().filter(|it| groups.contains(&it.group)).collect()
        };
        let count = |what: &str, some: &[&Outcome], hit: &dyn Fn(&Outcome) -> bool| {
            Rate::new(what, some.iter().filter(|it| hit(it)).count(), some.len())
        };
        let detectable = |groups: &[Group]| -> Vec<&Outcome> {
            of(groups).into_iter().filter(|it| it.detectable == Some(true)).collect()
        };
        let white = detectable(&[Group::Hidden]);
        let loaded = detectable(&[Group::HiddenLoaded]);
        let both = detectable(&[Group::Hidden, Group::HiddenLoaded]);
        let every: Vec<&Outcome> = cases.iter().collect();
        let hidden = of(&[Group::Hidden, Group::HiddenLoaded, Group::Pair]);
        let named_some = |it: &Outcome| !it.named.is_empty();
        let named: Vec<&Outcome> = both.iter().copied().filter(|it| named_some(it)).collect();
        let mut rates = vec![
            count("named right, white noise", &white, &right),
            count("named right, random load", &loaded, &right),
            count("named by its very name, white noise", &white, &first_is_exact),
            count("a wrong name, all cases", &every, &wrong),
            count("truth inside the confusion set, where named", &named, &inside),
            count("something named, nothing hidden, white", &of(&[Group::Null]), &named_some),
            count("the same, random load", &of(&[Group::NullLoaded]), &named_some),
            count("the same, another zero-speed law", &of(&[Group::NullZeroSpeed]), &named_some),
            count("outside the library: unknown", &of(&[Group::Outside]), &|it| {
                it.verdict == Verdict::Unknown
            }),
            count("both of two found", &detectable(&[Group::Pair]), &all_found),
            count("not detectable, left out", &hidden, &|it| it.detectable == Some(false)),
        ];
        rates.push(count("named right, own cases", &side(&both, false), &right));
        rates.push(count("named right, independent cases", &side(&both, true), &right));
        let mut kinds: Vec<&str> = both.iter().map(|it| it.hidden[0].as_str()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let by_effect = kinds
            .iter()
            .map(|kind| {
                let some: Vec<&Outcome> =
                    both.iter().copied().filter(|it| it.hidden[0] == *kind).collect();
                count(kind, &some, &right)
            })
            .collect();
        let removed = named.iter().map(|it| {
            let excess = |error: f64| (error * error - 1.0).max(0.0);
            1.0 - excess(it.validation_after) / excess(it.validation_before).max(1e-12)
        });
        let excess_removed = median(removed.collect());
        let left_over = median(named.iter().map(|it| it.after).collect());
        let seconds_median = median(cases.iter().map(|it| it.seconds).collect());
        Self { seed, rates, by_effect, excess_removed, left_over, seconds_median, cases }
    }

    /// The table for a person.
    pub(crate) fn text(&self) -> String {
        let mut text = format!("discovery, {} cases, seed {}\n", self.cases.len(), self.seed);
        for rate in self.rates.iter().chain(&self.by_effect) {
            let _ = match (rate.rate, rate.interval) {
                (Some(p), Some([low, high])) => writeln!(
                    text,
                    "  {:<46} {:>6.1} %  [{:>5.1}, {:>5.1}]  {} of {}",
                    rate.what,
                    100.0 * p,
                    100.0 * low,
                    100.0 * high,
                    rate.hits,
                    rate.of
                ),
                _ => writeln!(text, "  {:<46}      none", rate.what),
            };
        }
        let mut line = |what: &str, value: Option<f64>, unit: &str| {
            if let Some(value) = value {
                let _ = writeln!(text, "  {what:<46} {value:>6.3} {unit}");
            }
        };
        line("held-out excess removed, median share", self.excess_removed, "");
        line("left-over error over the floor, median", self.left_over, "");
        line("one discovery, median", self.seconds_median, "s");
        text
    }
}

fn side<'a>(some: &[&'a Outcome], foreign: bool) -> Vec<&'a Outcome> {
    some.iter().copied().filter(|it| it.foreign == foreign).collect()
}

/// The first name or its confusion set holds the truth.
fn right(it: &Outcome) -> bool {
    it.sets.first().is_some_and(|set| set.iter().any(|id| it.hidden.contains(id)))
}

fn first_is_exact(it: &Outcome) -> bool {
    it.named.first().is_some_and(|id| it.hidden.contains(id))
}

fn inside(it: &Outcome) -> bool {
    right(it)
}

/// A name was given whose set holds nothing that is hidden.
fn wrong(it: &Outcome) -> bool {
    it.sets.iter().any(|set| !set.iter().any(|id| it.hidden.contains(id)))
}

fn all_found(it: &Outcome) -> bool {
    it.hidden.iter().all(|kind| it.sets.iter().any(|set| set.contains(kind)))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_the_rate_and_none_of_78_proves_four_per_cent() {
        let [low, high] = wilson(0.0, 78.0);
        assert_eq!(low, 0.0);
        assert!((high - 0.047).abs() < 0.001, "{high}");
        let [low, high] = wilson(0.9, 100.0);
        assert!((low - 0.826).abs() < 0.001 && (high - 0.945).abs() < 0.001, "{low} {high}");
    }

    fn outcome(hidden: &[&str], named: &[&str]) -> Outcome {
        let own = |some: &[&str]| some.iter().map(|it| (*it).to_owned()).collect::<Vec<_>>();
        Outcome {
            group: Group::Hidden,
            foreign: false,
            hidden: own(hidden),
            detectable: Some(true),
            named: own(named),
            sets: own(named).into_iter().map(|it| vec![it]).collect(),
            verdict: Verdict::Named,
            before: 3.0,
            after: 1.0,
            validation_before: 3.0,
            validation_after: 1.0,
            seconds: 0.5,
        }
    }

    #[test]
    fn a_shuffled_truth_collapses_the_table() {
        let kinds = ["cogging", "saturation", "brush_drop", "stribeck"];
        let honest: Vec<Outcome> = kinds.iter().map(|it| outcome(&[it], &[it])).collect();
        let shuffled: Vec<Outcome> =
            (0..4).map(|k| outcome(&[kinds[(k + 1) % 4]], &[kinds[k]])).collect();
        let [honest, shuffled] = [honest, shuffled].map(|cases| Table::new(1, cases));
        assert_eq!((honest.rates[0].hits, honest.rates[3].hits), (4, 0));
        assert_eq!((shuffled.rates[0].hits, shuffled.rates[3].hits), (0, 4));
    }
}
