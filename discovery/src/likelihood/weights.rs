//! What laws and curves explain, and the better of two accounts of it.

use crate::discover::{Balance, Curve};

/// What a law explains in its best shape.
#[derive(Debug, Clone)]
pub(crate) struct LawWeight {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// Its shapes, the most probable first.
    pub(crate) variants: Vec<usize>,
    /// Coefficients of the most probable shape; none where the null is infinite.
    pub(crate) coefficients: Vec<f64>,
    /// ln of the evidence over that of the base, averaged over shapes and sizes.
    pub(crate) evidence: f64,
    /// Whether the base imitates it.
    pub(crate) imitated: bool,
    /// Whether its column has a number everywhere.
    pub(crate) finite: bool,
}

/// What a curve explains.
#[derive(Debug, Clone)]
pub(crate) struct CurveWeight {
    pub(crate) curve: Curve,
    pub(crate) evidence: f64,
    /// ln of the probability of the recordings held out, given the others, over that of the base.
    pub(crate) repeats: f64,
    /// Root of its mean square, of the balance's size.
    pub(crate) size: f64,
    /// Its values at the knots, which of them were visited, and which the recordings of the fit tell
    /// beside the parameters of the base.
    pub(crate) values: Vec<f64>,
    pub(crate) visited: Vec<bool>,
    pub(crate) identified: Vec<bool>,
}

impl CurveWeight {
    /// Whether a machine may have such a curve: no flux changes by more than the whole.
    pub(super) fn is_possible(&self) -> bool {
        if self.curve.balance != Balance::Flux {
            return true;
        }
        let values = || self.values.iter().zip(&self.visited).filter(|it| *it.1).map(|it| *it.0);
        let (most, least) = (values().fold(f64::MIN, f64::max), values().fold(f64::MAX, f64::min));
        most - least <= 1.0
    }
}

/// The weights of everything.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    /// ln of the evidence of the base, in the recordings of the fit and in all.
    pub(super) base: f64,
    pub(super) base_of_all: f64,
    /// ln of the evidence of the base in all recordings without what the formulas of named laws may
    /// leave, and of the best curve of that over it.
    pub(super) plain: f64,
    pub(crate) left_by_formulas: f64,
    /// Most probable first.
    pub(crate) laws: Vec<LawWeight>,
    /// Most probable first.
    pub(crate) curves: Vec<CurveWeight>,
}

impl Weights {
    /// The curves for which the recordings held out speak too, most probable first.
    pub(crate) fn repeating(&self) -> impl Iterator<Item = &CurveWeight> {
        self.curves.iter().filter(|curve| curve.repeats > 0.0)
    }

    /// ln of the evidence of a curve in the recordings of the fit over a base at its best, that of which
    /// is given.
    pub(crate) fn beyond(&self, base: f64, curve: &CurveWeight) -> f64 {
        curve.evidence + (self.base - base).min(0.0)
    }

    /// With ln of the prior odds of what is random beside them.
    pub(super) fn with_prior(self, ln_prior: f64) -> Self {
        let [base, base_of_all, plain] =
            [self.base, self.base_of_all, self.plain].map(|it| it + ln_prior);
        Self { base, base_of_all, plain, ..self }
    }

    /// Each law and curve where it explains more, over the base where that does.
    pub(super) fn best_of(self, other: Self) -> Self {
        let base = self.base.max(other.base);
        let base_of_all = self.base_of_all.max(other.base_of_all);
        let plain = self.plain.max(other.plain);
        let left = |it: &Self| it.left_by_formulas + it.plain - plain;
        let left_by_formulas = left(&self).max(left(&other));
        let (mine, others) = (self.base - base, other.base - base);
        let [my_rest, their_rest] = [(&self, mine), (&other, others)]
            .map(|(it, fitted)| it.base_of_all - base_of_all - fitted);
        let mut laws = self.laws;
        for law in &mut laws {
            law.evidence += mine;
            let found = other.laws.iter().find(|it| it.candidate == law.candidate);
            let more = |it: &&LawWeight| it.finite && it.evidence + others > law.evidence;
            if let Some(it) = found.filter(more) {
                *law = LawWeight { evidence: it.evidence + others, ..it.clone() };
            }
        }
        laws.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let mut curves = self.curves;
        for it in &mut curves {
            (it.evidence, it.repeats) = (it.evidence + mine, it.repeats + my_rest);
        }
        curves.extend(other.curves.into_iter().map(|it| CurveWeight {
            evidence: it.evidence + others,
            repeats: it.repeats + their_rest,
            ..it
        }));
        curves.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        Self { base, base_of_all, plain, left_by_formulas, laws, curves }
    }
}
