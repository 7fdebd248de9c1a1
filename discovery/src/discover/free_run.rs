//! The last word on a candidate: whether the error on the validation data falls with it.

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::law::Variable;
use rayon::prelude::*;

use super::ground::Ground;
use super::judged::Judged;
use super::learned::effect;
use super::refit::{Model, refit, with_learned};
use super::round::Round;
use crate::estimate::{Evidence, Options};
use crate::likelihood::{CurveWeight, LawWeight};
use crate::measured::Measured;

/// Share of the error on the validation data that must at least be left out, so that it falls.
pub(super) const FALLS: f64 = 1e-3;
/// Squared error over that of a perfect model up to which nothing is left: 1 % of the error.
const AT_FLOOR: f64 = 1.02;
/// Squared error over the floor below which the noise was taken for larger than it is: estimates of it
/// scatter by less than a tenth.
const BELOW_FLOOR: f64 = 0.8;

/// Why the error does not fall with a candidate: nothing could be fitted, or it does not with the fit.
enum NotLower {
    NoFit(&'static str),
    Fitted(String),
}

impl Round<'_> {
    /// Fits the candidates that are not refused in free run, the first first, until one makes less
    /// of the validation data unexplained: the last word is that of the error. Where the motion
    /// hides what drives it, in a closed loop or behind an observer, that is the error of the torque.
    /// One that was found to lower it before, among fewer, still does.
    pub(super) fn fit_first(&self, ground: &Ground, judged: &mut [Judged]) {
        let left = (self.torque_left(ground.drive()), self.left(&self.model.fitted.drive));
        // What is far less probable than one over the same variables that does not lower the error is
        // no name for it.
        let mut failed: Vec<(&[Variable], f64)> = Vec::new();
        for one in judged.iter_mut().filter(|one| one.refused.is_none()) {
            if one.lowers {
                break;
            }
            let candidate = &self.all[one.candidate];
            let over = |it: &Variable| candidate.fails_over.contains(it);
            let less = |least: f64| one.weighed.evidence < least;
            if failed.iter().any(|(variables, least)| less(*least) && variables.iter().any(over)) {
                one.refused = Some("a better one does not lower the error".to_owned());
                continue;
            }
            match self.fitted_lowers(ground, left, one) {
                Ok(()) if self.stands_apart(one) => {
                    one.lowers = true;
                    break;
                }
                Ok(()) => {}
                Err(NotLower::NoFit(why)) => one.refused = Some(why.to_owned()),
                Err(NotLower::Fitted(why)) => {
                    one.refused = Some(why);
                    // Of what stands for dry friction the filter knows too little at each reversal.
                    if !candidate.info.replaces_dry {
                        let least = self.rule.share * one.weighed.evidence;
                        failed.push((&candidate.fails_over, least));
                    }
                }
            }
        }
    }

    /// Fits a candidate and keeps the model; `Err` where the error does not fall with it. The drive of the
    /// ground and that of the round leave so much torque unexplained.
    fn fitted_lowers(
        &self,
        ground: &Ground,
        (of_ground, of_round): (Option<f64>, [Option<f64>; 2]),
        one: &mut Judged,
    ) -> Result<(), NotLower> {
        let candidate = &self.all[one.candidate];
        let drive = one.model.fitted.drive.clone();
        let both = of_ground.zip(self.torque_left(&drive));
        let error = |model: &Model| model.validation.squares.error();
        let was = error(self.model);
        let (_, size) = self.asked(self.is_further(one));
        let inverse = ground.filtered().is_none();
        let little = self.takes_little(inverse, candidate, of_round, &drive);
        let unfitted = || {
            let model = little.is_none().then(|| self.as_it_is(&drive)).flatten();
            model.filter(|model| error(model) <= was)
        };
        // Where the torque was the datum, its error decides, and a fit to the motion would only
        // move the parameters away.
        if inverse
            && both.is_some_and(|(before, after)| after < before)
            && let Some(model) = unfitted()
        {
            one.model = model;
            one.weighed.by_balance = true;
            return Ok(());
        }
        // A load that moves by itself is told by the torque along the motion, and by nothing sooner.
        if inverse && candidate.has_load() {
            let why = little.unwrap_or_else(|| "the error does not fall".to_owned());
            return Err(NotLower::Fitted(why));
        }
        let model = self.in_free_run(one).ok_or(NotLower::NoFit("no fit with it ends"))?;
        if candidate.vanishes_in(&model.fitted.drive) {
            return Err(NotLower::NoFit("its fit ends where it vanishes"));
        }
        if let Some(little) = self.takes_little(inverse, candidate, of_round, &model.fitted.drive) {
            return Err(NotLower::Fitted(little));
        }
        let fits = model.fitted.squares.sum <= self.model.fitted.squares.sum;
        let falls = fits && error(&model) <= (1.0 - FALLS) * was;
        one.model = model;
        let removed = self.removed_of_validation(&one.model);
        let raises = self.law_raises_torque(candidate, of_round[0], &one.model);
        let lowers = falls && removed >= size && !raises;
        if lowers || self.explains_torque(&one.model.fitted.drive) {
            one.weighed.by_balance = !lowers;
            return Ok(());
        }
        if both.is_some_and(|(before, after)| after < (1.0 - FALLS) * before)
            && let Some(model) = unfitted()
        {
            one.model = model;
            one.weighed.by_balance = true;
            return Ok(());
        }
        let removed = 100.0 * removed;
        Err(NotLower::Fitted(if raises {
            "the torque that nothing explains rises with it".to_owned()
        } else if falls {
            format!("it takes {removed:.1} % of the excess error on the validation data away only")
        } else {
            let where_not = if fits { "on the validation data " } else { "" };
            format!("the error {where_not}does not fall")
        }))
    }

    /// A drive of the round as it is, with starts of its own.
    fn as_it_is(&self, drive: &Drive) -> Option<Model> {
        let setting = self.model.setting.of(drive);
        let unmoved = Options { steps: 0, ..Options::NEAR };
        let seen = |_| self.watch.stopped();
        Model::fit(drive, self.estimation, self.validation, setting, &unmoved, &seen).ok()
    }

    /// Names one that is small where the error falls to its floor with it: what the formulas of the
    /// base leave would stay.
    pub(super) fn fit_small(&self, judged: &mut [Judged]) {
        // Below the floor, for the noise was taken for larger than it is, anything falls to it.
        let (was, floor) = (self.model.fitted.squares.sum, self.floor(self.estimation));
        if judged.iter().any(|one| one.refused.is_none()) || was < BELOW_FLOOR * floor {
            return;
        }
        let Some(one) = judged.iter_mut().find(|one| one.weighed.small) else { return };
        // Behind an observer the error falls by other values of the base too.
        let observed = self.model.setting.observer.follows();
        if observed && !self.explains_torque(&one.model.fitted.drive) {
            return;
        }
        let Some(model) = self.in_free_run(one) else { return };
        if self.explains_all(&model) {
            one.model = model;
            one.refused = None;
        }
    }

    /// Whether the error falls to its floor, in the recordings of the fit and in those held out: but for
    /// what a formula that is right in its kind may leave.
    pub(super) fn explains_all(&self, model: &Model) -> bool {
        // Each for itself: where the noise of one was taken for too large, it makes nothing good.
        let floors = [self.estimation, self.validation].map(|evidence| self.floor(evidence));
        let excess = |it: &Model| {
            let sums = [it.fitted.squares.sum, it.validation.squares.sum];
            sums.iter().zip(floors).map(|(sum, floor)| (sum - floor).max(0.0)).sum::<f64>()
        };
        let was = excess(self.model);
        was > 0.0 && excess(model) <= self.rule.formula * was
    }

    /// Fitted in free run; nothing where no fit ends.
    pub(crate) fn in_free_run(&self, one: &Judged) -> Option<Model> {
        let drive = &one.model.fitted.drive;
        let seen = |_| self.watch.stopped();
        let fit = |drive: &Drive| self.fitted(drive);
        // The minimum of the free run may lie on the side of the base's own values.
        let beside = self.beside(one);
        let fitted = self.all[one.candidate].info.knocks;
        let starts = if fitted { vec![drive] } else { vec![drive, &beside] };
        let ends = starts.into_par_iter().filter_map(fit);
        // The filter does not see the sensors that such a law is about: all its shapes are tried.
        let it = &self.all[one.candidate];
        let shapes: Vec<usize> =
            if self.acts_beside(it) { (0..it.variants.len()).collect() } else { Vec::new() };
        let from_shapes =
            || refit(self.model, (it, &shapes), None, self.estimation, self.validation, &seen);
        let ends = ends.chain((!shapes.is_empty()).then(from_shapes).flatten());
        let sum = |model: &Model| model.fitted.squares.sum;
        ends.min_by(|a, b| sum(a).total_cmp(&sum(b)))
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

    /// With a law that the user chose, fitted from where its evidence is best, or from its shapes
    /// where the filter finds no way; nothing where no fit ends.
    pub(crate) fn added(&self, ground: &Ground, law: &LawWeight) -> Option<Model> {
        let seen = |_| self.watch.stopped();
        let best = self.at_their_best(ground, &[law]).into_iter().next();
        let by_filter = best.and_then(|one| self.in_free_run(&one));
        by_filter.or_else(|| {
            let (it, variants) = (&self.all[law.candidate], &law.variants);
            refit(self.model, (it, variants), None, self.estimation, self.validation, &seen)
        })
    }

    /// With a curve in the drive, fitted; nothing where the effect `learned` cannot hold it, or no
    /// fit ends.
    pub(crate) fn with_curve(&self, curve: &CurveWeight) -> Option<Model> {
        let seen = |_| self.watch.stopped();
        let effect = effect(&self.model.fitted.drive, curve);
        with_learned(self.model, effect, self.estimation, self.validation, &seen).ok()
    }

    /// Share of the error above the noise floor that goes with that model.
    pub(crate) fn removed(&self, with: &Model) -> f64 {
        let (was, is) = (self.model.fitted.squares.sum, with.fitted.squares.sum);
        let excess = was - self.floor(self.estimation);
        ((was - is) / excess.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    }

    /// The same on the validation data, negative where the error rises; all where there was none, and of
    /// the whole error where that is far below its floor.
    pub(super) fn removed_of_validation(&self, with: &Model) -> f64 {
        let (was, is) = (self.model.validation.squares.sum, with.validation.squares.sum);
        let floor = self.floor(self.validation);
        if was > floor {
            (was - is) / (was - floor)
        } else if was < BELOW_FLOOR * floor {
            (was - is) / was
        } else {
            1.0
        }
    }

    /// Whether the errors of the round's model are those of a perfect one.
    pub(super) fn is_at_floor(&self) -> bool {
        let model = self.model;
        let both = [
            (&model.fitted.squares, self.estimation),
            (&model.validation.squares, self.validation),
        ];
        both.iter().all(|(squares, evidence)| squares.sum <= AT_FLOOR * self.floor(evidence))
    }

    /// Squared error of a perfect model, over the values.
    pub(super) fn floor(&self, evidence: &Evidence) -> f64 {
        let observer = self.model.setting.observer;
        let of = |measured: &Measured| measured.values() as f64 * observer.floor(measured).powi(2);
        evidence.recordings.iter().map(of).sum()
    }
}
