//! The evidence of laws and curves, from products of their whitened columns.

use nalgebra::DMatrix;

use super::gram::Products;
use super::marginal::{Beside, Terms, coefficients, ln_mean_exp, log_evidence, standing_out};
use super::passes::LawColumns;
use super::weights::{CurveWeight, LawWeight};
use crate::discover::{Candidate, Curve};

/// Standard deviations of a law's coefficients, of the balance's size.
pub(super) const SIZES: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
/// The same of a curve's values.
const CURVE_SIZES: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];

/// Standard deviation of a curve's value, over its largest, from which on it is not told, and the share
/// of its information that must be new beside those that are.
const IDENTIFIED: f64 = 0.1;
const NEW: f64 = 1e-3;

/// Which values are told by that information, given the others: the rest is better kept.
fn identified_of(mut left: DMatrix<f64>, enough: f64) -> Vec<bool> {
    let whole = left.diagonal();
    let mut identified = vec![false; whole.len()];
    loop {
        let open = (0..identified.len()).filter(|k| !identified[*k]);
        let Some(best) = open.max_by(|a, b| left[(*a, *a)].total_cmp(&left[(*b, *b)])) else {
            return identified;
        };
        let pivot = left[(best, best)];
        // Not so, too, where the size is 0 and nothing is known.
        if !(pivot > enough.max(NEW * whole[best]) && pivot.is_finite()) {
            return identified;
        }
        identified[best] = true;
        let column = left.column(best).into_owned();
        left.ger(-1.0 / pivot, &column, &column, 1.0);
    }
}

/// Values of a curve.
#[derive(Debug, Clone, Default)]
struct Hats {
    size: f64,
    values: Vec<f64>,
    visited: Vec<bool>,
    identified: Vec<bool>,
}

/// Share of a column's amplitude beside the base below which the base imitates it.
const IMITATED: f64 = 1e-2;

/// Products of the recordings of the fit and of all, of columns in units of their scales.
pub(super) struct Weighing<'a> {
    pub(super) fitted: Products,
    pub(super) all: Products,
    pub(super) scale: &'a [f64],
    pub(super) background: Terms,
    /// The parameters of the base alone.
    pub(super) parameters: Terms,
    /// What becomes of a law over what is explained; none where that is not.
    pub(super) feedback: Option<&'a OfLaw<'a>>,
}

/// [`Feedback`] of a law; none where it does not depend on what it explains.
pub(super) type OfLaw<'a> = dyn Fn(&LawColumns) -> Option<Feedback> + 'a;

/// What becomes of a law that depends on what it explains, once that is allowed for.
pub(super) struct Feedback {
    /// ln of the evidence that it loses (below 0).
    pub(super) evidence: f64,
    /// Part of its coefficients that is most probable then.
    pub(super) part: f64,
    /// Share of its amplitude that is not what it explains, times a factor.
    pub(super) stands_out: f64,
}

impl Weighing<'_> {
    /// ln of the evidence of columns of any of those sizes beside the background.
    fn of(&self, products: &Products, columns: &[usize], sizes: &[f64]) -> f64 {
        let with = |size: &f64| log_evidence(products, &self.background.with(columns, size * size));
        ln_mean_exp(sizes.iter().map(with))
    }

    /// ln of the evidence of the best of those curves over those terms, in all recordings; of none, that
    /// there is nothing.
    pub(super) fn best_beside(&self, terms: &Terms, curves: &[Vec<usize>]) -> f64 {
        let without = log_evidence(&self.all, terms);
        let over = |columns: &Vec<usize>| {
            let with = |size: &f64| log_evidence(&self.all, &terms.with(columns, size * size));
            ln_mean_exp(CURVE_SIZES.iter().map(with)) - without
        };
        curves.iter().map(over).fold(f64::NEG_INFINITY, f64::max)
    }

    /// What each candidate explains, most probable first.
    pub(super) fn laws(
        &self,
        candidates: &[Candidate],
        law_columns: &[LawColumns],
    ) -> Vec<LawWeight> {
        let base = log_evidence(&self.fitted, &self.background);
        let mut found = Vec::new();
        for (number, candidate) in candidates.iter().enumerate() {
            let mut own: Vec<(&LawColumns, f64)> = law_columns
                .iter()
                .filter(|law| law.candidate == number)
                .map(|law| (law, self.of(&self.fitted, &law.columns, &SIZES) - base))
                .map(|(law, evidence)| (law, evidence + self.lost(law)))
                .collect();
            let evidence = ln_mean_exp(own.iter().map(|(_, evidence)| *evidence));
            own.sort_by(|a, b| b.1.total_cmp(&a.1));
            let Some((best, _)) = own.first() else { continue };
            let finite = best.columns.iter().all(|column| self.scale[*column] > 0.0);
            let coefficients = if candidate.is_linear() { self.coefficients(best) } else { vec![] };
            // What would need a coefficient that cannot be is no evidence for the law.
            let impossible =
                coefficients.iter().zip(&candidate.ranges).any(|(c, (low, _))| c < low);
            let evidence = if impossible { evidence.min(0.0) } else { evidence };
            found.push(LawWeight {
                candidate: number,
                variants: own.iter().map(|(law, _)| law.variant).collect(),
                coefficients,
                evidence,
                imitated: own.iter().all(|(law, _)| self.imitated(law)),
                finite,
            });
        }
        found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        found
    }

    /// ln of the evidence that a law loses because it depends on what it explains.
    fn lost(&self, law: &LawColumns) -> f64 {
        self.feedback.and_then(|of| of(law)).map_or(0.0, |it| it.evidence)
    }

    /// The most probable coefficients of a law, in their own units.
    fn coefficients(&self, law: &LawColumns) -> Vec<f64> {
        let part = self.feedback.and_then(|of| of(law)).map_or(1.0, |it| it.part);
        let terms = self.background.with(&law.columns, 1.0);
        let mean = coefficients(&self.fitted, &terms);
        let place = self.background.columns.len();
        let one = |(k, column): (usize, &usize)| {
            mean.as_ref().map_or(0.0, |mean| part * mean[place + k] * self.scale[*column])
        };
        law.columns.iter().enumerate().map(one).collect()
    }

    /// Whether nothing of a law stands out of the base's own columns.
    fn imitated(&self, law: &LawColumns) -> bool {
        let out = |column: &usize| standing_out(&self.fitted, &self.parameters, *column);
        let feedback = self.feedback.and_then(|of| of(law));
        feedback.is_some_and(|it| it.stands_out < IMITATED)
            || law.columns.iter().all(|column| out(column) < IMITATED)
    }

    /// The most probable values of hats drawn with that standard deviation: root of their mean square,
    /// each of them in its own unit, and which are told.
    fn hats(&self, columns: &[usize], sd: f64) -> Hats {
        let terms = self.background.with(columns, sd * sd);
        let from = self.background.columns.len();
        let Some(mean) = coefficients(&self.fitted, &terms) else { return Hats::default() };
        let own = mean.rows(from, columns.len());
        let enough = 1.0 / (IDENTIFIED * own.amax()).powi(2);
        let visited = columns.iter().map(|it| self.fitted.of(*it, *it) > enough).collect();
        let identified = Beside::of(&self.fitted, &self.background);
        Hats {
            size: own.norm(),
            values: (0..columns.len()).map(|k| own[k] * self.scale[columns[k]]).collect(),
            visited,
            identified: identified.map_or_else(
                || vec![false; columns.len()],
                |it| identified_of(it.information_and_score(&self.fitted, columns).0, enough),
            ),
        }
    }

    /// What each curve explains, most probable first.
    pub(super) fn curves(&self, curves: Vec<(Curve, Vec<usize>)>) -> Vec<CurveWeight> {
        let bases =
            [&self.fitted, &self.all].map(|products| log_evidence(products, &self.background));
        let mut found: Vec<CurveWeight> = curves
            .into_iter()
            .map(|(curve, columns)| {
                let [fitted, all] = [&self.fitted, &self.all]
                    .map(|products| self.of(products, &columns, &CURVE_SIZES));
                let evidence = fitted - bases[0];
                let size = CURVE_SIZES.into_iter().max_by(|a, b| {
                    let of = |size: f64| self.of(&self.fitted, &columns, &[size]);
                    of(*a).total_cmp(&of(*b))
                });
                let hats = self.hats(&columns, size.unwrap_or(CURVE_SIZES[0]));
                let repeats = all - bases[1] - evidence;
                let Hats { size, values, visited, identified } = hats;
                CurveWeight { curve, evidence, repeats, size, values, visited, identified }
            })
            .filter(CurveWeight::is_possible)
            .collect();
        found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        found
    }
}
