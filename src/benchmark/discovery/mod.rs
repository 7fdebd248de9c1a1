//! How often a discovery is right: hidden effects of known size in random machines.
//!
//! Half of the cases are simulated by the plant itself ([`own`]), half by independent programs
//! with laws of another form and another integration ([`foreign`]). Whether a hidden effect could
//! be found at all is decided from the truth before the discovery runs: the true law, fitted,
//! must beat the base by [`DETECTABLE`] in BIC. No case is left out for its result.

mod foreign;
mod own;
mod tally;

use std::path::PathBuf;

use drivescope_discovery::{Evidence, Measured, Unwatched, Verdict, bic_of, discover, noise};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use rayon::prelude::*;
use serde::Serialize;

use crate::failure::told;
use crate::interrupt;

pub(crate) use tally::Table;

/// BIC by which the truth must beat the base for a case to count as detectable.
const DETECTABLE: f64 = 20.0;

/// What a case is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Group {
    /// An effect of the library, white noise.
    Hidden,
    /// The same under a random load torque.
    HiddenLoaded,
    /// Nothing hidden, white noise.
    Null,
    /// Nothing hidden, a random load torque.
    NullLoaded,
    /// Nothing hidden, another law near zero speed than any model has.
    NullZeroSpeed,
    /// Something that no library has.
    Outside,
    /// Two effects at once.
    Pair,
}

/// A machine with its recordings and the truth.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    group: Group,
    /// Whether an independent program made it.
    foreign: bool,
    /// Kinds that are hidden.
    hidden: Vec<String>,
    /// The drive file to start from.
    drive: Drive,
    estimation: Recording,
    validation: Recording,
}

/// What became of a case.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Outcome {
    group: Group,
    foreign: bool,
    hidden: Vec<String>,
    /// Whether the truth beats the base by enough; absent where nothing of the library is hidden.
    detectable: Option<bool>,
    named: Vec<String>,
    /// What was named, with its confusion sets.
    sets: Vec<Vec<String>>,
    verdict: Verdict,
    before: f64,
    after: f64,
    validation_before: f64,
    validation_after: f64,
    seconds: f64,
}

/// Draws and judges that many cases.
///
/// # Errors
/// No Python for the independent generators, or the user stops.
pub(crate) fn run(
    cases: usize,
    seed: u64,
    python: &foreign::Python,
    advance: &(dyn Fn(&str) + Sync),
) -> miette::Result<Vec<Outcome>> {
    advance("independent generators");
    let mut all = python.cases(cases / 2, seed)?;
    interrupt::check()?;
    advance("own machines");
    all.extend(own::cases(cases - all.len(), seed));
    let judged: Vec<Option<Outcome>> = all
        .par_iter()
        .map(|case| {
            if interrupt::check().is_err() {
                return None;
            }
            let outcome = judge(case);
            advance("");
            outcome.ok()
        })
        .collect();
    interrupt::check()?;
    Ok(judged.into_iter().flatten().collect())
}

/// A recording as evidence, its noise estimated.
fn evidence(drive: &Drive, recording: &Recording) -> miette::Result<Evidence> {
    let measured = Measured::new(drive, recording).map_err(told)?;
    let sds = noise(drive, &measured, &[]).iter().map(|noise| noise.sd).collect();
    Ok(Evidence { recordings: vec![measured], noise: vec![sds] })
}

fn judge(case: &Case) -> miette::Result<Outcome> {
    let estimation = evidence(&case.drive, &case.estimation)?;
    let validation = evidence(&case.drive, &case.validation)?;
    let of_library = matches!(case.group, Group::Hidden | Group::HiddenLoaded | Group::Pair);
    let beats = |kind: &String| {
        bic_of(&case.drive, kind, &estimation, &validation).is_ok_and(|gain| gain > DETECTABLE)
    };
    let detectable = of_library.then(|| case.hidden.iter().all(beats));
    let start = std::time::Instant::now();
    let found = discover(&case.drive, &estimation, &validation, &Unwatched).map_err(told)?;
    let seconds = start.elapsed().as_secs_f64();
    let set = |id: &String| {
        let ranked = found.ranking.iter().find(|it| it.effect == *id && it.refused.is_none());
        let others = ranked.map_or(vec![], |it| it.confusion_set.clone());
        std::iter::once(id.clone()).chain(others).collect()
    };
    let (first, last) = (&found.ladder[0], &found.ladder[found.ladder.len() - 1]);
    Ok(Outcome {
        group: case.group,
        foreign: case.foreign,
        hidden: case.hidden.clone(),
        detectable,
        sets: found.named.iter().map(set).collect(),
        named: found.named.clone(),
        verdict: found.verdict,
        before: first.error,
        after: last.error,
        validation_before: first.validation_error,
        validation_after: last.validation_error,
        seconds,
    })
}

/// Where the Python that runs the generators is.
pub(crate) fn python() -> foreign::Python {
    foreign::Python::new(std::env::var_os("DRIVESCOPE_PYTHON").map(PathBuf::from))
}
