//! What becomes of the answers when a number of the rule of naming is moved: one that hardly matters
//! was not chosen to fit, and one that matters has to be argued.

use std::fmt::Write as _;

use drivescope_discovery::Rule;
use rayon::prelude::*;
use serde::Serialize;

use super::real::Real;
use super::{Case, Outcome, drawn, foreign, gives_noise, outcome, tally, unprogrammed};
use crate::interrupt;

/// Factors by which each number is moved.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// The table of all moves.
#[derive(Debug, Serialize)]
pub(crate) struct Moved {
    seed: u64,
    /// The rule as it is first.
    rows: Vec<Row>,
}

/// What a rule answers.
#[derive(Debug, Serialize)]
struct Row {
    /// What was moved; nothing of the rule as it is.
    number: Option<&'static str>,
    value: Option<f64>,
    cases: usize,
    right: usize,
    /// Cases in which something was named that is not there.
    wrong: usize,
    /// Cases whose answer is another than by the rule as it is.
    changed: usize,
    machines: usize,
    machines_right: usize,
    machines_wrong: usize,
    machines_changed: usize,
}

/// A rule with what was moved in it.
type Moving = (Option<(&'static str, f64)>, Rule);

/// The rule as it is, and with each of its numbers moved.
fn rules() -> Vec<Moving> {
    let moved = Rule::NUMBERS.iter().flat_map(|(name, number)| {
        FACTORS.map(|factor| {
            let mut rule = Rule::NAMING;
            *number(&mut rule) *= factor;
            (Some((*name, *number(&mut rule))), rule)
        })
    });
    std::iter::once((None, Rule::NAMING)).chain(moved).collect()
}

/// What one rule answers: on each case, and on the machines that others recorded.
struct Answers {
    cases: Vec<Outcome>,
    real: Real,
}

impl Answers {
    /// What each rule answers: all of them at once, for a rule alone ends on its slowest machine.
    fn all(
        rules: &[Moving],
        cases: &[Case],
        advance: &(dyn Fn() + Sync),
    ) -> miette::Result<Vec<Self>> {
        let one = |(rule, number): (&Rule, usize)| {
            interrupt::check()?;
            let outcome = outcome(rule, &cases[number], gives_noise(number));
            advance();
            Ok(outcome)
        };
        let asked: Vec<_> =
            rules.iter().flat_map(|(_, it)| (0..cases.len()).map(move |k| (it, k))).collect();
        let (outcomes, real) = rayon::join(
            || asked.into_par_iter().map(one).collect::<miette::Result<Vec<_>>>(),
            || rules.par_iter().map(|(_, it)| Real::run(it)).collect::<miette::Result<Vec<_>>>(),
        );
        let mut outcomes = outcomes?.into_iter();
        let of_rule = |real| Self { cases: outcomes.by_ref().take(cases.len()).collect(), real };
        Ok(real?.into_iter().map(of_rule).collect())
    }

    fn row(&self, moved: Option<(&'static str, f64)>, usual: &Self) -> Row {
        let said = |it: &Outcome| it.answer.as_ref().ok().map(|it| (it.verdict, it.named.clone()));
        let count = |is: fn(&Outcome) -> bool| self.cases.iter().filter(|it| is(it)).count();
        let machines: Vec<_> = self.real.answers().collect();
        let named = usual.real.answers().map(|(named, ..)| named);
        Row {
            number: moved.map(|it| it.0),
            value: moved.map(|it| it.1),
            cases: self.cases.len(),
            right: count(tally::right),
            wrong: count(tally::wrong),
            changed: self
                .cases
                .iter()
                .zip(&usual.cases)
                .filter(|(a, b)| said(a) != said(b))
                .count(),
            machines: machines.len(),
            machines_right: machines.iter().filter(|(_, right, _)| *right).count(),
            machines_wrong: machines.iter().filter(|(.., wrong)| *wrong).count(),
            machines_changed: machines
                .iter()
                .zip(named)
                .filter(|(it, named)| it.0 != *named)
                .count(),
        }
    }
}

/// Discoveries that so many cases take.
pub(crate) fn discoveries(cases: usize) -> usize {
    rules().len() * (cases + unprogrammed(cases))
}

impl Moved {
    /// Draws that many cases and answers them by the rule as it is and by every move of it; each
    /// discovery of a case counts as an advance.
    ///
    /// # Errors
    /// No Python for the independent generators, or the user stops.
    pub(crate) fn run(
        cases: usize,
        seed: u64,
        python: &foreign::Python,
        advance: &(dyn Fn() + Sync),
    ) -> miette::Result<Self> {
        let all = drawn(cases, seed, python)?;
        let rules = rules();
        let answers = Answers::all(&rules, &all, advance)?;
        let row = |((moved, _), it): (&Moving, &Answers)| it.row(*moved, &answers[0]);
        let rows = rules.iter().zip(&answers).map(row).collect();
        Ok(Self { seed, rows })
    }

    /// The table for a person.
    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "The rule of naming, each number halved and doubled, seed {}\n{:<18}{:>8}  {:>12}{:>8}{:>9}   {}\n",
            self.seed,
            "number",
            "value",
            "right",
            "wrong",
            "changed",
            "machines of others, the same"
        );
        for it in &self.rows {
            let value = it.value.map_or(String::new(), |value| format!("{value:.4}"));
            let value = value.trim_end_matches('0').trim_end_matches('.');
            let _ = write!(
                text,
                "{:<18}{value:>8}  {:>12}{:>8}{:>9}",
                it.number.unwrap_or("as it is"),
                format!("{} of {}", it.right, it.cases),
                it.wrong,
                it.changed
            );
            let _ = if it.machines == 0 {
                writeln!(text, "   not run: no DRIVESCOPE_DATA")
            } else {
                writeln!(
                    text,
                    "   {} of {}, {} wrong, {} changed",
                    it.machines_right, it.machines, it.machines_wrong, it.machines_changed
                )
            };
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::Group;
    use super::super::testing::outcome;
    use super::*;

    /// A number that no move reaches would look as if it did not matter.
    #[test]
    fn every_number_of_the_rule_is_moved_both_ways() {
        let all = rules();
        assert_eq!(all.len(), 1 + 2 * Rule::NUMBERS.len());
        for (k, one) in all.iter().enumerate() {
            for other in &all[..k] {
                assert_ne!(one.1, other.1, "{:?} and {:?}", one.0, other.0);
            }
        }
    }

    #[test]
    fn a_changed_answer_is_counted_and_a_wrong_name_too() {
        let said = |named: &[&str]| Answers {
            cases: vec![outcome(Group::Hidden, &["cogging"], Some(named))],
            real: Real::default(),
        };
        let usual = said(&["cogging"]);
        let same = usual.row(None, &usual);
        assert_eq!((same.right, same.wrong, same.changed), (1, 0, 0));
        let other = said(&["stribeck"]).row(Some(("size", 0.04)), &usual);
        assert_eq!((other.right, other.wrong, other.changed), (0, 1, 1));
    }
}
