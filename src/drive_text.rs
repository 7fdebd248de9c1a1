//! Drive files that a discovery changes: the user's own text, with what was found.

use drivescope_plant::drive::Drive;
use drivescope_plant::file::Change;
use drivescope_plant::parameters::NamedParameter;

use crate::evidence::Gathered;
use crate::failure::told;

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
    let (text, _) = Drive::edited(&text, name, &changes).map_err(told)?;
    Ok(text)
}
