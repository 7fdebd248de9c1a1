//! What the gates of [`super::gates`] say of a refitted candidate: in innovations, in the errors
//! as they are, and of its shape.

use rayon::prelude::*;

use super::columns::{Columns, Place};
use super::gates;
use super::inverse::ByInverse;
use super::left::{Rest, blocks};
use super::refined::Refined;
use super::refit::{Model, p_value, squared};
use super::round::Round;
use super::weighed::Weighed;
use super::whiten::Whitener;

/// A refitted candidate with what its gates say.
pub(crate) struct Judged {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// The drive with it.
    pub(crate) model: Model,
    /// Parameters of the law: how rich it is.
    pub(super) of_law: usize,
    pub(super) delta_bic: f64,
    pub(super) p_value: f64,
    pub(super) validation_gain: f64,
    /// Squared error that goes, where it was judged by the errors as they are.
    pub(super) plain: Option<f64>,
    pub(super) shape: Option<f64>,
    /// What the inverse form says of it, in the first round.
    pub(super) by_inverse: Option<ByInverse>,
    /// What it changes in the innovations.
    pub(super) change: Vec<f64>,
    /// By the rule of evidence.
    pub(super) weighed: Option<Weighed>,
    /// Why it is not named.
    pub(crate) refused: Option<String>,
}

/// What a candidate does to the errors as they are.
struct Plain {
    /// Squared error that goes.
    gain: f64,
    delta_bic: f64,
    p_value: f64,
    validation_gain: f64,
    /// Share of the excess that goes, on the data where it is less.
    removed: f64,
}

impl Plain {
    fn stands(&self) -> bool {
        self.delta_bic > gates::DELTA_BIC
            && self.p_value < gates::P_VALUE
            && self.removed >= gates::PLAIN
    }
}

impl Round<'_> {
    /// What the gates say of fitted candidates, best first.
    pub(super) fn judged(&self, models: Vec<(usize, Model)>) -> Vec<Judged> {
        let sum = |model: &Model| model.fitted.squares.sum;
        let best = models.iter().min_by(|a, b| sum(&a.1).total_cmp(&sum(&b.1)));
        let Some((_, best)) = best else { return Vec::new() };
        let rows = Columns::residuals(&best.at(self.estimation));
        let whitener = Whitener::of(&rows.places, &rows.residual);
        let before = Refined::of(&self.sight, &self.validation_sight, &whitener);
        let hypotheses: usize = self.all.iter().map(|it| it.variants.len()).sum();
        let remembers = whitener.unforeseen() < gates::REMEMBERS;
        let inverse = self.sight.inverse().filter(|_| self.named.is_empty());
        let inverse = inverse.map(|inverse| (inverse, inverse.left_by(&self.sight)));
        let judge = |(candidate, model): (usize, Model)| {
            let sight = model.sight(self.estimation);
            let validation_sight = model.validation_sight(self.validation);
            let after = Refined::of(&sight, &validation_sight, &whitener);
            let of_base = self.model.fitted.parameters.len();
            let searched = usize::from(!self.all[candidate].frozen.is_empty());
            let k = model.fitted.parameters.len().saturating_sub(of_base).max(1) + searched;
            let gain = squared(&before.estimation) - squared(&after.estimation);
            let block = blocks(self.estimation, model.fitted.block_s);
            let values = after.estimation.len() as f64;
            let columns = sight.columns();
            let chance = p_value(&columns.places, &before.estimation, &after.estimation, k, &block);
            let plain = remembers.then(|| self.plain(&model, columns, k, hypotheses));
            let by_inverse = inverse.as_ref().map(|(inverse, was)| {
                let is = inverse.left_by(&sight);
                let counted = counted(&columns.places, &block);
                let chance = p_value(&columns.places, was, &is, k, &block);
                ByInverse {
                    delta_bic: delta_bic(squared(was), squared(&is), counted, k),
                    p_value: (chance * hypotheses as f64).min(1.0),
                }
            });
            let mut one = Judged {
                candidate,
                plain: None,
                by_inverse,
                of_law: self.all[candidate].parameters().len(),
                delta_bic: gain - k as f64 * values.ln(),
                p_value: (chance * hypotheses as f64).min(1.0),
                validation_gain: squared(&before.validation) - squared(&after.validation),
                shape: None,
                change: difference(&before.estimation, &after.estimation),
                weighed: None,
                refused: None,
                model,
            };
            one.refused = self.refusal(&one);
            let stands = plain.filter(|plain| one.refused.is_some() && plain.stands());
            if let Some(plain) = stands {
                (one.delta_bic, one.p_value) = (plain.delta_bic, plain.p_value);
                (one.validation_gain, one.refused) = (plain.validation_gain, None);
                one.plain = Some(plain.gain);
            }
            one
        };
        let mut judged: Vec<Judged> = models.into_par_iter().map(judge).collect();
        let order = |one: &Judged| one.plain.unwrap_or(one.delta_bic);
        judged.sort_by(|a, b| order(b).total_cmp(&order(a)));
        judged
    }

    /// What the candidate does to the errors as they are: the residual of a drive that keeps much
    /// unexplained foretells itself, and what is missing with it, so that its innovations show
    /// ripples and no friction. Blocks count as the independent values, and both recordings must
    /// agree that much goes.
    fn plain(&self, model: &Model, seen: &Columns, k: usize, hypotheses: usize) -> Plain {
        let (before, after) = (self.sight.columns(), &seen.residual);
        let block = blocks(self.estimation, model.fitted.block_s);
        let counted = counted(&before.places, &block);
        let (was, is) = (squared(&before.residual), squared(after));
        let chance = p_value(&before.places, &before.residual, after, k, &block);
        let validation = |of: &Model| of.validation.squares.sum;
        let excess = |sum: f64, floor: f64| (sum - floor).max(f64::MIN_POSITIVE);
        let validation_gain = validation(self.model) - validation(model);
        let validation_excess = excess(validation(self.model), self.validation_floor);
        Plain {
            gain: was - is,
            delta_bic: delta_bic(was, is, counted, k),
            p_value: (chance * hypotheses as f64).min(1.0),
            validation_gain,
            removed: ((was - is) / excess(was, self.floor))
                .min(validation_gain / validation_excess),
        }
    }

    /// Why the candidate is not named, whatever its shape.
    fn refusal(&self, one: &Judged) -> Option<String> {
        let removed = self.model.fitted.squares.sum - one.model.fitted.squares.sum;
        let candidate = &self.all[one.candidate];
        let further = !self.is_named(candidate) && !self.refines(candidate);
        if one.delta_bic <= gates::DELTA_BIC {
            Some(format!("BIC gains {:.1} only", one.delta_bic))
        } else if one.validation_gain <= 0.0 {
            Some(self.why_not_repeated(one))
        } else if one.p_value >= gates::P_VALUE {
            Some(format!("it may be chance: p = {:.2}", one.p_value))
        } else if further && removed < self.needed(candidate) {
            Some("it removes no more than the formula of a named law may leave".to_owned())
        } else {
            None
        }
    }

    /// Why the validation data do not bear the candidate out.
    pub(super) fn why_not_repeated(&self, one: &Judged) -> String {
        match super::phase::turned(&one.model, &self.all[one.candidate], self.validation) {
            Some(turn) => format!(
                "its phase changes from recording to recording (by {turn:.0} degrees): it does \
                 not belong to the machine"
            ),
            None => "the error on the validation data does not fall".to_owned(),
        }
    }

    /// Why the law has not the shape of what is missing; measures it.
    pub(super) fn misshapen(&self, one: &mut Judged) -> Option<String> {
        let sight = one.model.sight(self.estimation);
        let validation_sight = one.model.validation_sight(self.validation);
        let left = self.left(&sight, &validation_sight);
        // In the same innovations as the curves.
        let gain = one.plain.unwrap_or_else(|| {
            let of = |sight, validation| {
                squared(&Refined::of(sight, validation, &left.whitener).estimation)
            };
            of(&self.sight, &self.validation_sight) - of(&sight, &validation_sight)
        });
        let base = sight.columns();
        // Of errors that remember, chance removes what a block holds, a hat.
        let counted = counted(&base.places, blocks(self.estimation, one.model.fitted.block_s));
        let by_chance = squared(&base.residual) / counted;
        let rests: Vec<(&Rest, f64)> = match one.plain {
            Some(_) => {
                let of = |rest: &Rest| rest.removed - rest.rank as f64 * by_chance;
                left.rests.iter().map(|rest| (rest, of(rest))).collect()
            }
            None => left.worthy(self.floor).map(|rest| (rest, rest.gain)).collect(),
        };
        let variables = &self.all[one.candidate].fails_over;
        let is_own = |rest: &Rest| rest.curve.variables().iter().any(|it| variables.contains(it));
        let most = |own: bool| {
            let some = rests.iter().filter(|(rest, _)| is_own(rest) == own);
            some.map(|(_, gain)| *gain).fold(0.0_f64, f64::max)
        };
        let (own, other) = (most(true), most(false));
        let share = |rest: f64| if gain > 0.0 { gain / (gain + rest) } else { 0.0 };
        let shape = share(own);
        one.shape = Some(shape);
        // What shows best over other variables is another effect: a curve over its own ones holds
        // a constant too, and takes a part of it.
        if shape < gates::SHAPE && own >= other {
            let share = 100.0 * shape;
            return Some(format!("it has {share:.0} % of what it and a curve of its kind remove"));
        }
        let any = share(own.max(other));
        (any < gates::MAIN).then(|| {
            let share = 100.0 * any;
            format!("it has {share:.0} % of what it and another curve remove")
        })
    }
}

/// Blocks in which something was measured.
fn counted(places: &[Place], block: impl Fn(&Place) -> usize) -> f64 {
    let mut blocks: Vec<usize> = places.iter().map(block).collect();
    blocks.dedup();
    blocks.len() as f64
}

/// Gain in BIC from one squared error to the next, over `counted` independent values, for `k`
/// parameters more.
fn delta_bic(was: f64, is: f64, counted: f64, k: usize) -> f64 {
    counted * (was / is).ln() - k as f64 * counted.ln()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
