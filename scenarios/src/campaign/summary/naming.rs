//! What was named of what failed, and how large it was taken for.

use std::collections::BTreeMap;

use serde::Serialize;

use super::super::bank::LEARNED;
use super::table::Table;
use crate::shares::Share;

/// What stands for health among what fails.
const HEALTH: &str = "none";
/// The profile of a fault that has one size from its onset on.
const STEP: &str = "step";

/// Scenarios of which something is said.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Count {
    /// What is said of them.
    pub what: String,
    /// In how many.
    pub scenarios: usize,
}

/// What a method that names faults named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Naming {
    /// Scenarios whose machine was not learned, which judges none of them, by reason.
    pub not_learned: Vec<Count>,
    /// The confusion table, a row for each thing that failed, `none` for health among them.
    pub kinds: Vec<NamedKind>,
}

/// What was named of one thing that failed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedKind {
    /// What failed.
    pub kind: String,
    /// What was named, or why nothing was, the most frequent first.
    pub named: Vec<Count>,
    /// Of the judged scenarios, those in which what failed is named first.
    pub right: Share,
    /// Of the judged scenarios, those in which it is within the confusion set.
    pub in_set: Share,
    /// Of the 95 % intervals of what was named rightly, those that hold its size (faults of one size).
    pub covered: Share,
    /// Root mean square of the errors of those sizes, in the unit of the mechanism.
    pub size_error: Option<f64>,
}

/// What is counted of one thing that failed.
#[derive(Debug, Default)]
struct OfKind {
    named: BTreeMap<String, usize>,
    judged: usize,
    right: usize,
    in_set: usize,
    covered: usize,
    sized: usize,
    squares: f64,
}

/// The counts behind a [`Naming`].
#[derive(Debug)]
pub(super) struct Names {
    method: String,
    not_learned: BTreeMap<String, usize>,
    kinds: BTreeMap<String, OfKind>,
}

impl Names {
    /// Those of a method, if it names faults in that table.
    pub(super) fn of(method: &str, table: &Table<'_>) -> Option<Self> {
        table.column(&format!("{method}_mechanism")).is_some().then(|| Self {
            method: method.to_owned(),
            not_learned: BTreeMap::new(),
            kinds: BTreeMap::new(),
        })
    }

    /// Takes row `k`, in which those kinds of faults act together.
    pub(super) fn take(&mut self, table: &Table<'_>, k: usize, kinds: Option<&str>) {
        let name = |what: &str| format!("{}_{what}", self.method);
        let baseline = table.text(&name("baseline"), k);
        if baseline != LEARNED {
            *self.not_learned.entry(baseline.to_owned()).or_default() += 1;
            return;
        }
        let named = table.text(&name("mechanism"), k);
        let number = |what: &str| table.number(&name(what), k);
        let in_set = table.flag(&name("in_set"), k);
        let [size, low, high] = ["size", "size_low", "size_high"].map(number);
        let counts = self.kinds.entry(kinds.unwrap_or(HEALTH).to_owned()).or_default();
        *counts.named.entry(named.to_owned()).or_default() += 1;
        counts.judged += usize::from(in_set.is_some());
        counts.in_set += usize::from(in_set == Some(true));
        let right =
            in_set.is_some() && kinds.is_some_and(|it| it.split(" + ").any(|it| it == named));
        counts.right += usize::from(right);
        let of_one_size = kinds == Some(named) && table.text("fault_profile", k) == STEP;
        if of_one_size && size.is_finite() {
            let truth = table.number("fault_size", k);
            counts.sized += 1;
            counts.covered += usize::from(low <= truth && truth <= high);
            counts.squares += (size - truth).powi(2);
        }
    }

    /// What they come to.
    pub(super) fn summary(&self) -> Naming {
        let kind = |(kind, of): (&String, &OfKind)| NamedKind {
            kind: kind.clone(),
            named: counted(&of.named),
            right: Share::new(of.right, of.judged),
            in_set: Share::new(of.in_set, of.judged),
            covered: Share::new(of.covered, of.sized),
            size_error: (of.sized > 0).then(|| (of.squares / of.sized as f64).sqrt()),
        };
        Naming {
            not_learned: counted(&self.not_learned),
            kinds: self.kinds.iter().map(kind).collect(),
        }
    }
}

fn counted(counts: &BTreeMap<String, usize>) -> Vec<Count> {
    let count =
        |(what, scenarios): (&String, &usize)| Count { what: what.clone(), scenarios: *scenarios };
    let mut made: Vec<Count> = counts.iter().map(count).collect();
    made.sort_by_key(|count| std::cmp::Reverse(count.scenarios));
    made
}
