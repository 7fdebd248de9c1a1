//! The table: what is counted, over which cases.

use std::fmt::Write as _;

use drivescope_discovery::Verdict;
use serde::Serialize;

use super::real::Real;
use super::reliability::{Bin, reliability};
use super::{Discovered, Found, Grade, Group, Noise, Outcome};
use crate::benchmark::rate::{Bar, Rate};

/// Formulas among which the right one must be.
const FIRST: usize = 3;

/// The published table.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Table {
    seed: u64,
    rates: Vec<Rate>,
    by_effect: Vec<Rate>,
    by_grade: Vec<Rate>,
    /// Must collapse: every case held against the truth of another.
    shuffled: Vec<Rate>,
    medians: Vec<Median>,
    /// Whether probabilities are true.
    reliability: Vec<Bin>,
    real: Real,
    cases: Vec<Outcome>,
}

/// A median over cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Median {
    what: &'static str,
    unit: &'static str,
    median: Option<f64>,
    bar: Bar,
}

/// Cases that are counted together.
struct Cases<'a>(Vec<&'a Outcome>);

impl<'a> Cases<'a> {
    fn of(cases: &'a [Outcome], groups: &[Group]) -> Self {
        Self(cases.iter().filter(|it| groups.contains(&it.group)).collect())
    }

    fn only(&self, keep: impl Fn(&Outcome) -> bool) -> Self {
        Self(self.0.iter().copied().filter(|it| keep(it)).collect())
    }

    fn rate(&self, what: &str, hit: impl Fn(&Outcome) -> bool) -> Rate {
        Rate::new(what, self.0.iter().filter(|it| hit(it)).count(), self.0.len())
    }

    /// Everything said is held against the truth of the next case that hides something else.
    fn shuffled(&self, hit: impl Fn(&Outcome) -> bool) -> usize {
        let other = |number: usize| {
            let own = &self.0[number].hidden;
            let turn = self.0.iter().cycle().skip(number + 1).take(self.0.len());
            turn.map(|it| &it.hidden).find(|hidden| *hidden != own).unwrap_or(own)
        };
        let with =
            |number: usize| Outcome { hidden: other(number).clone(), ..self.0[number].clone() };
        (0..self.0.len()).filter(|number| hit(&with(*number))).count()
    }
}

impl Table {
    pub(crate) fn new(seed: u64, found: Found) -> Self {
        let Found { outcomes: cases, real } = found;
        let of = |groups: &[Group]| Cases::of(&cases, groups);
        let detectable = |groups: &[Group]| of(groups).only(|it| it.detectable == Some(true));
        let (white, loaded) = (detectable(&[Group::Hidden]), detectable(&[Group::HiddenLoaded]));
        let both = detectable(&[Group::Hidden, Group::HiddenLoaded]);
        let hidden = of(&[Group::Hidden, Group::HiddenLoaded, Group::Pair, Group::Graded]);
        // Laws that nobody programmed have rows of their own.
        let typed = detectable(&[Group::Unprogrammed]);
        let every = Cases(cases.iter().collect()).only(|it| it.group != Group::Unprogrammed);
        let rates = vec![
            white.rate("named right, white noise", by_name).with(Bar::AtLeast(0.97)),
            white.rate("  or in its confusion set", in_set),
            loaded.rate("named right, random load torque", by_name).with(Bar::AtLeast(0.85)),
            loaded.rate("  or in its confusion set", in_set),
            every.rate("a wrong name, its confusion set counted", wrong).with(Bar::AtMost(0.01)),
            every.rate("a wrong name, the name alone counted", wrong_name),
            of(&[Group::Null])
                .rate("named, nothing hidden, white noise", some)
                .with(Bar::AtMost(0.01)),
            of(&[Group::NullLoaded])
                .rate("named, nothing hidden, random load torque", some)
                .with(Bar::AtMost(0.05)),
            of(&[Group::NullZeroSpeed])
                .rate("named, nothing hidden, another zero-speed law", some)
                .with(Bar::AtMost(0.05)),
            of(&[Group::Null, Group::NullLoaded, Group::NullZeroSpeed])
                .rate("\"unknown\" where nothing is hidden", unknown),
            of(&[Group::Outside])
                .rate("\"unknown\" where something outside the library is", unknown)
                .with(Bar::AtLeast(0.95)),
            both.only(some)
                .rate("truth in the confusion set, where one is named", in_set)
                .with(Bar::AtLeast(0.99)),
            typed
                .rate("form of a law nobody programmed in 3 formulas", |it| form(it, |it| it.form))
                .with(Bar::AtLeast(0.8)),
            typed.rate("  also beside what the base makes good of it", |it| {
                form(it, |it| it.strict_form)
            }),
            typed.rate("  answered \"unknown\"", unknown),
            typed.rate("  a law of the library named for it", some),
            of(&[Group::Null, Group::NullLoaded, Group::NullZeroSpeed])
                .rate("a formula offered where nothing is hidden", offered)
                .with(Bar::AtMost(0.01)),
            detectable(&[Group::Pair])
                .rate("both of two found", all_found)
                .with(Bar::AtLeast(0.85)),
            both.only(|it| !it.foreign).rate("named right, own simulations", by_name),
            both.only(|it| it.foreign).rate("named right, independent simulations", by_name),
            both.only(|it| it.noise_given).rate("named right, noise given", by_name),
            both.only(|it| !it.noise_given).rate("named right, noise estimated", by_name),
            hidden.rate("not detectable, left out above", |it| it.detectable == Some(false)),
            of(&[Group::Unprogrammed])
                .rate("  of laws nobody programmed", |it| it.detectable == Some(false)),
            every.rate("no answer: counted as misses above", |it| it.answer.is_err()),
        ];
        let shuffled = vec![
            Rate::new("named right, white noise", white.shuffled(by_name), white.0.len()),
            Rate::new("named right, random load torque", loaded.shuffled(by_name), loaded.0.len()),
        ];
        let graded = detectable(&[Group::Graded]);
        let is = |grade: Grade| graded.only(|it| it.grade == grade);
        let by_grade =
            Grade::OTHERS.map(|grade| is(grade).rate(&grade.line(), by_name)).into_iter().collect();
        let by_effect = by_effect(&both);
        let medians = medians(&both.only(by_name), &every);
        Self {
            seed,
            rates,
            by_effect,
            by_grade,
            shuffled,
            medians,
            reliability: reliability(&cases),
            real,
            cases,
        }
    }

    /// The table for a person.
    pub(crate) fn text(&self) -> String {
        let mut text = format!("discovery, {} cases, seed {}\n", self.cases.len(), self.seed);
        let mut block = |title: &str, rates: &[Rate]| {
            let lines: Vec<String> = rates.iter().map(Rate::line).collect();
            let _ = writeln!(text, "{title}\n{}", lines.join("\n"));
        };
        block("Rates, with 95 % intervals", &self.rates);
        block("Named right by effect, both noises", &self.by_effect);
        block("Named right by size and noise", &self.by_grade);
        block("Broken: truths exchanged, must collapse", &self.shuffled);
        let _ = writeln!(
            text,
            "Reliability: of the names told with that probability, how many are right"
        );
        for bin in &self.reliability {
            let _ = writeln!(text, "{}", bin.line());
        }
        let _ = writeln!(text, "Medians");
        for Median { what, unit, median, bar } in &self.medians {
            let Some(median) = median else { continue };
            let (side, bar) = match bar {
                Bar::AtLeast(bar) => ("at least", bar),
                Bar::AtMost(bar) => ("at most", bar),
            };
            let _ =
                writeln!(text, "  {what:<52} {median:>6.3} {unit:<1} (bar: {side} {bar}{unit})");
        }
        text + &self.real.text()
    }
}

impl Grade {
    fn line(self) -> String {
        let noise = match self.noise {
            Noise::Small => "small",
            Noise::Medium => "medium",
            Noise::Large => "large",
        };
        format!("{} of the usual size, {noise} noise", self.size)
    }
}

fn by_effect(some: &Cases<'_>) -> Vec<Rate> {
    let mut kinds: Vec<&str> = some.0.iter().map(|it| it.hidden[0].as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let of = |kind: &&str| some.only(|it| it.hidden[0] == *kind).rate(kind, by_name);
    kinds.iter().map(of).collect()
}

fn medians(named: &Cases<'_>, every: &Cases<'_>) -> Vec<Median> {
    let answers = || named.0.iter().filter_map(|it| it.answer.as_ref().ok());
    let excess = |error: f64| (error * error - 1.0).max(0.0);
    let removed = |it: &Discovered| {
        let before = excess(it.validation_before);
        (before > 0.0).then(|| 1.0 - excess(it.validation_after) / before)
    };
    vec![
        Median {
            what: "held-out excess error that the named effects remove",
            unit: "",
            median: median(answers().filter_map(removed).collect()),
            bar: Bar::AtLeast(0.9),
        },
        Median {
            what: "left-over error over the noise floor",
            unit: "",
            median: median(answers().map(|it| it.after).collect()),
            bar: Bar::AtMost(1.03),
        },
        Median {
            what: "one discovery, nothing beside it",
            unit: "s",
            median: median(every.0.iter().filter_map(|it| it.alone_s).collect()),
            bar: Bar::AtMost(1.0),
        },
    ]
}

/// The first name is the truth.
fn by_name(it: &Outcome) -> bool {
    answer(it).is_some_and(|said| said.named.first().is_some_and(|id| it.hidden.contains(id)))
}

/// The first name or its confusion set holds the truth.
fn in_set(it: &Outcome) -> bool {
    answer(it).is_some_and(|said| said.sets.first().is_some_and(|set| holds(set, it)))
}

/// A name was given whose set holds nothing that is hidden.
pub(super) fn wrong(it: &Outcome) -> bool {
    answer(it).is_some_and(|said| said.sets.iter().any(|set| !holds(set, it)))
}

/// What is hidden is named, all of it and nothing else; "none" where nothing is, "unknown" where it
/// is nothing of the library.
pub(super) fn right(it: &Outcome) -> bool {
    match it.group {
        Group::Null | Group::NullLoaded | Group::NullZeroSpeed => {
            answer(it).is_some_and(|said| said.verdict == Verdict::None)
        }
        Group::Outside | Group::Unprogrammed => unknown(it),
        Group::Hidden | Group::HiddenLoaded | Group::Pair | Group::Graded => {
            all_found(it) && !wrong(it)
        }
    }
}

/// A name was given that is not hidden.
fn wrong_name(it: &Outcome) -> bool {
    answer(it).is_some_and(|said| said.named.iter().any(|id| !it.hidden.contains(id)))
}

/// Something was named; no answer where none is due counts like a wrong one.
fn some(it: &Outcome) -> bool {
    answer(it).map_or(it.hidden.is_empty(), |said| !said.named.is_empty())
}

fn unknown(it: &Outcome) -> bool {
    answer(it).is_some_and(|said| said.verdict == Verdict::Unknown)
}

/// The form of the hidden law is among the first formulas.
fn form(it: &Outcome, place: fn(&Discovered) -> Option<usize>) -> bool {
    answer(it).and_then(place).is_some_and(|place| place <= FIRST)
}

fn offered(it: &Outcome) -> bool {
    answer(it).is_some_and(|said| said.formulas > 0)
}

fn all_found(it: &Outcome) -> bool {
    let found = |kind: &String, said: &Discovered| said.sets.iter().any(|set| set.contains(kind));
    answer(it).is_some_and(|said| it.hidden.iter().all(|kind| found(kind, said)))
}

fn holds(set: &[String], it: &Outcome) -> bool {
    set.iter().any(|id| it.hidden.contains(id))
}

fn answer(it: &Outcome) -> Option<&Discovered> {
    it.answer.as_ref().ok()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::super::testing::outcome;
    use super::*;

    fn table(outcomes: Vec<Outcome>) -> Table {
        Table::new(1, Found { outcomes, real: Real::default() })
    }

    fn hits(table: &Table, what: &str) -> (usize, usize) {
        let rate = table.rates.iter().find(|it| it.what == what).expect("a row");
        (rate.hits, rate.of)
    }

    const RIGHT: &str = "named right, white noise";
    const WRONG: &str = "a wrong name, its confusion set counted";
    const FALSE: &str = "named, nothing hidden, white noise";

    #[test]
    fn exchanged_truths_collapse_the_table() {
        let kinds = ["cogging", "saturation", "brush_drop", "stribeck"];
        let honest = kinds.map(|it| outcome(Group::Hidden, &[it], Some(&[it])));
        let table = table(honest.to_vec());
        assert_eq!((hits(&table, RIGHT), hits(&table, WRONG)), ((4, 4), (0, 4)));
        assert_eq!(table.shuffled[0].hits, 0);
    }

    #[test]
    fn what_always_names_is_wrong_where_nothing_is_hidden() {
        let cases = [&["cogging"][..], &[]].map(|hidden| {
            let group = if hidden.is_empty() { Group::Null } else { Group::Hidden };
            outcome(group, hidden, Some(&["cogging"]))
        });
        let table = table(cases.to_vec());
        assert_eq!((hits(&table, FALSE), hits(&table, WRONG)), ((1, 1), (1, 2)));
    }

    #[test]
    fn a_case_without_an_answer_is_a_miss() {
        let cases = [&["cogging"][..], &[]].map(|hidden| {
            let group = if hidden.is_empty() { Group::Null } else { Group::Hidden };
            outcome(group, hidden, None)
        });
        let table = table(cases.to_vec());
        assert_eq!((hits(&table, RIGHT), hits(&table, FALSE)), ((0, 1), (1, 1)));
        assert_eq!(hits(&table, "no answer: counted as misses above"), (2, 2));
    }
}
