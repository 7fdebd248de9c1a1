//! One round of the loop: screen, refit, judge by the gates.

use drivescope_plant::drive::EffectData;
use drivescope_plant::effects::registry::Entry;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::gates;
use super::inverse::{ByInverse, SecondOpinion};
use super::judge::Judged;
use super::left::Left;
use super::refit::{Model, refit, squared};
use super::report::{Coefficient, Ranked, Step, Watch};
use super::scales::Scales;
use super::screen::{Screen, Screened, screen};
use super::sight::Sight;
use super::weighed::Formula;
use crate::estimate::{Estimate, Evidence};

/// What a round has to go on.
pub(crate) struct Round<'a> {
    pub(crate) model: &'a Model,
    /// It at the estimation and at the validation data.
    pub(crate) sight: Sight<'a>,
    pub(crate) validation_sight: Sight<'a>,
    /// Squared error of the base of the whole loop.
    pub(crate) first: f64,
    pub(crate) all: &'a [Candidate],
    pub(crate) scales: &'a Scales,
    pub(crate) estimation: &'a Evidence,
    pub(crate) validation: &'a Evidence,
    pub(crate) watch: &'a dyn Watch,
    /// Squared error of a perfect model.
    pub(crate) floor: f64,
    /// The same on the validation data.
    pub(crate) validation_floor: f64,
    /// Kinds that were named before.
    pub(crate) named: &'a [String],
    /// What their formulas may leave.
    pub(crate) formulas: &'a [Formula],
}

/// What a round found.
#[derive(Default)]
pub(crate) struct Outcome {
    /// Refitted candidates, best first.
    pub(crate) judged: Vec<Judged>,
    /// Candidates that the base parameters imitate.
    pub(crate) imitated: Vec<usize>,
    /// Candidates with which the model has no finite run or derivative.
    pub(crate) overflowing: Vec<usize>,
    /// Candidates that were not refitted although the screen gives them as much as the best.
    pub(crate) alike: Vec<usize>,
    /// What curves could remove of the round's own base, where nothing passes.
    pub(crate) left: Option<Left>,
    /// Whether a candidate explains much, but has the wrong shape.
    pub(crate) misshapen: bool,
}

impl Round<'_> {
    /// Screens, refits and judges.
    pub(crate) fn run(&self) -> Outcome {
        self.watch.step(&Step::Doing("screening the library"));
        let screened = self.screened();
        let imitated =
            screened.plain.iter().filter(|one| one.is_imitated()).map(|it| it.candidate).collect();
        let overflowing = self.overflowing(&screened);
        self.watch.step(&Step::Doing("fitting the best candidates"));
        let mut judged = self.refitted(&screened);
        self.watch.step(&Step::Doing("comparing with curves"));
        self.simplest_first(&mut judged);
        let mut misshapen = false;
        let passed = judged.iter().position(|one| one.refused.is_none());
        if let Some(best) = passed.filter(|best| !self.refines(&self.all[judged[*best].candidate]))
        {
            judged[best].refused = self.misshapen(&mut judged[best]);
            misshapen = judged[best].refused.is_some();
        }
        if misshapen {
            // What is next best explains less, and its shape is no better.
            for one in &mut judged {
                one.refused.get_or_insert_with(|| "a better one has the wrong shape".to_owned());
            }
        }
        let passes = judged.iter().any(|one| one.refused.is_none());
        let left = (!passes).then(|| self.left(&self.sight, &self.validation_sight));
        let alike = self.as_promising(&screened, &judged);
        Outcome { judged, imitated, overflowing, alike, left, misshapen }
    }

    /// Gain in BIC of the best candidate, fitted whatever the screen foretells: a truth is not to
    /// be left out for a bad begin.
    pub(crate) fn gain_of_best(&self) -> f64 {
        let screened = self.screened();
        let begins: Vec<&Screened> = screened.plain.iter().chain(&screened.white).collect();
        self.judged(self.models(&begins)).first().map_or(0.0, |one| one.delta_bic)
    }

    /// The candidates that may be named, screened.
    fn screened(&self) -> Screen {
        let may = |candidate: &Candidate| self.may(candidate);
        screen(&self.sight, self.all, &may, &|| self.watch.stopped())
    }

    /// Whether it may be named in this round.
    fn may(&self, candidate: &Candidate) -> bool {
        let excess = self.model.fitted.squares.sum - self.floor;
        excess >= self.needed(candidate) || self.is_named(candidate) || self.refines(candidate)
    }

    /// The candidates of which the screen has no finite number.
    fn overflowing(&self, screened: &Screen) -> Vec<usize> {
        if self.watch.stopped() {
            return Vec::new();
        }
        let is_in = |candidate: &usize| screened.plain.iter().any(|it| it.candidate == *candidate);
        let asked = (0..self.all.len()).filter(|it| self.may(&self.all[*it]));
        asked.filter(|candidate| !is_in(candidate)).collect()
    }

    /// Squared error that an effect of a kind not named yet must remove: what a named law's own
    /// formula leaves shows over the variables of that law, and over any where it knocks.
    pub(super) fn needed(&self, candidate: &Candidate) -> f64 {
        let excess = self.first - self.floor;
        let own = &candidate.fails_over;
        let effects = &self.model.fitted.drive.effects;
        let beside = |named: &String| {
            let is = |effect: &&EffectData| effect.kind == *named || effect.id == *named;
            effects.iter().filter(is).any(|effect| {
                let knocks = Entry::find(&effect.kind).is_some_and(|entry| entry.info.knocks);
                knocks || effect.fails_over().iter().any(|variable| own.contains(variable))
            })
        };
        match self.named {
            [] => f64::NEG_INFINITY,
            named if named.iter().any(beside) => gates::FURTHER * excess,
            _ => gates::APART * excess,
        }
    }

    /// Whether its kind was named: a harmonic of what was named is no other effect.
    pub(super) fn is_named(&self, candidate: &Candidate) -> bool {
        self.named.contains(&candidate.name)
    }

    /// Whether it is another formula for what was named: together they may hold a law that
    /// neither is. It is added, and it is no other cause.
    pub(crate) fn refines(&self, candidate: &Candidate) -> bool {
        !self.is_named(candidate)
            && self.named.iter().any(|named| candidate.info.aliases.contains(&named.as_str()))
    }

    /// Candidates that the screen gives nearly as much as the best, and that were not refitted.
    fn as_promising(&self, screened: &Screen, judged: &[Judged]) -> Vec<usize> {
        let best = screened.plain.first().map_or(f64::INFINITY, |one| one.worth);
        let close = screened.plain.iter().filter(|one| best - one.worth < gates::CLOSE);
        let refitted = |it: usize| judged.iter().any(|one| one.candidate == it);
        close.map(|one| one.candidate).filter(|it| best > 0.0 && !refitted(*it)).collect()
    }

    /// What curves could remove of a model.
    pub(super) fn left(&self, sight: &Sight<'_>, validation: &Sight<'_>) -> Left {
        Left::of(sight, validation, self.scales, &|| self.watch.stopped())
    }

    /// The promising ones, fitted, with their gains in the innovations of the best of them: those
    /// that explain most, and the rest only if none of these passes.
    fn refitted(&self, screened: &Screen) -> Vec<Judged> {
        // A refit that gains more than the screen foretells gains not that much more.
        let enough = |one: &Screened| {
            let candidate = &self.all[one.candidate];
            let named = self.is_named(candidate) || self.refines(candidate);
            one.worth > 0.0 && (named || one.gain >= gates::AT_ONCE * self.needed(candidate))
        };
        let mut promising = screened.promising(self.all, enough);
        promising.truncate(gates::REFITTED);
        // What excludes the best stands for it, however bad its begins: only fits tell which it is.
        let info = |one: &Screened| self.all[one.candidate].info;
        let of_best = promising.first().map_or(&[][..], |best| info(best).excludes);
        let instead = |one: &&Screened| of_best.contains(&info(one).id);
        let is_in = |one: &&Screened| promising.iter().any(|it| it.candidate == one.candidate);
        let beside: Vec<&Screened> =
            screened.plain.iter().filter(|one| instead(one) && !is_in(one)).collect();
        promising.extend(beside);
        let at_once = |one: &Screened| {
            let best = |some: &[Screened]| some.first().map_or(f64::INFINITY, |best| best.worth);
            let of = |some: &[Screened]| {
                let same = |it: &Screened| {
                    it.candidate == one.candidate && it.worth >= gates::AT_ONCE * best(some)
                };
                some.iter().any(same)
            };
            of(&screened.plain) || of(&screened.white)
        };
        let (first, rest): (Vec<&Screened>, Vec<&Screened>) =
            promising.iter().partition(|one| at_once(one) || instead(one));
        let judged = self.judged(self.models(&first));
        if rest.is_empty() || judged.iter().any(|one| one.refused.is_none()) {
            return judged;
        }
        let mut models: Vec<(usize, Model)> =
            judged.into_iter().map(|one| (one.candidate, one.model)).collect();
        models.extend(self.models(&rest));
        self.judged(models)
    }

    pub(super) fn models(&self, promising: &[&Screened]) -> Vec<(usize, Model)> {
        if self.watch.stopped() {
            return Vec::new();
        }
        let fit = |one: &&Screened| {
            let candidate = &self.all[one.candidate];
            let seen = |_| self.watch.stopped();
            let model = refit(self.model, candidate, one, self.estimation, self.validation, &seen);
            // One that diverges is out; the rest goes on.
            Some((one.candidate, model.ok()?))
        };
        promising.par_iter().filter_map(fit).collect()
    }

    /// The line of a candidate in the ranking.
    pub(crate) fn ranked(&self, one: &Judged, outcome: &Outcome) -> Ranked {
        let excess = (self.model.fitted.squares.sum - self.floor).max(f64::MIN_POSITIVE);
        let removed = self.model.fitted.squares.sum - one.model.fitted.squares.sum;
        let own = format!("{}.", self.all[one.candidate].id);
        let parameters = one.model.fitted.parameters.iter();
        let parameters = parameters.filter(|it| it.name.starts_with(&own));
        let coefficient = |it: &Estimate| {
            let unit = it.unit.clone();
            (it.name.clone(), Coefficient { value: it.value, std_error: it.std_error, unit })
        };
        Ranked {
            effect: self.all[one.candidate].name.clone(),
            confusion_set: self.confusion_set(one, outcome),
            delta_bic: one.delta_bic,
            p_value: one.p_value,
            excess_removed: (removed / excess).clamp(0.0, 1.0),
            validation_gain: one.validation_gain,
            shape: one.shape,
            probability: one.weighed.map(|it| it.probability),
            size: one.weighed.map(|it| it.size),
            parameters: parameters.map(coefficient).collect(),
            refused: one.refused.clone(),
        }
    }

    /// Puts the simplest of those that pass and gain as much as the best of them before it: what a
    /// richer law gains by less than [`gates::CLOSE`] is no evidence for its riches, and of laws
    /// that exclude each other neither is what the simpler one's own formula may leave.
    fn simplest_first(&self, judged: &mut [Judged]) {
        let Some(best) = judged.iter().position(|one| one.refused.is_none()) else { return };
        let info = |one: &Judged| self.all[one.candidate].info;
        let close = |one: &Judged| {
            let less = judged[best].delta_bic - one.delta_bic;
            let instead = info(&judged[best]).excludes.contains(&info(one).id);
            let formula = if instead { gates::APART * judged[best].delta_bic } else { 0.0 };
            one.refused.is_none() && less < gates::CLOSE.max(formula)
        };
        let simplest =
            (best..judged.len()).filter(|k| close(&judged[*k])).min_by_key(|k| judged[*k].of_law);
        if let Some(simplest) = simplest {
            judged[best..=simplest].rotate_right(1);
        }
    }

    /// What the recordings do not tell from it: laws that gain as much, one that gains more and
    /// excludes it, and laws that are sometimes equal by algebra and change the same here.
    pub(crate) fn confusion_set(&self, one: &Judged, outcome: &Outcome) -> Vec<String> {
        let Candidate { info, name, .. } = &self.all[one.candidate];
        let alike = |other: &&Judged| {
            let id = self.all[other.candidate].name.as_str();
            let more = other.delta_bic - one.delta_bic;
            let close = more.abs() < gates::CLOSE;
            // Only one of them can stand in the drive, and it was not the one that gains more.
            let instead = info.excludes.contains(&id) && more > 0.0;
            let cosine = cosine(&one.change, &other.change);
            let by_algebra = info.aliases.contains(&id) && cosine > gates::ALIKE;
            id != name && other.delta_bic > gates::DELTA_BIC && (close || instead || by_algebra)
        };
        let refitted = outcome.judged.iter().filter(alike).map(|other| other.candidate);
        // What leads the ranking may be equal to what was screened and not refitted.
        let leads = outcome.judged.first().is_some_and(|first| first.candidate == one.candidate);
        let screened = outcome.alike.iter().copied().filter(|_| leads);
        let mut set: Vec<String> =
            refitted.chain(screened).map(|candidate| self.all[candidate].name.clone()).collect();
        set.dedup();
        set
    }

    /// What the inverse form says of the same candidates; `passed` is what the loop names.
    pub(crate) fn second_opinion(
        &self,
        outcome: &Outcome,
        passed: Option<usize>,
    ) -> Option<SecondOpinion> {
        let inverse = self.sight.inverse()?;
        let gain = |one: &Judged| {
            let passes =
                |it: &ByInverse| it.delta_bic > gates::DELTA_BIC && it.p_value < gates::P_VALUE;
            one.by_inverse.filter(passes).map(|it| it.delta_bic)
        };
        let all = outcome.judged.iter().filter_map(|one| Some((one, gain(one)?)));
        let best = all.max_by(|a, b| a.1.total_cmp(&b.1));
        let id = |one: &Judged| self.all[one.candidate].name.as_str();
        let agrees = match (best, passed.map(|named| &outcome.judged[named])) {
            (None, None) => true,
            (Some((best, _)), Some(named)) => {
                id(best) == id(named)
                    || self.confusion_set(named, outcome).iter().any(|it| it == id(best))
            }
            _ => false,
        };
        let best = best.map(|(one, gain)| (id(one).to_owned(), gain));
        Some(inverse.opinion(best, agrees))
    }
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    dot / (squared(a) * squared(b)).sqrt()
}
