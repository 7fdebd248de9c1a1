//! Which candidates are worth a fit, and these at their best.

use drivescope_plant::drive::EffectData;
use rayon::prelude::*;

use super::decision;
use super::ground::Ground;
use super::judged::{Judged, Weighed};
use super::refit::Model;
use super::round::Round;
use crate::likelihood::{LawWeight, Weights};

/// ln of the evidence at its null from which on a law is fitted.
const PROMISING: f64 = 2.0;
/// Share of the best law's evidence at its null from which another one is fitted.
const CHANCE: f64 = 0.05;
/// Shapes from which a law without a derivative at its null is fitted.
const STARTS: usize = 2;
/// Factors on the coefficients at its null from which a law with fast states is fitted besides: what it
/// does is not in proportion to them.
const FARTHER: [f64; 2] = [5.0, 25.0];

impl Round<'_> {
    /// Laws that are worth a fit: the most probable; what every machine has; what excludes the best of
    /// them, for only fits tell which it is; and laws without a derivative at their null where a curve
    /// shows something over their variables. Those of two masses come by themselves
    /// ([`Round::of_two_masses`]).
    fn promising<'w>(&self, weights: &'w Weights) -> Vec<&'w LawWeight> {
        let candidate = |it: &LawWeight| &self.all[it.candidate];
        let of_one = || weights.laws.iter().filter(|it| !self.is_of_free_run(candidate(it)));
        let mut promising: Vec<&LawWeight> = of_one().filter(|it| is_evident(it)).collect();
        let best = promising.first().copied();
        let most = best.map_or(0.0, |best| best.evidence);
        promising.retain(|it| it.evidence >= CHANCE * most);
        promising.truncate(decision::REFITTED);
        let instead = |it: &LawWeight| {
            best.is_some_and(|best| candidate(best).info.excludes.contains(&candidate(it).info.id))
        };
        let law = weights.laws.first().map_or(0.0, |it| it.evidence);
        let curve = weights
            .curves
            .first()
            .filter(|it| it.evidence > self.rule.evidence && self.rule.share * it.evidence > law);
        let shown = |it: &LawWeight| {
            let over = &self.all[it.candidate].fails_over;
            curve.is_some_and(|it| it.curve.variables().iter().any(|v| over.contains(v)))
        };
        // What every machine has is fitted whatever a random load takes of it.
        let basic = |it: &LawWeight| candidate(it).info.basic && it.finite && !it.imitated;
        let bends = |it: &LawWeight| !candidate(it).is_linear() && shown(it);
        let beside = |it: &&LawWeight| basic(it) || instead(it) || bends(it);
        let beside: Vec<&LawWeight> = of_one().filter(beside).collect();
        for one in beside {
            if promising.iter().all(|it| it.candidate != one.candidate) {
                promising.push(one);
            }
        }
        promising
    }

    /// Further laws, where none of those that promised most convinces.
    fn others<'w>(&self, weights: &'w Weights, fitted: &[Judged]) -> Vec<&'w LawWeight> {
        let is_in = |it: &LawWeight| fitted.iter().any(|one| one.candidate == it.candidate);
        let of_one = |it: &LawWeight| !self.is_of_free_run(&self.all[it.candidate]);
        let others = weights.laws.iter().filter(|it| is_evident(it) && of_one(it) && !is_in(it));
        others.take(decision::REFITTED).collect()
    }

    /// Laws at their best, fitted.
    pub(crate) fn at_their_best(&self, ground: &Ground, laws: &[&LawWeight]) -> Vec<Judged> {
        self.fitted_beside(ground, laws, None)
    }

    /// The same; in free run those alone that come near the squared error that another law leaves.
    pub(super) fn fitted_beside(
        &self,
        ground: &Ground,
        laws: &[&LawWeight],
        other: Option<f64>,
    ) -> Vec<Judged> {
        let filtered = |weight: &LawWeight, of_free_run: Option<&Model>| {
            let it = &self.all[weight.candidate];
            let starts = weight.variants.iter().take(if it.is_linear() { 1 } else { STARTS });
            let at = |variant: &usize| {
                let mut effect = it.variants[*variant].effect.clone();
                for (name, value) in it.coefficients.iter().zip(&weight.coefficients) {
                    let own = effect.parameters.iter_mut().find(|(own, _)| own == name);
                    own.into_iter().for_each(|(_, own)| *own = *value);
                }
                effect
            };
            let of_free_run = of_free_run.map(|model| &model.fitted.drive.effects);
            let of_free_run = of_free_run.into_iter().flatten().filter(|effect| effect.id == it.id);
            let mut starts: Vec<EffectData> = starts.map(at).chain(of_free_run.cloned()).collect();
            if it.is_linear() && it.info.stiff {
                starts.extend(FARTHER.map(|factor| it.scaled(&starts[0], factor)));
            }
            let (drive, own) = ground.with(&starts, &it.estimated(), &it.coefficients)?;
            // A law whose coefficients all stay at the end of their range is none.
            let values = drive.parameters();
            let at_end = |(name, range): (&String, &(f64, f64))| {
                let name = format!("{}.{name}", it.id);
                values.iter().any(|it| it.name == name && it.value == range.0)
            };
            if it.is_linear() && it.coefficients.iter().zip(&it.ranges).all(at_end) {
                return None;
            }
            let weighed = Weighed::of(own.over(ground.base()), own.size);
            let mut model = self.model.clone();
            model.fitted.drive = drive;
            for name in &it.frozen {
                model.fitted.drive.fixed.push(format!("{}.{name}", it.id));
            }
            Some(Judged::of(weight.candidate, model, weighed))
        };
        let best = |weight: &&LawWeight| {
            let it = &self.all[weight.candidate];
            let found = self
                .is_of_free_run(it)
                .then(|| self.fit_of_free_run(ground, it, &weight.variants, other))
                .flatten();
            let by_filter = filtered(weight, found.as_ref().map(|it| &it.model));
            let by_free_run = found.map(|found| found.judged(weight.candidate));
            let both = [by_filter, by_free_run].into_iter().flatten();
            both.max_by(|a, b| a.weighed.evidence.total_cmp(&b.weighed.evidence))
        };
        laws.par_iter().filter_map(best).collect()
    }

    /// The candidates of one mass that are worth a fit, with what speaks against each, most probable
    /// first.
    pub(super) fn of_one_mass(&self, ground: &Ground, weights: &Weights) -> Vec<Judged> {
        let mut judged = ordered(self.convincing(ground, weights, &self.promising(weights)));
        let nothing = judged.iter().all(|one| one.refused.is_some());
        if nothing && !judged.first().is_some_and(|best| self.is_disturbance(best)) {
            judged.extend(self.convincing(ground, weights, &self.others(weights, &judged)));
        }
        ordered(judged)
    }

    /// The same with further ones, where the free run refused all that convinced.
    pub(super) fn of_others(
        &self,
        ground: &Ground,
        weights: &Weights,
        judged: &mut Vec<Judged>,
    ) -> bool {
        let others = self.others(weights, judged);
        self.join(ground, weights, &others, judged)
    }

    /// Puts those laws, fitted, among the judged ones; whether there are any.
    fn join(
        &self,
        ground: &Ground,
        weights: &Weights,
        laws: &[&LawWeight],
        judged: &mut Vec<Judged>,
    ) -> bool {
        // In the order that was decided where nothing joins.
        if laws.is_empty() {
            return false;
        }
        self.judge(ground, weights, self.at_their_best(ground, laws), judged);
        true
    }

    fn convincing(&self, ground: &Ground, weights: &Weights, laws: &[&LawWeight]) -> Vec<Judged> {
        self.with_refusals(ground, weights, self.at_their_best(ground, laws))
    }

    /// Fitted laws with what speaks against each.
    fn with_refusals(
        &self,
        ground: &Ground,
        weights: &Weights,
        mut fitted: Vec<Judged>,
    ) -> Vec<Judged> {
        let curve = weights.repeating().next();
        let curve = curve.map(|it| (it, weights.beyond(ground.base().fitted, it)));
        for one in &mut fitted {
            one.refused = self.unconvincing(ground, one, curve);
        }
        fitted
    }

    /// Puts fitted laws among the judged ones, in the place of a fit of the same law.
    pub(super) fn judge(
        &self,
        ground: &Ground,
        weights: &Weights,
        fitted: Vec<Judged>,
        judged: &mut Vec<Judged>,
    ) {
        let further = self.with_refusals(ground, weights, fitted);
        judged.retain(|one| further.iter().all(|it| it.candidate != one.candidate));
        judged.extend(further);
        *judged = ordered(std::mem::take(judged));
    }
}

/// Most evidence first.
fn ordered(mut judged: Vec<Judged>) -> Vec<Judged> {
    judged.sort_by(|a, b| b.weighed.evidence.total_cmp(&a.weighed.evidence));
    judged
}

/// Whether the recordings tell a law from the base.
pub(super) fn is_evident(it: &LawWeight) -> bool {
    it.finite && !it.imitated && it.evidence > PROMISING
}
