//! The report of a discovery: the drive compared before and after.

use drivescope_discovery::compare::{Comparison, Options as CompareOptions, compare};
use drivescope_discovery::{Discovery, Setting};
use drivescope_plant::drive::Drive;

use crate::answer::compare::Setting as About;
use crate::answer::discover::{Missing, Step};
use crate::evidence::Gathered;
use crate::failure::into_report;
use crate::report::discover::{Found, discover_html};

/// One self-contained page.
///
/// # Errors
/// Recordings that cannot be compared together.
pub(super) fn report(
    (found, missing): (&Discovery, &Missing),
    gathered: &Gathered,
    seed: u64,
) -> miette::Result<String> {
    let Gathered { estimation, noise, doubts, .. } = gathered;
    let compared = |drive: &Drive| -> miette::Result<Comparison> {
        let setting = Setting::new(drive, found.observer);
        let options = CompareOptions { curves: true, seed, fit: false };
        compare(drive, estimation, &setting, &options).map_err(into_report)
    };
    let after = compared(&found.drive)?;
    let before = match found.ladder.len() {
        // Nothing was added, or nothing judged.
        0 | 1 => None,
        // The cards speak of the base as it was fitted, before anything was added.
        _ => Some(compared(&found.base)?),
    };
    let steps: Vec<Step> = found.ladder.iter().map(Step::from).collect();
    let judged = found.ladder.last().map(|step| step.validation_error);
    let about = About::new(&found.drive, estimation, &noise[0], judged, doubts, seed);
    // Where the user chose the effect, nobody was asked what is missing.
    let asked = !found.ranking.is_empty() || found.named.is_empty();
    Ok(discover_html(&Found {
        compared: &after,
        setting: &about,
        before: before.as_ref().unwrap_or(&after),
        missing: asked.then_some(missing),
        motion: found.drive.motion,
        steps: &steps,
        parameters: &found.parameters,
    }))
}
