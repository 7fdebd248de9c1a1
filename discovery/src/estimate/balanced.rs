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
use crate::balances::{Begun, Unexplained, begin, hold, unexplained};
use crate::case::Setting;
use crate::error::Error;

/// Times what least squares leave of a balance unexplained that a fit may leave, behind an observer.
pub(crate) const AS_WELL: f64 = 1.2;
/// The same in free run, which weighs the noise better than least squares do: only a motion that the
/// model cannot make draws its parameters so far away.
const IN_FREE_RUN: f64 = 3.0;
/// Share of a balance that a drive may leave in free run in any case. Least squares on samples that are
/// slow beside the winding explain more than the drive that made them: their L takes what the samples
/// leave out.
const EXPLAINED: f64 = 0.1;
/// Times what least squares leave that a drive with their values leaves, but for the digits of its file.
const NEARLY: f64 = 1.01;

/// The fit as it is, or that of the balances where it explains one of them worse.
pub(super) fn balanced(
    fitted: Fitted,
    begun: &Begun,
    base: &Drive,
    evidence: &Evidence,
    setting: &Setting,
) -> Result<Fitted, Error> {
    if !hold(&fitted.drive) {
        return Ok(fitted);
    }
    let remainder = |drive: &Drive| unexplained(drive, evidence);
    let pairs = remainder(&fitted.drive).into_iter().zip(remainder(&begun.drive));
    if pairs.into_iter().any(|(of_fit, least)| is_worse(setting, of_fit, least)) {
        at_balances(&fitted, begun, base, evidence, setting)
    } else {
        Ok(fitted)
    }
}

/// Whether a drive leaves more of a balance unexplained than a fit may beside least squares, which leave
/// `least`.
pub(crate) fn is_worse(
    setting: &Setting,
    left: Option<Unexplained>,
    least: Option<Unexplained>,
) -> bool {
    let Some((left, least)) = left.zip(least) else { return false };
    if setting.observer.follows() {
        left.rms > AS_WELL * least.rms
    } else {
        left.share > EXPLAINED && left.rms > IN_FREE_RUN * least.rms
    }
}

/// Whether the drive explains its balances as well as least squares on them: a fit of the observed
/// motion that lowers the error further explains them no better.
pub(crate) fn at_its_balances(drive: &Drive, evidence: &Evidence) -> bool {
    if !hold(drive) {
        return false;
    }
    let least = begin(drive, evidence).drive;
    let pairs = unexplained(drive, evidence).into_iter().zip(unexplained(&least, evidence));
    let mut known = pairs.filter_map(|(own, least)| own.zip(least)).peekable();
    known.peek().is_some() && known.all(|(own, least)| own.rms <= NEARLY * least.rms)
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
        if let Some(identified) = begun.identified.iter().find(|it| it.name == estimate.name) {
            // Least squares leave no error to what they hold at zero.
            estimate.at_bound |= identified.std_error == 0.0;
            estimate.std_error = if estimate.at_bound { f64::NAN } else { identified.std_error };
        }
    }
    Ok(Fitted { by_balances: true, ..made })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::Measured;
    use crate::testing::{bench, dr300, noisy};
    use crate::{Observer, Options, fit};

    fn evidence(truth: &Drive) -> Evidence {
        let recording = noisy(bench(truth, 4.0, 0.001), [0.01, 0.3], 5);
        let measured = Measured::new(truth, &recording).expect("usable");
        Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] }
    }

    #[test]
    fn the_values_of_least_squares_are_known_again() {
        let drive = dr300();
        let evidence = evidence(&drive);
        let mut begun = begin(&drive, &evidence).drive;
        assert!(at_its_balances(&begun, &evidence));
        begun.motor.j *= 1.5;
        assert!(!at_its_balances(&begun, &evidence));
    }

    #[test]
    fn what_ends_at_its_bound_has_no_standard_error() {
        // A shaft that is driven on by what it does not show.
        let mut truth = dr300();
        truth.motor.b_m = -2e-5;
        let evidence = evidence(&truth);
        let setting = Setting::new(&dr300(), Observer::NONE);
        let fitted = fit(&dr300(), &evidence, &setting, &Options::default()).expect("it fits");
        let identified =
            |name: &str| fitted.parameters.iter().find(|it| it.name == name).expect("told");
        let (b_m, j) = (identified("B_m"), identified("J"));
        assert!(b_m.at_bound && b_m.value == 0.0 && b_m.std_error.is_nan(), "{b_m:?}");
        assert!(!j.at_bound && j.std_error > 0.0, "{j:?}");
    }
}
