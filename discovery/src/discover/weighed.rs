//! A round by the rule of evidence: weigh everything beside the drive, fit what is promising, decide
//! by the numbers of [`super::decision`].

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::law::Variable;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::curves::Curve;
use super::decision;
use super::judge::Judged;
use super::refit::{Model, NEAR_ENOUGH};
use super::report::Step;
use super::round::{Outcome, Round};
use super::screen::finer;
use crate::balances::unexplained;
use crate::estimate::Options;
use crate::likelihood::{CurveWeight, Ground, LawWeight, Scene, Weights, weigh};

/// ln of the evidence at its null from which on a law is fitted.
const PROMISING: f64 = 2.0;
/// Share of the best law's evidence at its null from which another one is fitted.
const CHANCE: f64 = 0.05;
/// Share of what the best fitted law explains that one of two masses must promise at its null.
const MASSES: f64 = 0.4;
/// Shapes from which a law without a derivative at its null is fitted.
const BEGINS: usize = 2;
/// Factors on the coefficients at its null from which a law with own states is fitted besides: what it
/// does is not in proportion to them.
const FARTHER: [f64; 2] = [5.0, 25.0];
/// Disturbances locked to the position that recordings may have besides.
const DISTURBANCES: usize = 3;
/// Share of the error on the validation data that must at least be left out, so that it falls.
const FALLS: f64 = 1e-3;

/// The evidence of a fitted candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weighed {
    /// ln of it over that of the base, of all recordings.
    evidence: f64,
    /// The part of those held out, given the others.
    repeats: f64,
    /// Root of the mean square of what it does, of what the balance holds.
    pub(crate) size: f64,
    /// That it is what is missing, among the candidates and nothing.
    pub(crate) probability: f64,
    /// Whether the error of the torque speaks for it, and not that of the motion.
    pub(crate) by_balance: bool,
}

impl Weighed {
    /// From ln of the evidence in the recordings of the fit and in all, not yet among others.
    fn of(fitted: f64, all: f64, size: f64) -> Self {
        Self { evidence: all, repeats: all - fitted, size, probability: 0.0, by_balance: false }
    }
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
}

impl Round<'_> {
    /// Weighs, refits and decides.
    pub(crate) fn weighed(&self) -> Outcome {
        self.watch.step(&Step::Doing("filtering the recordings"));
        let scene = Scene::of(self.model, self.estimation, self.validation);
        let Some(mut ground) = Ground::of(scene) else { return Outcome::default() };
        let mut disturbances = Vec::new();
        let (weights, mut judged) = loop {
            self.watch.step(&Step::Doing("weighing the library"));
            let Some(weights) = self.weights(&ground) else { return Outcome::default() };
            self.watch.step(&Step::Doing("fitting the best candidates"));
            let mut judged = self.by_evidence(&ground, &weights);
            let curve = weights.curves.iter().find(|curve| curve.repeats > 0.0);
            for one in &mut judged {
                one.refused = self.unconvincing(one, curve);
            }
            self.simplest_of_equal(&mut judged);
            self.fit_first(&ground, &mut judged);
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
            ground = beside;
            disturbances.push(best);
        };
        let of = |wanted: fn(&LawWeight) -> bool| {
            weights.laws.iter().filter(|it| wanted(it)).map(|it| it.candidate).collect()
        };
        let imitated = of(|it| it.finite && it.imitated);
        let overflowing = of(|it| !it.finite);
        judged.extend(disturbances);
        let curve = weights.curves.iter().find(|curve| curve.repeats > 0.0);
        let nothing = judged.iter().all(|one| one.refused.is_some());
        let misshapen = nothing && curve.is_some_and(|curve| self.stands(curve));
        let left = misshapen.then(|| {
            self.watch.step(&Step::Doing("drawing what nobody knows"));
            self.left(&self.sight, &self.validation_sight)
        });
        Outcome { judged, imitated, overflowing, alike: Vec::new(), left, misshapen }
    }

    /// Whether it is locked to the position in each recording and has no phase that they share.
    fn is_disturbance(&self, one: &Judged) -> bool {
        let locked = self.all[one.candidate].coefficients == ["a", "b"];
        locked
            && one.weighed.is_some_and(|it| {
                it.evidence - it.repeats > decision::EVIDENCE && it.repeats <= 0.0
            })
    }

    fn weights(&self, ground: &Ground) -> Option<Weights> {
        let tolerated = |curve: &Curve| {
            let own = |it: &&Formula| {
                curve.variables().iter().any(|variable| it.fails_over.contains(variable))
            };
            let sizes = self.formulas.iter().filter(own).map(|it| decision::FORMULA * it.size);
            sizes.reduce(f64::max)
        };
        weigh(
            &ground.scene,
            &ground.randomness,
            &ground.references,
            self.all,
            self.scales,
            tolerated,
            &|| self.watch.stopped(),
        )
    }

    /// Laws that are worth a fit: the most probable; what excludes the best of them, for only fits
    /// tell which it is; and laws without a derivative at their null where a curve shows something
    /// over their variables. Those of two masses come by themselves ([`Round::of_two`]).
    fn promising<'w>(&self, weights: &'w Weights) -> Vec<&'w LawWeight> {
        let candidate = |it: &LawWeight| &self.all[it.candidate];
        let of_one = || weights.laws.iter().filter(|it| !self.is_of_two_masses(candidate(it)));
        let mut promising: Vec<&LawWeight> = of_one().filter(|it| told(it)).collect();
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
            .filter(|it| it.evidence > decision::EVIDENCE && decision::SHARE * it.evidence > law);
        let shown = |it: &LawWeight| {
            let over = &self.all[it.candidate].fails_over;
            curve.is_some_and(|it| it.curve.variables().iter().any(|v| over.contains(v)))
        };
        let beside = |it: &&LawWeight| instead(it) || (!candidate(it).is_linear() && shown(it));
        let beside: Vec<&LawWeight> = of_one().filter(beside).collect();
        for one in beside {
            if promising.iter().all(|it| it.candidate != one.candidate) {
                promising.push(one);
            }
        }
        promising
    }

    /// Laws of two masses: far from their nulls they are told only by their fits, which take long.
    /// All of them, where one promises a part of what those that were fitted have.
    fn of_two<'w>(&self, weights: &'w Weights, fitted: &[(Judged, Weighed)]) -> Vec<&'w LawWeight> {
        let most = fitted.iter().fold(0.0_f64, |most, (_, one)| most.max(one.evidence));
        let of_two = |it: &&LawWeight| self.is_of_two_masses(&self.all[it.candidate]);
        let two = || weights.laws.iter().filter(of_two);
        let promises = |it: &LawWeight| told(it) && it.evidence >= MASSES * most;
        if two().any(promises) { two().collect() } else { Vec::new() }
    }

    /// Laws at their best, fitted.
    fn at_their_best(&self, ground: &Ground, laws: &[&LawWeight]) -> Vec<(Judged, Weighed)> {
        let filtered = |weight: &LawWeight, foretold: Option<&Model>| {
            let it = &self.all[weight.candidate];
            let begins = weight.variants.iter().take(if it.is_linear() { 1 } else { BEGINS });
            let free = it.parameters().filter(|name| !it.frozen.contains(name));
            let free: Vec<String> = free.map(|name| format!("{}.{name}", it.id)).collect();
            let at = |variant: &usize| {
                let mut effect = it.variants[*variant].effect.clone();
                for (name, value) in it.coefficients.iter().zip(&weight.coefficients) {
                    let own = effect.parameters.iter_mut().find(|(own, _)| own == name);
                    own.into_iter().for_each(|(_, own)| *own = *value);
                }
                effect
            };
            let of_free_run = foretold.map(|model| &model.fitted.drive.effects);
            let of_free_run = of_free_run.into_iter().flatten().filter(|effect| effect.id == it.id);
            let mut begins: Vec<EffectData> = begins.map(at).chain(of_free_run.cloned()).collect();
            if it.is_linear() && it.has_states() {
                begins.extend(FARTHER.map(|factor| it.scaled(&begins[0], factor)));
            }
            let (scene, own) = ground.with(&begins, &free, &it.coefficients)?;
            // A law whose coefficients all stay at the end of their range is none.
            let values = scene.drive.parameters();
            let at_end = |(name, range): (&String, &(f64, f64))| {
                let name = format!("{}.{name}", it.id);
                values.iter().any(|it| it.name == name && it.value == range.0)
            };
            if it.is_linear() && it.coefficients.iter().zip(&it.ranges).all(at_end) {
                return None;
            }
            let [fitted, all] = [own.fitted - ground.base.fitted, own.all - ground.base.all];
            let weighed = Weighed::of(fitted, all, own.size);
            let mut model = self.model.clone();
            model.fitted.drive = scene.drive;
            for name in &it.frozen {
                model.fitted.drive.fixed.push(format!("{}.{name}", it.id));
            }
            Some((Judged::weighed(weight.candidate, it, model, &weighed), weighed))
        };
        let best = |weight: &&LawWeight| {
            let it = &self.all[weight.candidate];
            let found = self.is_of_two_masses(it).then(|| self.foretold(ground, it)).flatten();
            let by_filter = filtered(weight, found.as_ref().map(|it| &it.model));
            let foretold = found.map(|found| {
                let weighed = Weighed::of(found.fitted, found.all, found.size);
                (Judged::weighed(weight.candidate, it, found.model, &weighed), weighed)
            });
            let both = [by_filter, foretold].into_iter().flatten();
            both.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence))
        };
        laws.par_iter().filter_map(best).collect()
    }

    /// Evidence of the candidates that are worth a fit, most probable first.
    fn by_evidence(&self, ground: &Ground, weights: &Weights) -> Vec<Judged> {
        let mut judged = self.at_their_best(ground, &self.promising(weights));
        judged.extend(self.at_their_best(ground, &self.of_two(weights, &judged)));
        judged.sort_by(|a, b| b.1.evidence.total_cmp(&a.1.evidence));
        // Counted from the greatest, whose exponential would overflow.
        let most = judged.first().map_or(0.0, |(_, best)| best.evidence.max(0.0));
        let odds = |one: &Weighed| decision::LAW_ODDS * (one.evidence - most).exp();
        let all: f64 = (-most).exp() + judged.iter().map(|(_, one)| odds(one)).sum::<f64>();
        let with = |(one, weighed): (Judged, Weighed)| {
            let probability = odds(&weighed) / all;
            Judged { weighed: Some(Weighed { probability, ..weighed }), ..one }
        };
        judged.into_iter().map(with).collect()
    }

    /// Fits the candidates that are not refused in free run, the first first, until one makes less
    /// of the validation data unexplained: the last word is that of the error. Where the motion
    /// hides what drives it, in a closed loop, that is the error of the torque.
    fn fit_first(&self, ground: &Ground, judged: &mut [Judged]) {
        let seen = |_| self.watch.stopped();
        let (estimation, validation) = (self.estimation, self.validation);
        let left = |drive: &Drive| unexplained(drive, validation)[0].map(|it| it.rms);
        let before = left(&ground.scene.drive);
        for one in judged.iter_mut().filter(|one| one.refused.is_none()) {
            let drive = one.model.fitted.drive.clone();
            let setting = finer(&self.model.setting, &drive);
            let fit = |drive: &Drive, options: Options| {
                Model::fit(drive, estimation, validation, setting, &options, &seen)
            };
            let near = Options { worth_a_step: NEAR_ENOUGH, ..Options::NEAR };
            // The minimum of the free run may lie on the side of the base's own values.
            let beside = self.beside(one);
            let fitted = self.all[one.candidate].info.knocks;
            let begins = if fitted { vec![&drive] } else { vec![&drive, &beside] };
            let ends = begins.into_par_iter().filter_map(|begin| fit(begin, near).ok());
            let sum = |model: &Model| model.fitted.squares.sum;
            let Some(model) = ends.min_by(|a, b| sum(a).total_cmp(&sum(b))) else {
                one.refused = Some("no fit with it ends".to_owned());
                continue;
            };
            let error = model.validation.squares.error();
            one.model = model;
            if error <= (1.0 - FALLS) * self.model.validation.squares.error() {
                break;
            }
            let falls = before
                .zip(left(&drive))
                .is_some_and(|(before, after)| after < (1.0 - FALLS) * before);
            if let (true, Ok(model)) = (falls, fit(&drive, Options { steps: 0, ..Options::NEAR })) {
                one.model = model;
                if let Some(weighed) = &mut one.weighed {
                    weighed.by_balance = true;
                }
                break;
            }
            one.refused = Some("the error on the validation data does not fall".to_owned());
        }
    }

    /// The drive of the round with the candidate as it was fitted.
    fn beside(&self, one: &Judged) -> Drive {
        let id = &self.all[one.candidate].id;
        let with = &one.model.fitted.drive;
        let mut beside = self.model.fitted.drive.clone();
        beside.effects.extend(with.effects.iter().filter(|effect| effect.id == *id).cloned());
        beside.fixed.clone_from(&with.fixed);
        beside
    }

    /// Puts the simplest of those that pass and are not told from the best of them before it.
    fn simplest_of_equal(&self, judged: &mut [Judged]) {
        let Some(best) = judged.iter().position(|one| one.refused.is_none()) else { return };
        let parameters = |one: &Judged| self.all[one.candidate].parameters().len();
        let info = |one: &Judged| self.all[one.candidate].info;
        let close = |one: &Judged| {
            let less = evidence(&judged[best]) - evidence(one);
            let instead = info(&judged[best]).excludes.contains(&info(one).id);
            let nested = if instead { decision::NESTED * evidence(&judged[best]) } else { 0.0 };
            one.refused.is_none() && less < decision::CONFUSED.max(nested)
        };
        let simplest = (best..judged.len())
            .filter(|k| close(&judged[*k]))
            .min_by_key(|k| parameters(&judged[*k]));
        if let Some(simplest) = simplest {
            judged[best..=simplest].rotate_right(1);
        }
    }

    /// Whether something was named before of another kind.
    fn is_further(&self, one: &Judged) -> bool {
        let candidate = &self.all[one.candidate];
        !self.named.is_empty() && !self.is_named(candidate) && !self.refines(candidate)
    }

    /// Why the candidate is not named.
    fn unconvincing(&self, one: &Judged, curve: Option<&CurveWeight>) -> Option<String> {
        let it = one.weighed?;
        let (evidence, size) = self.asked(self.is_further(one));
        let share = curve.map_or(1.0, |curve| {
            (it.evidence - it.repeats) / curve.evidence.max(f64::MIN_POSITIVE)
        });
        if it.evidence + decision::LAW_ODDS.ln() <= evidence {
            Some(format!("its evidence is {:.1} only, and {evidence} is asked for", it.evidence))
        } else if it.repeats <= 0.0 {
            Some(self.why_not_repeated(one))
        } else if it.size < size {
            let (is, asked) = (100.0 * it.size, 100.0 * size);
            Some(format!("it makes {is:.1} % of the balance only, and {asked} % are asked for"))
        } else if share < decision::SHARE {
            let share = 100.0 * share;
            Some(format!("it has {share:.0} % of the evidence of a free curve"))
        } else {
            None
        }
    }

    /// Evidence and size that are asked for.
    fn asked(&self, further: bool) -> (f64, f64) {
        if further {
            (decision::FURTHER_EVIDENCE, decision::FURTHER_SIZE)
        } else {
            (decision::EVIDENCE, decision::SIZE)
        }
    }

    /// Whether a curve shows that something is missing.
    fn stands(&self, curve: &CurveWeight) -> bool {
        let (evidence, size) = self.asked(!self.named.is_empty());
        curve.evidence + decision::CURVE_ODDS.ln() > evidence
            && curve.repeats > 0.0
            && curve.size >= size
    }
}

/// Whether the recordings tell a law from the base.
fn told(it: &LawWeight) -> bool {
    it.finite && !it.imitated && it.evidence > PROMISING
}

fn evidence(one: &Judged) -> f64 {
    one.weighed.map_or(f64::NEG_INFINITY, |it| it.evidence)
}

impl Judged {
    /// What the other rule counts, from the evidence.
    fn weighed(candidate: usize, it: &Candidate, model: Model, weighed: &Weighed) -> Self {
        Self {
            candidate,
            model,
            of_law: it.parameters().len(),
            delta_bic: 2.0 * weighed.evidence,
            // Under the base, evidence beyond that is at most so probable (Ville, 1939).
            p_value: (-weighed.evidence).exp().min(1.0),
            validation_gain: 2.0 * weighed.repeats,
            plain: None,
            shape: None,
            by_inverse: None,
            change: Vec::new(),
            weighed: None,
            refused: None,
        }
    }
}
