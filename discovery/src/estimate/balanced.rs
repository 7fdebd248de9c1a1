//! Whether a fit leaves the balances as well explained as least squares on them.
//!
//! Where an observer keeps the model at the measurement, what a drive does not explain moves the
//! predicted motion by 1 / J of itself: where that is much (a cogging that a position loop cancels), a large
//! inertia hides it, and the error falls while the torque is explained worse. The values of the
//! balances are then the better answer.

use drivescope_numerics::{Residuals, Stop};
use drivescope_plant::drive::Drive;

use super::problem::Problem;
use super::search::Found;
use super::unknowns::{Unknown, Unknowns, Which};
use super::{Evidence, Fitted, conclude, evaluate};
use crate::balances::{Begun, Unexplained, unexplained};
use crate::case::Setting;
use crate::error::Error;

/// Times what least squares leave of a balance unexplained that a fit may leave.
const AS_WELL: f64 = 1.2;

/// The fit as it is, or that of the balances where it explains one of them worse.
pub(super) fn balanced(
    fitted: Fitted,
    begun: &Begun,
    base: &Drive,
    evidence: &Evidence,
    setting: &Setting,
) -> Result<Fitted, Error> {
    if setting.observer.hz == 0.0 {
        return Ok(fitted);
    }
    let by_balances = at_balances(&fitted, begun, base, evidence, setting)?;
    let left = |fitted: &Fitted| unexplained(&fitted.drive, evidence);
    let mut pairs = left(&fitted).into_iter().zip(left(&by_balances));
    let worse = |(by_fit, by_balances): (Option<Unexplained>, Option<Unexplained>)| {
        by_fit.zip(by_balances).is_some_and(|(fit, least)| fit.rms > AS_WELL * least.rms)
    };
    Ok(if pairs.any(worse) { by_balances } else { fitted })
}

/// The drive at the values of the balances as the answer of a fit: starts and what belongs to a
/// recording are estimated, standard errors are those of the balances.
fn at_balances(
    fitted: &Fitted,
    begun: &Begun,
    base: &Drive,
    evidence: &Evidence,
    setting: &Setting,
) -> Result<Fitted, Error> {
    let drive = &begun.drive;
    let judged = evaluate(drive, evidence, setting, true)?;
    let starts = judged.recordings.iter().map(|it| it.starts.clone()).collect();
    let kept: Vec<String> = fitted.not_identifiable.iter().map(|it| it.parameter.clone()).collect();
    let unknowns = Unknowns::new(drive, evidence, starts, Which::AllBut(&kept));
    let mut coordinates = unknowns.guess.clone();
    for (k, unknown) in unknowns.all.iter().enumerate() {
        if let Unknown::Own { recording, name } = unknown {
            let own = judged.recordings[*recording].own.iter().find(|it| it.name == *name);
            coordinates[k] =
                own.map_or(coordinates[k], |it| unknowns.scales[k].coordinate(it.value));
        }
    }
    let problem = Problem { base: drive, evidence, setting, unknowns };
    let found = Found { at: problem.linearise(&coordinates), coordinates, stop: Stop::Converged };
    let not_identifiable = fitted.not_identifiable.clone();
    let mut made = conclude(&problem, &found, base, not_identifiable, fitted.starts_tried)?;
    for estimate in &mut made.parameters {
        if let Some(told) = begun.told.iter().find(|it| it.name == estimate.name) {
            estimate.std_error = told.std_error;
        }
    }
    Ok(Fitted { by_balances: true, ..made })
}
