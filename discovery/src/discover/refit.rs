//! A candidate in the drive, everything fitted again, and what this proves.

use drivescope_plant::drive::{Drive, EffectData};
use rayon::prelude::*;

use super::candidate::Candidate;
use super::columns::FittedDrive;
use crate::balances::{begin, hold, unexplained};
use crate::case::Setting;
use crate::error::Error;
use crate::estimate::{Evaluated, Evidence, Fitted, Options, Seen, evaluate, fit_seen, is_worse};

/// A drive with its fit, on the recordings it was fitted to and on others.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    /// The fit.
    pub(crate) fitted: Fitted,
    /// What was frozen.
    pub(crate) setting: Setting,
    /// On the validation recordings.
    pub(crate) validation: Evaluated,
}

impl Model {
    /// Fits the drive and judges it on the validation recordings.
    pub(crate) fn fit(
        drive: &Drive,
        estimation: &Evidence,
        validation: &Evidence,
        setting: Setting,
        options: &Options,
        seen: Seen<'_>,
    ) -> Result<Self, Error> {
        let fitted = fit_seen(drive, estimation, &setting, options, seen)?;
        let validation = evaluate(&fitted.drive, validation, &setting, true)?;
        Ok(Self { fitted, setting, validation })
    }

    /// Fitted to its minimum.
    pub(crate) fn polished(
        &self,
        estimation: &Evidence,
        validation: &Evidence,
        seen: Seen<'_>,
    ) -> Result<Self, Error> {
        let drive = &self.fitted.drive;
        Self::fit(drive, estimation, validation, self.setting.of(drive), &Options::NEAR, seen)
    }

    /// At the values of the balances, where those leave less torque unexplained in the recordings held out
    /// than a fit that follows the motion; nothing where they do not.
    pub(crate) fn by_balances(
        &self,
        estimation: &Evidence,
        validation: &Evidence,
        seen: Seen<'_>,
    ) -> Option<Self> {
        let drive = &self.fitted.drive;
        let left = |of: &Drive| unexplained(of, validation)[0];
        let is_better = |of: &Drive| is_worse(&self.setting, left(drive), left(of));
        if !hold(drive) || !is_better(&begin(drive, estimation).drive) {
            return None;
        }
        let options = Options { starts: 2, balanced: true, ..Options::NEAR };
        let other = Self::fit(drive, estimation, validation, self.setting, &options, seen).ok()?;
        // Where the torque hardly moves the shaft, a drive of hardly any inertia leaves least of it: it
        // explains little, and does not follow the motion.
        let error = |of: &Self| of.validation.squares.error();
        let strays = self.setting.observer.follows() && error(&other) > STRAYS * error(self);
        let little = || left(&other.fitted.drive).is_some_and(|it| it.share > LITTLE);
        (is_better(&other.fitted.drive) && !(strays && little())).then_some(other)
    }

    /// At the recordings it was fitted to.
    pub(crate) fn at<'a>(&'a self, estimation: &'a Evidence) -> FittedDrive<'a> {
        let (drive, fits) = (&self.fitted.drive, &self.fitted.recordings);
        FittedDrive { drive, fits, evidence: estimation, setting: &self.setting }
    }

    /// At the validation recordings.
    pub(crate) fn at_others<'a>(&'a self, validation: &'a Evidence) -> FittedDrive<'a> {
        let (drive, fits) = (&self.fitted.drive, &self.validation.recordings);
        FittedDrive { drive, fits, evidence: validation, setting: &self.setting }
    }

    /// Its parameters that were estimated.
    pub(crate) fn names(&self) -> Vec<String> {
        self.fitted.parameters.iter().map(|it| it.name.clone()).collect()
    }
}

/// Error over that of a fit to the motion from which on an observer does not hold a drive on it.
const STRAYS: f64 = 2.0;
/// Share of the torque that one which strays leaves unexplained at most.
const LITTLE: f64 = 0.5;

/// Squared error, in units of the noise, by which a fit of a candidate may miss its minimum: far
/// below the evidence that a name needs ([`super::decision::Rule::evidence`]).
const NEAR_ENOUGH: f64 = 1.0;
/// Its steps at most: what is named is fitted to its minimum afterwards.
const STEPS: usize = 30;
/// A fit as close as judging a candidate needs.
const NEARLY: Options = Options { worth_a_step: NEAR_ENOUGH, steps: STEPS, ..Options::NEAR };

/// Shapes from which a fit begins.
const STARTS: usize = 5;
/// Steps after which the start values of a law are compared.
const FIRST_STEPS: usize = 6;
/// Starts that are followed to their ends: the best after the first steps may lead into a valley.
const FOLLOWED: usize = 2;
/// Squared error after the first steps over the least that is known from which on no start is followed.
const FAR: f64 = 4.0;

/// Sub-steps a sample beyond which a start has gone where it moves faster than any sample shows: a joint
/// that stiff is a shaft.
const SUB_STEPS: f64 = 64.0;

/// A drive fitted from where it stands, as closely as judging it needs.
pub(crate) fn fit_near(
    base: &Model,
    drive: &Drive,
    estimation: &Evidence,
    validation: &Evidence,
    seen: Seen<'_>,
) -> Result<Model, Error> {
    let setting = base.setting.of(drive);
    Model::fit(drive, estimation, validation, setting, &NEARLY, seen)
}

/// The drive with a law whose null is infinite, fitted again from shapes of it, the most promising
/// first, as closely as judging it needs. The best after a few steps are followed, and the best end
/// counts; nothing where no fit ends, or none is near the squared error that another law leaves.
pub(crate) fn refit(
    base: &Model,
    (candidate, variants): (&Candidate, &[usize]),
    other: Option<f64>,
    estimation: &Evidence,
    validation: &Evidence,
    seen: Seen<'_>,
) -> Option<Model> {
    let first_steps = |variant: &usize| {
        let drive = candidate.added(&base.fitted.drive, &candidate.variants[*variant]);
        let options = Options { steps: FIRST_STEPS, ..NEARLY };
        fit_seen(&drive, estimation, &base.setting.of(&drive), &options, seen).ok()
    };
    let begun = variants.par_iter().take(STARTS).filter_map(first_steps);
    let mut begun: Vec<Fitted> = begun.collect();
    begun.sort_by(|one, other| one.squares.sum.total_cmp(&other.squares.sum));
    begun.truncate(FOLLOWED);
    let sums = begun.iter().map(|it| it.squares.sum).chain(other);
    let least = sums.min_by(f64::total_cmp)?;
    begun.retain(|it| it.squares.sum <= FAR * least);
    let slowest = estimation.recordings.iter().map(|it| it.period_s).fold(0.0, f64::max);
    begun.retain(|it| slowest <= SUB_STEPS * base.setting.of(&it.drive).longest_s);
    let finish = |begun: &Fitted| fit_near(base, &begun.drive, estimation, validation, seen).ok();
    let ends: Vec<Model> = begun.par_iter().filter_map(finish).collect();
    ends.into_iter().min_by(|a, b| a.fitted.squares.sum.total_cmp(&b.fitted.squares.sum))
}

/// The drive with a learned curve, fitted again but for the values of those names.
pub(crate) fn with_learned(
    base: &Model,
    (effect, kept): (EffectData, Vec<String>),
    estimation: &Evidence,
    validation: &Evidence,
    seen: Seen<'_>,
) -> Result<Model, Error> {
    let mut drive = base.fitted.drive.clone();
    drive.effects.push(effect);
    let setting = base.setting.of(&drive);
    let fixed = drive.fixed.clone();
    drive.fixed.extend(kept);
    let mut model = Model::fit(&drive, estimation, validation, setting, &NEARLY, seen)?;
    model.fitted.drive.fixed = fixed;
    Ok(model)
}
