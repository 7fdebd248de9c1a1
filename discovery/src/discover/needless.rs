//! What was named before and is not needed any more: an effect that stood for a part of one that was
//! named later.

use drivescope_plant::drive::Drive;

use super::free_run::FALLS;
use super::refit::{Model, fit_near};
use super::report::{Watch, seen_by};
use super::round::Formula;
use crate::estimate::Evidence;

/// An effect that was added.
pub(super) struct Added {
    /// Its kind, as it is named.
    pub(super) kind: String,
    /// Its name in the drive.
    pub(super) id: String,
    /// Its parameters that are estimated, and those of them that are 0 where it vanishes.
    pub(super) estimated: Vec<String>,
    pub(super) coefficients: Vec<String>,
    /// Whether the error of the motion spoke for it, which is asked again.
    pub(super) by_error: bool,
    /// What its formula may leave.
    pub(super) formula: Formula,
}

/// The first of those before the last one without which the error on the validation data is what it
/// is with it, and the drive without it, fitted: what asks for a name is asked of it once more.
pub(super) fn needless(
    model: &Model,
    added: &[Added],
    (estimation, validation): (&Evidence, &Evidence),
    watch: &dyn Watch,
) -> Option<(usize, Model)> {
    let seen = |error| seen_by(watch, error);
    let error = |model: &Model| model.validation.squares.error();
    let earlier = added[..added.len().saturating_sub(1)].iter().enumerate();
    let without = |(place, it): (usize, &Added)| {
        let drive = without(&model.fitted.drive, &it.id);
        let fitted = fit_near(model, &drive, estimation, validation, &seen).ok()?;
        (error(&fitted) < (1.0 + FALLS) * error(model)).then_some((place, fitted))
    };
    earlier.filter(|(_, it)| it.by_error).find_map(without)
}

/// The drive without one of its effects.
pub(super) fn without(drive: &Drive, id: &str) -> Drive {
    let mut without = drive.clone();
    without.effects.retain(|effect| effect.id != id);
    without.fixed.retain(|name| name.split_once('.').is_none_or(|(of, _)| of != id));
    without
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Setting;
    use crate::discover::report::Unwatched;
    use crate::estimate::Options;
    use crate::measured::Measured;
    use crate::testing::{bench, dr300, noisy};
    use drivescope_plant::drive::EffectData;
    use drivescope_plant::effects::info::Variable;

    fn effect(kind: &str, parameters: &[(&str, f64)]) -> EffectData {
        let own = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value));
        EffectData { kind: kind.into(), id: kind.into(), parameters: own.collect(), law: None }
    }

    /// What is needless of cogging and quadratic drag in a machine that has those.
    fn needless_of(truth: &[EffectData]) -> Option<String> {
        let both = [
            effect("cogging", &[("N", 7.0), ("a", 1e-3), ("b", 1e-3)]),
            effect("quadratic_drag", &[("c", 3e-7)]),
        ];
        let mut machine = dr300();
        machine.effects.extend(truth.iter().cloned());
        let mut drive = dr300();
        drive.effects.extend(both.iter().cloned());
        let sds = [0.01, 0.3];
        let of = |duration_s, seed| {
            let recording = noisy(bench(&machine, duration_s, 1e-3), sds, seed);
            let measured = Measured::new(&drive, &recording).expect("it can be used");
            Evidence { recordings: vec![measured], noise: vec![sds.to_vec()] }
        };
        let (estimation, validation) = (of(3.0, 1), of(2.5, 2));
        let setting = Setting::of_fit(&drive, &estimation);
        let model =
            Model::fit(&drive, &estimation, &validation, setting, &Options::NEAR, &|_| false)
                .expect("a fit ends");
        let added: Vec<Added> = both
            .iter()
            .map(|it| Added {
                kind: it.kind.clone(),
                id: it.id.clone(),
                estimated: Vec::new(),
                coefficients: Vec::new(),
                by_error: true,
                formula: Formula::over(&[Variable::Omega]),
            })
            .collect();
        let found = needless(&model, &added, (&estimation, &validation), &Unwatched);
        let (place, fewer) = found?;
        assert!(fewer.fitted.drive.effects.iter().all(|it| it.id != added[place].id));
        Some(added[place].kind.clone())
    }

    #[test]
    fn what_the_machine_has_stays_and_what_it_has_not_goes() {
        let cogging = effect("cogging", &[("N", 7.0), ("a", 2e-3), ("b", 1e-3)]);
        let drag = effect("quadratic_drag", &[("c", 6e-7)]);
        assert_eq!(needless_of(&[cogging, drag.clone()]), None);
        assert_eq!(needless_of(&[drag]).as_deref(), Some("cogging"));
    }
}
