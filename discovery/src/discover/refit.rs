//! A candidate in the drive, everything fitted again, and what this proves.

use drivescope_plant::drive::{Drive, EffectData};
use nalgebra::{DMatrix, DVector};

use super::candidates::Candidate;
use super::columns::{At, Place};
use super::projection::wald;
use super::screen::{Screened, finer};
use crate::case::Setting;
use crate::error::Error;
use crate::estimate::{Evaluated, Evidence, Fitted, Options, Seen, evaluate, fit_seen};

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

    /// At the recordings it was fitted to.
    pub(crate) fn at<'a>(&'a self, estimation: &'a Evidence) -> At<'a> {
        At::fitted(&self.fitted, estimation, &self.setting)
    }

    /// At the validation recordings.
    pub(crate) fn at_validation<'a>(&'a self, validation: &'a Evidence) -> At<'a> {
        At {
            drive: &self.fitted.drive,
            fits: &self.validation.recordings,
            evidence: validation,
            setting: &self.setting,
        }
    }

    /// Its parameters that were estimated.
    pub(crate) fn names(&self) -> Vec<String> {
        self.fitted.parameters.iter().map(|it| it.name.clone()).collect()
    }
}

/// The drive with the screened candidate, fitted again from where the screen points.
pub(crate) fn refit(
    base: &Model,
    candidate: &Candidate,
    screened: &Screened,
    estimation: &Evidence,
    validation: &Evidence,
    seen: Seen<'_>,
) -> Result<Model, Error> {
    let variant = &candidate.variants[screened.variant];
    let mut drive = candidate.added(&base.fitted.drive, variant);
    for (name, value) in candidate.coefficients.iter().zip(&screened.coefficients) {
        // A value outside its range stays at the null.
        let _ = drive.set(&format!("{}.{name}", candidate.id), *value);
    }
    let setting = finer(&base.setting, &drive);
    let options = Options { starts: 1, ..Options::default() };
    let mut model = Model::fit(&drive, estimation, validation, setting, &options, seen)?;
    // What was frozen for the search is the user's to fit.
    let own = format!("{}.", candidate.id);
    model.fitted.drive.fixed.retain(|name| !name.starts_with(&own));
    Ok(model)
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
    let setting = finer(&base.setting, &drive);
    let options = Options { starts: 1, ..Options::default() };
    let fixed = drive.fixed.clone();
    drive.fixed.extend(kept);
    let mut model = Model::fit(&drive, estimation, validation, setting, &options, seen)?;
    model.fitted.drive.fixed = fixed;
    Ok(model)
}

/// p value of the hypothesis that the change from one model to the next, of `k` parameters,
/// is none: with d the change of the innovations, the Wald test of its factor over blocks.
pub(crate) fn p_value(
    places: &[Place],
    before: &[f64],
    after: &[f64],
    k: usize,
    block: impl Fn(&Place) -> usize,
) -> f64 {
    let change = DMatrix::from_fn(1, before.len(), |_, value| before[value] - after[value]);
    let information = &change * change.transpose();
    if information[(0, 0)] == 0.0 {
        return 1.0;
    }
    let after = DVector::from_column_slice(after);
    wald(&change, &after, &information, &DVector::from_element(1, 1.0), k, places, block)
}

pub(crate) fn squared(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
