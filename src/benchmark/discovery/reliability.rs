//! Whether probabilities are true: of the names that a discovery gives the probability p, a share p
//! is right.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Group, Outcome};
use crate::benchmark::rate::Rate;

/// Ends of the bins; no name is told with more than 0.971.
const ENDS: [f64; 7] = [1e-3, 0.1, 0.5, 0.8, 0.9, 0.96, 1.0];
/// Characters of a bar that stands for all.
const WIDTH: f64 = 40.0;

/// Names whose probability lies between two ends.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Bin {
    from: f64,
    to: f64,
    /// Mean of their probabilities; absent where there are none.
    mean: Option<f64>,
    /// How many are right.
    right: Rate,
}

/// Names of the cases that hide one effect at most: of two that hide together the first round tells
/// but one. That something outside the library hides makes each name wrong.
pub(super) fn reliability(cases: &[Outcome]) -> Vec<Bin> {
    let names: Vec<(f64, bool)> = cases
        .iter()
        .filter(|case| case.hidden.len() < 2 && case.group != Group::Pair)
        .filter_map(|case| Some((case, case.answer.as_ref().ok()?)))
        .flat_map(|(case, answer)| {
            answer.probabilities.iter().map(|(name, p)| (*p, case.hidden.contains(name)))
        })
        .collect();
    let bin = |ends: &[f64]| {
        let (from, to) = (ends[0], ends[1]);
        let inside = |it: &&(f64, bool)| it.0 >= from && (it.0 < to || (to == 1.0 && it.0 <= 1.0));
        let some: Vec<&(f64, bool)> = names.iter().filter(inside).collect();
        let right = some.iter().filter(|it| it.1).count();
        let sum: f64 = some.iter().map(|it| it.0).sum();
        let what = format!("probability {from} to {to}");
        Bin {
            from,
            to,
            mean: (!some.is_empty()).then(|| sum / some.len() as f64),
            right: Rate::new(&what, right, some.len()),
        }
    };
    ENDS.windows(2).map(bin).collect()
}

impl Bin {
    /// A line of the diagram: told and true, and a bar of what is true with a mark at what is told.
    pub(super) fn line(&self) -> String {
        let mut line = self.right.line();
        if let (Some(mean), Some(share)) = (self.mean, self.right.share()) {
            let (stated, is) = ((WIDTH * mean) as usize, (WIDTH * share) as usize);
            let mut bar: Vec<char> =
                (0..=WIDTH as usize).map(|k| if k < is { '#' } else { ' ' }).collect();
            bar[stated] = '|';
            let bar: String = bar.into_iter().collect();
            let _ = write!(line, "  mean {mean:.4}  {}", bar.trim_end());
        }
        line
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::outcome;
    use super::*;

    #[test]
    fn a_name_counts_in_the_bin_of_its_probability() {
        let mut right = outcome(Group::Hidden, &["cogging"], Some(&["cogging"]));
        let mut wrong = outcome(Group::Null, &[], Some(&[]));
        for (case, name, p) in [(&mut right, "cogging", 1.0), (&mut wrong, "stribeck", 0.95)] {
            let answer = case.answer.as_mut().expect("there is one");
            answer.probabilities = vec![(name.to_owned(), p)];
        }
        let bins = reliability(&[right, wrong]);
        let stated = |k: usize| (bins[k].right.hits, bins[k].right.of);
        assert_eq!(stated(ENDS.len() - 2), (1, 1));
        assert_eq!(stated(4), (0, 1));
        assert!(bins[4].line().contains("mean 0.9500"), "{}", bins[4].line());
        assert!(bins[1].mean.is_none());
    }
}
