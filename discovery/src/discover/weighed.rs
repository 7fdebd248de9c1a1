//! A round by the rule of evidence: weigh everything beside the drive, fit what is promising, decide
//! by the numbers of [`super::decision`].

use drivescope_plant::effects::law::Variable;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::curves::Curve;
use super::decision;
use super::judge::Judged;
use super::refit::Model;
use super::report::Step;
use super::round::{Outcome, Round};
use super::screen::Screened;
use crate::likelihood::{
    CurveWeight, Law, LawWeight, Optimum, Randomness, References, Scene, Weights, optimum, weigh,
};

/// Sizes of the random load, over that of the base, with which a structure is judged at its best:
/// the load may have taken what a law explains.
const LOADS: [f64; 3] = [1.0, 0.3, 0.05];
/// ln of the evidence at its null from which on a law is fitted.
const PROMISING: f64 = 2.0;
/// Further shapes from which a law without a derivative at its null is fitted.
const OTHERS: usize = 4;
/// Factor by which the error on the validation data may seem to rise by chance.
const RISES: f64 = 1.001;

/// The evidence of a fitted candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weighed {
    /// ln of it over that of the base.
    evidence: f64,
    /// The same of the recordings held out, given the others, and the other way round.
    repeats: f64,
    back: f64,
    /// Root of the mean square of what it does, of what the balance holds.
    pub(crate) size: f64,
    /// That it is what is missing, among the candidates and nothing.
    pub(crate) probability: f64,
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

/// The base of a round, as evidence is counted from it.
struct Ground<'a> {
    scene: Scene<'a>,
    randomness: Randomness,
    references: References,
    /// Evidence of the base at its best.
    base: Optimum,
    /// The same with the load as it was estimated.
    plain: Optimum,
}

impl Round<'_> {
    /// Weighs, refits and decides.
    pub(crate) fn weighed(&self) -> Outcome {
        self.watch.step(&Step::Doing("filtering the recordings"));
        let Some(ground) = self.ground() else { return Outcome::default() };
        self.watch.step(&Step::Doing("weighing the library"));
        let Some(weights) = self.weights(&ground) else { return Outcome::default() };
        let of = |wanted: fn(&LawWeight) -> bool| {
            weights.laws.iter().filter(|it| wanted(it)).map(|it| it.candidate).collect()
        };
        let imitated = of(|it| it.finite && it.imitated);
        let overflowing = of(|it| !it.finite);
        self.watch.step(&Step::Doing("fitting the best candidates"));
        let mut judged = self.by_evidence(&ground, self.promising(&weights));
        let curve = self.curve(&ground, weights.curves);
        for one in &mut judged {
            one.refused = self.unconvincing(one, curve.as_ref());
        }
        self.simplest_of_equal(&mut judged);
        let nothing = judged.iter().all(|one| one.refused.is_some());
        let misshapen = nothing && curve.is_some_and(|curve| self.stands(&curve));
        let left = misshapen.then(|| {
            self.watch.step(&Step::Doing("drawing what nobody knows"));
            self.left(&self.sight, &self.validation_sight)
        });
        Outcome { judged, imitated, overflowing, alike: Vec::new(), left, misshapen }
    }

    fn ground(&self) -> Option<Ground<'_>> {
        let scene = Scene::of(self.model, self.estimation, self.validation);
        let (randomness, references) = Randomness::of(&scene)?;
        let plain = optimum(&scene, None, &randomness, &references)?;
        let base = at_its_best(&scene, None, &randomness, &references)?;
        Some(Ground { scene, randomness, references, base, plain })
    }

    fn weights(&self, ground: &Ground<'_>) -> Option<Weights> {
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

    /// The promising ones, fitted: the most probable; what excludes the best of them, for only fits
    /// tell which it is; and laws without a derivative at their null where a curve shows something
    /// over their variables.
    fn promising(&self, weights: &Weights) -> Vec<(usize, Model)> {
        let told = |it: &&LawWeight| it.finite && !it.imitated && it.evidence > PROMISING;
        let mut promising: Vec<&LawWeight> = weights.laws.iter().filter(told).collect();
        let best = promising.first().map(|it| self.all[it.candidate].info);
        promising.truncate(decision::REFITTED);
        let instead = |it: &&LawWeight| {
            best.is_some_and(|best| best.excludes.contains(&self.all[it.candidate].info.id))
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
        let beside =
            |it: &&LawWeight| instead(it) || (!self.all[it.candidate].is_linear() && shown(it));
        let beside: Vec<&LawWeight> = weights.laws.iter().filter(beside).collect();
        for one in beside {
            if promising.iter().all(|it| it.candidate != one.candidate) {
                promising.push(one);
            }
        }
        let begins: Vec<Screened> = promising.into_iter().map(begin).collect();
        self.models(&begins.iter().collect::<Vec<_>>())
    }

    /// Evidence of fitted candidates, most probable first.
    fn by_evidence(&self, ground: &Ground<'_>, models: Vec<(usize, Model)>) -> Vec<Judged> {
        let judge = |(candidate, model): (usize, Model)| {
            let it = &self.all[candidate];
            let law = Law { id: &it.id, coefficients: &it.coefficients };
            let scene = Scene::of(&model, self.estimation, self.validation);
            let own = at_its_best(&scene, Some(&law), &ground.randomness, &ground.references)?;
            let evidence = own.fitted - ground.base.fitted;
            let all = own.all - ground.base.all;
            let weighed = Weighed {
                evidence,
                repeats: all - evidence,
                back: all - (own.held_out - ground.base.held_out),
                size: own.size,
                probability: 0.0,
            };
            Some((Judged::weighed(candidate, it, model, &weighed), weighed))
        };
        let mut judged: Vec<(Judged, Weighed)> = models.into_par_iter().filter_map(judge).collect();
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

    /// The most telling curve, its evidence counted from the base at its best.
    fn curve(&self, ground: &Ground<'_>, curves: Vec<CurveWeight>) -> Option<CurveWeight> {
        let less = ground.base.fitted - ground.plain.fitted;
        let best = curves.into_iter().find(|curve| curve.repeats > 0.0)?;
        Some(CurveWeight { evidence: best.evidence - less, ..best })
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
        let before = self.model.validation.squares.error();
        let after = one.model.validation.squares.error();
        let share = curve.map_or(1.0, |curve| it.evidence / curve.evidence.max(f64::MIN_POSITIVE));
        if it.evidence + decision::LAW_ODDS.ln() <= evidence {
            Some(format!("its evidence is {:.1} only, and {evidence} is asked for", it.evidence))
        } else if it.repeats <= 0.0 || it.back <= 0.0 {
            Some(self.why_not_repeated(one))
        } else if it.size < size {
            let (is, asked) = (100.0 * it.size, 100.0 * size);
            Some(format!("it makes {is:.1} % of the balance only, and {asked} % are asked for"))
        } else if after > RISES * before {
            Some("the error on the validation data rises with it".to_owned())
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

fn evidence(one: &Judged) -> f64 {
    one.weighed.map_or(f64::NEG_INFINITY, |it| it.evidence)
}

/// Where a refit begins.
fn begin(weight: &LawWeight) -> Screened {
    let others = weight.variants.iter().copied().skip(1).take(OTHERS);
    let linear = !weight.coefficients.is_empty();
    Screened {
        candidate: weight.candidate,
        variant: weight.variants[0],
        others: if linear { Vec::new() } else { others.collect() },
        coefficients: weight.coefficients.clone(),
        gain: 2.0 * weight.evidence,
        worth: 2.0 * weight.evidence,
        stands_out: 1.0,
    }
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

/// The evidence of a structure with the random load with which it is most probable.
fn at_its_best(
    scene: &Scene<'_>,
    law: Option<&Law<'_>>,
    randomness: &Randomness,
    references: &References,
) -> Option<Optimum> {
    let each = LOADS
        .par_iter()
        .filter_map(|load| optimum(scene, law, &randomness.scaled(*load), references));
    each.max_by(|a, b| a.fitted.total_cmp(&b.fitted))
}
