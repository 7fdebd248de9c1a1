//! Whether the validation recordings are of the machine that the others are of.
//!
//! What the base lacks spoils both alike. If the validation recordings are explained much better by
//! parameters of their own, their machine is another one, or was in another state.

use super::refit::Model;
use super::report::Discovery;
use crate::doubt::Doubt;
use crate::estimate::{Evidence, Options, fit};

/// Validation error over estimation error below which nothing is suspected.
const WORSE: f64 = 1.5;
/// Share of the validation error that its own parameters must leave at most.
const EXPLAINED: f64 = 0.5;
/// Share of what parameters of its own explain below which a name explains little.
const LITTLE: f64 = 0.5;

/// The doubt about a fitted base and these validation recordings.
pub(crate) fn doubt(model: &Model, validation: &Evidence) -> Option<Doubt> {
    let error = model.validation.squares.error();
    if error < WORSE * model.fitted.squares.error() {
        return None;
    }
    let own = fit(&model.fitted.drive, validation, &model.setting, &Options::NEAR).ok()?;
    let own_error = own.squares.error();
    if own_error > EXPLAINED * error {
        return None;
    }
    let differs = |name: &str, value: f64, std_error: f64| {
        let here = model.fitted.parameters.iter().find(|it| it.name == name)?;
        let far = (value - here.value).abs() / std_error.hypot(here.std_error);
        far.is_finite().then_some((far, here))
    };
    let all = own.parameters.iter().filter_map(|it| {
        differs(&it.name, it.value, it.std_error).map(|(far, here)| (far, here, it))
    });
    let (_, here, there) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Doubt::OtherMachine {
        error,
        own_error,
        parameter: here.name.clone(),
        here: here.value,
        there: there.value,
        unit: here.unit.clone(),
    })
}

/// Whether what was named explains less of the validation recordings than parameters of their own would:
/// then it is not what is missing there. Of the squared error less than half as much.
pub(super) fn outdoes(found: &Discovery) -> bool {
    let Some(last) = found.ladder.last() else { return false };
    let better = |doubt: &Doubt| match doubt {
        Doubt::OtherMachine { error, own_error, .. } => {
            let taken = |left: f64| error * error - left * left;
            taken(last.validation_error) < LITTLE * taken(*own_error)
        }
        _ => false,
    };
    !found.named.is_empty() && found.doubts.iter().any(better)
}
