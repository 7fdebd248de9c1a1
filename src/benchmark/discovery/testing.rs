//! Outcomes for the tests of the table.

use drivescope_discovery::Verdict;

use super::{Discovered, Grade, Group, Outcome};

/// A case that hides those, and what was named; nothing where the discovery failed.
pub(super) fn outcome(group: Group, hidden: &[&str], named: Option<&[&str]>) -> Outcome {
    let own = |some: &[&str]| some.iter().map(|it| (*it).to_owned()).collect::<Vec<_>>();
    let answer = |named: &[&str]| Discovered {
        named: own(named),
        sets: own(named).into_iter().map(|it| vec![it]).collect(),
        verdict: if named.is_empty() { Verdict::None } else { Verdict::Named },
        probabilities: Vec::new(),
        formulas: 0,
        form: None,
        strict_form: None,
        before: 3.0,
        after: 1.0,
        validation_before: 3.0,
        validation_after: 1.0,
    };
    Outcome {
        group,
        foreign: false,
        grade: Grade::USUAL,
        noise_given: true,
        hidden: own(hidden),
        detectable: (!hidden.is_empty()).then_some(true),
        answer: named.map(answer).ok_or_else(|| "it failed".to_owned()),
        alone_s: Some(0.5),
    }
}
