//! One round of the loop: weigh everything beside the drive, fit what is promising, decide by the
//! numbers of [`super::decision`].

use drivescope_plant::effects::grid::Spans;
use drivescope_plant::effects::law::Variable;

use super::candidate::Candidate;
use super::curves::Curve;
use super::decision::Rule;
use super::ground::Ground;
use super::judged::Judged;
use super::learned::LearnedCurve;
use super::probability;
use super::refit::Model;
use super::report::{Coefficient, RandomLoad, Ranked, Step, Watch};
use crate::estimate::Evidence;
use crate::formula;
use crate::likelihood::{CurveWeight, LawWeight, Randomness, Weights};
use crate::signals::{is_coarse, is_one_speed};

/// Disturbances locked to the position that recordings may have besides.
const DISTURBANCES: usize = 3;
/// Curves that are tried for what nobody knows.
const CURVES: usize = 5;

/// What a round has to go on.
pub(crate) struct Round<'a> {
    pub(crate) model: &'a Model,
    pub(crate) all: &'a [Candidate],
    pub(crate) spans: &'a Spans,
    pub(crate) estimation: &'a Evidence,
    pub(crate) validation: &'a Evidence,
    pub(crate) rule: &'a Rule,
    pub(crate) watch: &'a dyn Watch,
    /// Kinds that were named before.
    pub(crate) named: &'a [String],
    /// What their formulas may leave.
    pub(crate) formulas: &'a [Formula],
    /// What was random beside the drive before they were named.
    pub(crate) randomness: Option<Randomness>,
}

/// What the formula of a named law may leave: a part of its size over its own variables.
#[derive(Debug, Clone)]
pub(crate) struct Formula {
    fails_over: Vec<Variable>,
    size: f64,
}

impl Formula {
    pub(crate) fn of(candidate: &Candidate, size: f64) -> Self {
        Self { fails_over: candidate.fails_over.clone(), size }
    }

    /// Of no size, over those variables.
    #[cfg(test)]
    pub(crate) fn over(variables: &[Variable]) -> Self {
        Self { fails_over: variables.to_vec(), size: 0.0 }
    }
}

/// What a round found.
#[derive(Default)]
pub(crate) struct Outcome {
    /// Fitted candidates, most probable first.
    pub(crate) judged: Vec<Judged>,
    /// Candidates that were weighed and promised too little for a fit, most probable first, with ln of
    /// their evidence.
    pub(crate) unfitted: Vec<(usize, f64)>,
    /// Candidates that the base parameters imitate.
    pub(crate) imitated: Vec<usize>,
    /// Candidates with which the model has no finite run or derivative.
    pub(crate) overflowing: Vec<usize>,
    /// Candidates of which the torque of a known motion does not tell.
    pub(crate) untold: Vec<usize>,
    /// What is random in the load.
    pub(crate) load: Option<RandomLoad>,
    /// Where a search for what is random begins, in a drive that lacks less.
    pub(crate) randomness: Option<Randomness>,
    /// What nobody knows, where nothing is named and a curve shows that something is missing.
    pub(crate) unknown: Option<CurveWeight>,
    /// Formulas for it; alone, where they show what no curve does.
    pub(crate) proposed: Vec<formula::Formula>,
    /// Whether a curve shows more beside the named laws than their formulas may leave.
    pub(crate) formulas_fail: bool,
}

impl Round<'_> {
    /// Weighs, fits and decides beside the drive of the round at its own best.
    pub(crate) fn run(&self, ground: &Ground) -> Outcome {
        let mut disturbed;
        let mut ground = ground;
        let mut disturbances = Vec::new();
        let (weights, mut judged) = loop {
            let Some(weights) = self.weights(ground) else { return Outcome::default() };
            let mut judged = self.judged(ground, &weights);
            let nothing = judged.iter().all(|one| one.refused.is_some());
            let disturbs = judged.first().is_some_and(|best| self.is_disturbance(best));
            let enough = disturbances.len() == DISTURBANCES || self.watch.stopped();
            if enough || !(nothing && disturbs) {
                break (weights, judged);
            }
            let best = judged.swap_remove(0);
            let it = &self.all[best.candidate];
            let law = best.model.fitted.drive.effects.iter().find(|effect| effect.id == it.id);
            let Some(beside) = law.and_then(|law| ground.beside(law, &it.coefficients)) else {
                break (weights, judged);
            };
            disturbed = beside;
            ground = &disturbed;
            disturbances.push(best);
        };
        let of = |wanted: fn(&LawWeight) -> bool| {
            weights.laws.iter().filter(|it| wanted(it)).map(|it| it.candidate).collect()
        };
        let imitated = of(|it| it.finite && it.imitated);
        let overflowing = of(|it| !it.finite);
        judged.extend(disturbances);
        let is_judged = |candidate: usize| judged.iter().any(|one| one.candidate == candidate);
        let weighed = weights.laws.iter().filter(|it| it.finite && !it.imitated);
        let unfitted = weighed.map(|it| (it.candidate, it.evidence)).filter(|it| !is_judged(it.0));
        let unfitted = unfitted.collect();
        let nothing = judged.iter().all(|one| one.refused.is_some());
        // Where the noise alone is left, what a curve takes of it is nothing.
        let open = nothing && !self.is_at_floor();
        let unknown = if open { self.unknown(ground, &weights) } else { None };
        let proposed = match unknown {
            Some(_) => self.formulas_beyond(ground, self.rule.evidence),
            None if open && self.named.is_empty() => self.formulas_alone(ground),
            None => Vec::new(),
        };
        let evidence = || proposed.first().map(formula::Formula::worth);
        let unknown_by = unknown.as_ref().map(|it| it.evidence).or_else(evidence);
        probability::tell(&mut judged, self.rule, unknown_by);
        let untold = (0..self.all.len()).filter(|it| !ground.tells(&self.all[*it])).collect();
        let load = Some(ground.load());
        let randomness = ground.randomness();
        let remainder = weights.left_by_formulas + self.rule.curve_odds.ln();
        Outcome {
            judged,
            unfitted,
            imitated,
            overflowing,
            untold,
            load,
            randomness,
            unknown,
            proposed,
            formulas_fail: remainder > self.rule.evidence,
        }
    }

    /// The drive of the round at its own best; nothing where it overflows.
    pub(crate) fn ground(&self) -> Option<Ground> {
        self.watch.step(&Step::Doing("filtering the recordings"));
        Ground::of(self.model, (self.estimation, self.validation), self.randomness)
    }

    /// What every candidate and curve would explain.
    pub(crate) fn weights(&self, ground: &Ground) -> Option<Weights> {
        self.watch.step(&Step::Doing("weighing the library"));
        let tolerated = |curve: &Curve| {
            let own = |it: &&Formula| {
                curve.variables().iter().any(|variable| it.fails_over.contains(variable))
            };
            let sizes = self.formulas.iter().filter(own).map(|it| self.rule.formula * it.size);
            sizes.reduce(f64::max)
        };
        ground.weigh(self.all, self.spans, tolerated, &|| self.watch.stopped())
    }

    /// The candidates that are worth a fit, fitted and decided upon.
    fn judged(&self, ground: &Ground, weights: &Weights) -> Vec<Judged> {
        self.watch.step(&Step::Doing("fitting the best candidates"));
        let mut judged = self.of_one_mass(ground, weights);
        let decide = |judged: &mut Vec<Judged>| {
            self.simplest_of_equal(judged);
            self.basic_first(judged);
            self.fit_first(ground, judged);
        };
        let convinced = judged.iter().any(|one| one.refused.is_none());
        decide(&mut judged);
        let nothing = judged.iter().all(|one| one.refused.is_some());
        if convinced && nothing && self.of_others(ground, weights, &mut judged) {
            decide(&mut judged);
        }
        if self.of_two_masses(ground, weights, &mut judged) {
            decide(&mut judged);
        }
        if self.of_free_run(ground, weights, &mut judged) {
            decide(&mut judged);
        }
        self.fit_small(&mut judged);
        judged
    }

    /// The curve that shows that something is missing: the most probable that leaves less torque
    /// unexplained, where the torque is what tells. Over a speed that hardly changes, that torque is the
    /// answer of a controller.
    pub(super) fn unknown(&self, ground: &Ground, weights: &Weights) -> Option<CurveWeight> {
        let mut standing = weights.repeating().take_while(|curve| self.stands(curve)).take(CURVES);
        if !self.model.setting.observer.follows() && ground.filtered().is_some() {
            // What follows few levels may be the converter's, unless the error falls with it.
            let lowers = |curve: &CurveWeight| {
                let removed = |it: Model| self.removed(&it).min(self.removed_of_validation(&it));
                self.with_curve(curve).map(removed).is_some_and(|it| it >= self.rule.size)
            };
            return standing
                .next()
                .filter(|curve| !is_coarse(self.estimation) || lowers(curve))
                .cloned();
        }
        let standing: Vec<&CurveWeight> = standing.collect();
        if standing.is_empty() {
            return None;
        }
        let before = self.torque_left_at_balances(&self.model.fitted.drive);
        let shown = |curve: &&CurveWeight| {
            let answers = curve.curve.is_over_speed() && is_one_speed(self.estimation);
            !answers && self.lowers_torque(before, curve)
        };
        standing.into_iter().find(shown).cloned()
    }

    /// Formulas that have more than that evidence, less what choosing one costs.
    pub(super) fn formulas_beyond(&self, ground: &Ground, evidence: f64) -> Vec<formula::Formula> {
        self.watch.step(&Step::Doing("trying formulas"));
        ground.formulas(evidence, &|| self.watch.stopped())
    }

    /// What nobody knows as a curve, in the drive and fitted.
    pub(super) fn drawn(&self, curve: &CurveWeight, formulas: &[formula::Formula]) -> LearnedCurve {
        self.watch.step(&Step::Doing("drawing what nobody knows"));
        let removed = self.with_curve(curve).map_or(0.0, |with| self.removed(&with));
        LearnedCurve::of(curve, removed, &self.model.fitted.drive, formulas)
    }

    /// The line of a candidate in the ranking.
    pub(crate) fn ranked(&self, one: &Judged, outcome: &Outcome) -> Ranked {
        let candidate = &self.all[one.candidate];
        let own = format!("{}.", candidate.id);
        let spread = |name: &str| {
            let fitted = one.model.fitted.parameters.iter().find(|it| it.name == name);
            fitted.map_or(f64::NAN, |it| it.std_error)
        };
        let all = one.model.fitted.drive.parameters().into_iter();
        let parameters = all.filter(|it| it.name.starts_with(&own)).map(|it| {
            let std_error = spread(&it.name);
            (it.name, Coefficient { value: it.value, std_error, unit: it.unit })
        });
        let weighed = &one.weighed;
        Ranked {
            effect: candidate.name.clone(),
            confusion_set: self.confusion_set(one, outcome),
            delta_bic: 2.0 * weighed.evidence,
            // Under the base, evidence beyond that is at most so probable (Ville, 1939).
            p_value: (-weighed.evidence).exp().min(1.0),
            excess_removed: self.removed(&one.model),
            validation_gain: 2.0 * weighed.repeats,
            probability: weighed.probability,
            size: weighed.size,
            parameters: parameters.collect(),
            refused: one.refused.clone(),
        }
    }
}
