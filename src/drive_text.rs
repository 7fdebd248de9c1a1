//! Drive files that a fit or a discovery changes: the user's own text, with what was found.

use drivescope_discovery::Fitted;
use drivescope_plant::drive::Drive;
use drivescope_plant::file::Change;
use drivescope_plant::parameters::NamedParameter;

use crate::evidence::Gathered;
use crate::failure::into_report;

/// The text of a drive file, of that name, with the effects and the values of the found drive.
///
/// # Errors
/// A text that is no drive file of `base`.
pub(crate) fn with_effects(
    (name, text): (&str, &str),
    base: &Drive,
    found: &Drive,
    gathered: &Gathered,
) -> miette::Result<String> {
    let text = text.to_owned() + &found.effects_to_toml(base.effects.len());
    let from = gathered.files();
    let fitted = found.fitted();
    let tied = found.motor.tie_k;
    let all = found.parameters();
    let before = base.parameters();
    // What stands in the file as it was, such as a typed law that was not named, is no estimate.
    let moved = |it: &&NamedParameter| {
        !before.iter().any(|other| other.name == it.name && other.value == it.value)
    };
    let changes: Vec<Change> = all
        .iter()
        .filter(moved)
        .filter(|it| fitted.iter().any(|other| other.name == it.name) || (tied && it.name == "K_m"))
        .map(|it| Change {
            name: it.name.clone(),
            value: it.value,
            origin: format!("fitted: {from}, by discovery"),
        })
        .collect();
    let (text, _) = Drive::edited(&text, name, &changes).map_err(into_report)?;
    Ok(text)
}

/// The text of a drive file, of that name, with the values of a fit.
///
/// # Errors
/// A text that is no file of the fitted drive.
pub(crate) fn with_estimates(
    (name, text): (&str, &str),
    fitted: &Fitted,
    gathered: &Gathered,
) -> miette::Result<String> {
    let (text, _) = Drive::edited(text, name, &changes(fitted, gathered)).map_err(into_report)?;
    Ok(text)
}

/// What changes in the drive file.
fn changes(fitted: &Fitted, gathered: &Gathered) -> Vec<Change> {
    let from = gathered.files();
    let mut changes: Vec<Change> = fitted
        .parameters
        .iter()
        .map(|it| {
            let known = match it.at_bound {
                true => "at its bound".to_owned(),
                false => format!("standard error {:.2e}", it.std_error),
            };
            let origin = format!("fitted: {from}; {known}");
            Change { name: it.name.clone(), value: it.value, origin }
        })
        .collect();
    if fitted.drive.motor.tie_k && changes.iter().any(|change| change.name == "K_e") {
        let origin = format!("fitted: {from}; tied to K_e");
        changes.push(Change { name: "K_m".to_owned(), value: fitted.drive.motor.k_m, origin });
    }
    let all = fitted.drive.parameters();
    for own in fitted.recordings.first().map_or(&[][..], |fit| &fit.own) {
        let value = all.iter().find(|it| it.name == own.name).map_or(own.value, |it| it.value);
        let several = if fitted.recordings.len() > 1 { "mean of several, " } else { "" };
        let origin = format!("fitted: {from}; {several}differs from recording to recording");
        changes.push(Change { name: own.name.clone(), value, origin });
    }
    changes
}
