//! One round of the loop: screen, refit, judge by the gates.

use rayon::prelude::*;

use super::candidates::Candidate;
use super::columns::{At, Columns};
use super::gates;
use super::left::{Left, blocks};
use super::projection::Projection;
use super::refined::{Refined, whitener};
use super::refit::{Model, p_value, refit, squared};
use super::report::{Coefficient, Ranked, Step, Watch};
use super::scales::Scales;
use super::screen::{Screened, screen};
use super::whiten::Whitener;
use crate::estimate::Evidence;

/// A refitted candidate with what its gates say.
pub(crate) struct Judged {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// The drive with it.
    pub(crate) model: Model,
    /// Parameters of the law: how rich it is.
    of_law: usize,
    delta_bic: f64,
    p_value: f64,
    validation_gain: f64,
    shape: Option<f64>,
    /// What it changes in the innovations.
    change: Vec<f64>,
    /// Why it is not named.
    pub(crate) refused: Option<String>,
}

/// What a round has to go on.
pub(crate) struct Round<'a> {
    pub(crate) model: &'a Model,
    /// The base of the whole loop.
    pub(crate) first: &'a Model,
    pub(crate) all: &'a [Candidate],
    pub(crate) scales: &'a Scales,
    pub(crate) estimation: &'a Evidence,
    pub(crate) validation: &'a Evidence,
    pub(crate) watch: &'a dyn Watch,
    /// Squared error of a perfect model.
    pub(crate) floor: f64,
    /// Kinds that were named before.
    pub(crate) named: &'a [String],
}

/// What a round found.
pub(crate) struct Outcome {
    /// Refitted candidates, best first.
    pub(crate) judged: Vec<Judged>,
    /// Candidates that the base parameters imitate.
    pub(crate) imitated: Vec<usize>,
    /// What curves could remove of the round's own base; where a candidate passes every gate in
    /// a later round it is not asked.
    pub(crate) left: Option<Left>,
    /// Whether a candidate explains much, but has the wrong shape.
    pub(crate) misshapen: bool,
}

impl Round<'_> {
    /// Screens, refits and judges.
    pub(crate) fn run(&self) -> Outcome {
        let at = self.model.at(self.estimation);
        let base = Columns::base(&at, &self.model.names());
        let projection = Projection::new(base.columns.clone(), &base.residual);
        self.watch.step(&Step::Doing("screening the library"));
        let stopped = || self.watch.stopped();
        let screened = screen(&at, &projection, self.all, &stopped);
        let imitated =
            screened.iter().filter(|one| one.is_imitated()).map(|one| one.candidate).collect();
        self.watch.step(&Step::Doing("fitting the best candidates"));
        let mut judged = self.refitted(&screened);
        self.watch.step(&Step::Doing("comparing with curves"));
        simplest_first(&mut judged);
        let mut misshapen = false;
        if let Some(best) = judged.iter().position(|one| one.refused.is_none()) {
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
        let wanted = !passes || self.named.is_empty();
        let left = wanted.then(|| self.left(&at, &base));
        Outcome { judged, imitated, left, misshapen }
    }

    /// Gain in BIC of the first candidate.
    pub(crate) fn gain_of_first(&self) -> f64 {
        let at = self.model.at(self.estimation);
        let base = Columns::base(&at, &self.model.names());
        let projection = Projection::new(base.columns.clone(), &base.residual);
        let screened = screen(&at, &projection, self.all, &|| self.watch.stopped());
        self.refitted(&screened).first().map_or(0.0, |one| one.delta_bic)
    }

    /// What curves could remove of the round's own base.
    fn left(&self, at: &At<'_>, base: &Columns) -> Left {
        let other = self.model.at_validation(self.validation);
        let stopped = || self.watch.stopped();
        Left::of(at, base, &self.model.names(), &other, self.scales, &stopped)
    }

    /// The promising ones, fitted, with their gains in the innovations of the best of them.
    fn refitted(&self, screened: &[Screened]) -> Vec<Judged> {
        let promising: Vec<&Screened> =
            screened.iter().filter(|one| one.worth > 0.0).take(gates::REFITTED).collect();
        let fit = |one: &&Screened| {
            let candidate = &self.all[one.candidate];
            // One that diverges is out; the rest goes on.
            let model = refit(self.model, candidate, one, self.estimation, self.validation);
            Some((one.candidate, model.ok()?))
        };
        let models: Vec<(usize, Model)> = if self.watch.stopped() {
            vec![]
        } else {
            promising.par_iter().filter_map(fit).collect()
        };
        let sum = |model: &Model| model.fitted.squares.sum;
        let best = models.iter().min_by(|a, b| sum(&a.1).total_cmp(&sum(&b.1)));
        let Some((_, best)) = best else { return Vec::new() };
        let whitener = whitener(&best.at(self.estimation));
        let before = self.refined(self.model, &whitener);
        let hypotheses: usize = self.all.iter().map(|it| it.variants.len()).sum();
        let judge = |(candidate, model): (usize, Model)| {
            let after = self.refined(&model, &whitener);
            let of_base = self.model.fitted.parameters.len();
            let searched = usize::from(!self.all[candidate].frozen.is_empty());
            let k = model.fitted.parameters.len().saturating_sub(of_base).max(1) + searched;
            let gain = squared(&before.estimation) - squared(&after.estimation);
            let block = blocks(self.estimation, model.fitted.block_s);
            let (places, values) = (&after.places, after.estimation.len() as f64);
            let chance = p_value(places, &before.estimation, &after.estimation, k, block);
            let mut one = Judged {
                candidate,
                of_law: self.all[candidate].entry.parameters.len(),
                delta_bic: gain - k as f64 * values.ln(),
                p_value: (chance * hypotheses as f64).min(1.0),
                validation_gain: squared(&before.validation) - squared(&after.validation),
                shape: None,
                change: difference(&before.estimation, &after.estimation),
                refused: None,
                model,
            };
            one.refused = self.refusal(&one);
            one
        };
        let mut judged: Vec<Judged> = models.into_par_iter().map(judge).collect();
        judged.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
        judged
    }

    fn refined(&self, model: &Model, whitener: &Whitener) -> Refined {
        Refined::of(model, self.estimation, self.validation, whitener)
    }

    /// Why the candidate is not named, whatever its shape.
    fn refusal(&self, one: &Judged) -> Option<String> {
        let removed = self.model.fitted.squares.sum - one.model.fitted.squares.sum;
        let excess = self.first.fitted.squares.sum - self.floor;
        let kind = self.all[one.candidate].entry.info.id;
        // A harmonic of what was named is no other effect.
        let further = !self.named.is_empty() && !self.named.iter().any(|named| named == kind);
        if one.delta_bic <= gates::DELTA_BIC {
            Some(format!("BIC gains {:.1} only", one.delta_bic))
        } else if one.validation_gain <= 0.0 {
            Some(self.why_not_repeated(one))
        } else if one.p_value >= gates::P_VALUE {
            Some(format!("it may be chance: p = {:.2}", one.p_value))
        } else if further && removed < gates::FURTHER * excess {
            Some("it removes no more than the formula of a named law may leave".to_owned())
        } else {
            None
        }
    }

    /// Why the validation data do not bear the candidate out.
    fn why_not_repeated(&self, one: &Judged) -> String {
        match super::phase::turned(&one.model, &self.all[one.candidate], self.validation) {
            Some(turn) => format!(
                "its phase changes from recording to recording (by {turn:.0} degrees): it does \
                 not belong to the machine"
            ),
            None => "the error on the validation data does not fall".to_owned(),
        }
    }

    /// Why the law has not the shape of what is missing; measures it.
    fn misshapen(&self, one: &mut Judged) -> Option<String> {
        let at = one.model.at(self.estimation);
        let names = one.model.names();
        let base = Columns::base(&at, &names);
        let other = one.model.at_validation(self.validation);
        let stopped = || self.watch.stopped();
        let left = Left::of(&at, &base, &names, &other, self.scales, &stopped);
        // In the same innovations as the curves.
        let [before, after] =
            [self.model, &one.model].map(|model| self.refined(model, &left.whitener).estimation);
        let gain = squared(&before) - squared(&after);
        let variables = self.all[one.candidate].entry.info.fails_over;
        let share = |own: bool| {
            let counts = |rest: &&super::left::Rest| {
                !own || rest.curve.variables().iter().any(|it| variables.contains(it))
            };
            let rests = left.worthy().filter(counts).map(|rest| rest.gain);
            let rest = rests.fold(0.0_f64, f64::max);
            if gain > 0.0 { gain / (gain + rest) } else { 0.0 }
        };
        let (own, any) = (share(true), share(false));
        one.shape = Some(own);
        if own < gates::SHAPE {
            let share = 100.0 * own;
            return Some(format!("it has {share:.0} % of what it and a curve of its kind remove"));
        }
        let share = 100.0 * any;
        (any < gates::MAIN)
            .then(|| format!("it has {share:.0} % of what it and another curve remove"))
    }

    /// The line of a candidate in the ranking.
    pub(crate) fn ranked(&self, one: &Judged, all: &[Judged]) -> Ranked {
        let excess = (self.model.fitted.squares.sum - self.floor).max(f64::MIN_POSITIVE);
        let removed = self.model.fitted.squares.sum - one.model.fitted.squares.sum;
        let own = format!("{}.", self.all[one.candidate].id);
        let parameters = one.model.fitted.parameters.iter();
        let parameters = parameters.filter(|it| it.name.starts_with(&own));
        let parameters = parameters
            .map(|it| (it.name.clone(), Coefficient { value: it.value, std_error: it.std_error }));
        Ranked {
            effect: self.all[one.candidate].entry.info.id.to_owned(),
            confusion_set: self.confusion_set(one, all),
            delta_bic: one.delta_bic,
            p_value: one.p_value,
            excess_removed: (removed / excess).clamp(0.0, 1.0),
            validation_gain: one.validation_gain,
            shape: one.shape,
            parameters: parameters.collect(),
            refused: one.refused.clone(),
        }
    }

    /// What the recordings do not tell from it: laws that gain as much, and laws that are
    /// sometimes equal by algebra and change the same here.
    pub(crate) fn confusion_set(&self, one: &Judged, all: &[Judged]) -> Vec<String> {
        let info = self.all[one.candidate].entry.info;
        let alike = |other: &&Judged| {
            let id = self.all[other.candidate].entry.info.id;
            let close = (one.delta_bic - other.delta_bic).abs() < gates::CLOSE;
            let cosine = cosine(&one.change, &other.change);
            let by_algebra = info.aliases.contains(&id) && cosine > gates::ALIKE;
            id != info.id && other.delta_bic > gates::DELTA_BIC && (close || by_algebra)
        };
        let others = all.iter().filter(alike);
        others.map(|other| self.all[other.candidate].entry.info.id.to_owned()).collect()
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    dot / (squared(a) * squared(b)).sqrt()
}

/// Puts the simplest of those that pass and gain as much as the best of them before it: what a
/// richer law gains by less than [`gates::CLOSE`] is no evidence for its riches.
fn simplest_first(judged: &mut [Judged]) {
    let Some(best) = judged.iter().position(|one| one.refused.is_none()) else { return };
    let close = |one: &Judged| {
        one.refused.is_none() && judged[best].delta_bic - one.delta_bic < gates::CLOSE
    };
    let simplest =
        (best..judged.len()).filter(|k| close(&judged[*k])).min_by_key(|k| judged[*k].of_law);
    if let Some(simplest) = simplest {
        judged[best..=simplest].rotate_right(1);
    }
}
