//! Which variables the residual depends on, the most telling first.
//!
//! Every shape is scored on the plain residual: what it explains, less what chance would, with
//! the variance of its coefficients from blocks. The best few are tested with the residual made
//! white after their removal ([`super::whitening`]); only where none of them stands is the search
//! repeated on the whitened residual, by probability: it sees small effects below a random load.
//! What stands must be as improbable in the filter, beside a random load ([`super::beside_load`]). What is
//! found joins the base, and the rest is tested anew: so every finding is conditional on those before.

use drivescope_plant::effects::info::Variable;
use nalgebra::DVector;
use rayon::prelude::*;

use super::layout::Layout;
use super::score::{Filtered, Score, basis, outside};
use super::shape::Shape;
use super::whitening::Whitening;

/// Probability, after correction for the number of shapes (Bonferroni, by variable), below which a
/// shape is reported. One in a thousand and not one in twenty: blocks are few, a random load is no normal
/// noise, and a real effect of any size falls far below.
pub(super) const LEVEL: f64 = 1e-3;
/// Share of the noise's power that a shape must explain to be worth a word: the error then falls
/// by a quarter of a per cent at least.
const WORTH: f64 = 0.005;
/// Shapes that are tested for a variable in first place.
const TESTED: usize = 3;
/// Variables that are reported at most.
const MOST: usize = 4;

/// Residual, base and shapes, as columns of a [`Layout`].
pub(super) struct Data<'a> {
    /// Probability by chance of what a shape explains beside others and a random load, where the drive can
    /// be filtered.
    pub(super) beside_load: &'a (dyn Fn(&[Shape], Shape) -> Option<f64> + Sync),
    pub(super) layout: &'a Layout,
    pub(super) residual: &'a [f64],
    pub(super) base: &'a [Vec<f64>],
    pub(super) shapes: Vec<Shape>,
    /// Columns of each shape.
    pub(super) columns: Vec<Vec<Vec<f64>>>,
    /// Block of each row, and how many there are: of the residual as it is.
    pub(super) blocks: (Vec<usize>, usize),
    /// The same of the residual made white, whose memory is shorter.
    pub(super) white_blocks: (Vec<usize>, usize),
    /// Squared error of a perfect model, per value.
    pub(super) floor: f64,
    /// By how much the probability of each shape is corrected.
    pub(super) hypotheses: Vec<f64>,
}

/// By how much the probability of each shape is corrected: every variable has an equal part of the
/// level, and its shapes share that, so that the many waves over the angle do not hide a friction;
/// those were chosen among `looked_at` wave numbers.
pub(super) fn hypotheses(shapes: &[Shape], looked_at: usize) -> Vec<f64> {
    let mut variables: Vec<Variable> = shapes.iter().map(|it| it.variable()).collect();
    let of_variable = |variable: Variable| {
        let waves = if variable == Variable::Theta { looked_at } else { 0 };
        shapes.iter().filter(|it| it.variable() == variable).count() + waves
    };
    let counts: Vec<usize> = variables.iter().map(|it| of_variable(*it)).collect();
    variables.sort_unstable();
    variables.dedup();
    counts.into_iter().map(|count| (variables.len() * count) as f64).collect()
}

/// A shape that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) shape: Shape,
    pub(super) p_value: f64,
    /// Share of the excess of squared error that it explains.
    pub(super) share: f64,
}

/// A shape by its number, with its score less what chance would explain.
struct Ranked {
    number: usize,
    score: Score,
    worth: f64,
}

impl Data<'_> {
    /// The findings, most telling first.
    pub(super) fn search(&self) -> Vec<Found> {
        let mut added: Vec<usize> = Vec::new();
        let mut findings: Vec<Found> = Vec::new();
        let floor = self.floor * self.layout.values();
        let excess = (self.remainder(&added).norm_squared() - floor).max(WORTH * floor);
        let known = |added: &[usize], variable: Variable| {
            added.iter().any(|number| self.shapes[*number].variable() == variable)
        };
        // A second shape over a variable that is known already is taken, not told again.
        while added.len() < 2 * MOST && findings.len() < MOST {
            let Some((number, p_value)) = self.next(&added) else { break };
            let before = self.remainder(&added).norm_squared();
            let variable = self.shapes[number].variable();
            let again = known(&added, variable);
            added.push(number);
            let share = ((before - self.remainder(&added).norm_squared()) / excess).clamp(0.0, 1.0);
            match findings.iter_mut().find(|it| again && it.shape.variable() == variable) {
                Some(first) => first.share = (first.share + share).min(1.0),
                None => findings.push(Found { shape: self.shapes[number], p_value, share }),
            }
        }
        findings
    }

    /// The next shape that stands, with its corrected probability.
    fn next(&self, added: &[usize]) -> Option<(usize, f64)> {
        let mut plain = self.ranked(added, &|column| column.to_vec(), &self.blocks);
        plain.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        let worth = WORTH * self.floor * self.layout.values();
        let judge = |number: usize| {
            let gain = plain.iter().find(|it| it.number == number)?.score.gain;
            let corrected = |p_value: f64| (p_value * self.hypotheses[number]).min(1.0);
            let stands = |p_value: &f64| *p_value < LEVEL && gain > worth;
            let p_value = Some(corrected(self.confirmed(added, number)?)).filter(stands)?;
            let known: Vec<Shape> = added.iter().map(|it| self.shapes[*it]).collect();
            let beside_load = (self.beside_load)(&known, self.shapes[number]).map(corrected);
            let p_value = p_value.max(beside_load.unwrap_or(0.0));
            stands(&p_value).then_some((number, p_value))
        };
        let clearly = plain.iter().take(TESTED).filter(|it| it.worth > 0.0);
        clearly.map(|it| it.number).find_map(judge).or_else(|| {
            let filter = self.whitening(added);
            let white = |column: &[f64]| filter.apply(column, self.layout);
            let mut ranked = self.ranked(added, &white, &self.white_blocks);
            let p_value = |it: &Ranked| it.score.p_value * self.hypotheses[it.number];
            ranked.sort_by(|a, b| p_value(a).total_cmp(&p_value(b)));
            let clearly = ranked.iter().filter(|it| it.worth > 0.0).take(TESTED);
            clearly.map(|it| it.number).find_map(judge)
        })
    }

    /// Columns of the base and of what was found.
    fn known<'b>(&'b self, added: &'b [usize]) -> impl Iterator<Item = &'b [f64]> + 'b {
        let found = added.iter().flat_map(|number| &self.columns[*number]);
        self.base.iter().chain(found).map(Vec::as_slice)
    }

    /// The residual after the base and these shapes are fitted to it.
    pub(super) fn remainder(&self, added: &[usize]) -> DVector<f64> {
        let known = basis(self.known(added), self.layout.rows());
        outside(&known, self.residual)
    }

    /// The filter that makes it white.
    fn whitening(&self, added: &[usize]) -> Whitening {
        Whitening::fit(self.remainder(added).as_slice(), self.layout)
    }

    /// All other shapes through that filter.
    fn ranked(
        &self,
        added: &[usize],
        filter: &(dyn Fn(&[f64]) -> Vec<f64> + Sync),
        blocks: &(Vec<usize>, usize),
    ) -> Vec<Ranked> {
        let filtered = Filtered::new(self.residual, self.known(added), filter);
        let chance = self.layout.values().ln();
        let others = (0..self.shapes.len()).into_par_iter();
        others
            .filter(|number| !added.contains(number))
            .filter_map(|number| {
                let score = filtered.score(&self.columns[number], blocks)?;
                let by_chance = score.variance.max(1.0) * score.columns as f64 * chance;
                Some(Ranked { number, score, worth: score.gain - by_chance })
            })
            .collect()
    }

    /// Probability of a shape with the residual made white after its removal.
    fn confirmed(&self, added: &[usize], number: usize) -> Option<f64> {
        let with: Vec<usize> = added.iter().copied().chain([number]).collect();
        let whitening = self.whitening(&with);
        let filter = |column: &[f64]| whitening.apply(column, self.layout);
        let filtered = Filtered::new(self.residual, self.known(added), &filter);
        Some(filtered.score(&self.columns[number], &self.white_blocks)?.p_value)
    }
}
