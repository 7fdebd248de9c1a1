//! How often a discovery is right: hidden effects of known size in random machines.
//!
//! Half of the cases are simulated by the plant itself ([`own`]), half by independent programs
//! with laws of another form and another integration ([`foreign`]). Whether a hidden effect could
//! be found at all is decided from the truth before the discovery runs: the true law, fitted,
//! must beat the base by [`DETECTABLE`] in BIC. No case is left out for its result: one whose
//! discovery fails counts as a miss wherever it is counted.

mod emps;
mod foreign;
mod kept;
mod moved;
mod own;
mod real;
mod reliability;
mod tally;
#[cfg(test)]
mod testing;

use std::path::Path;
use std::time::Instant;

use drivescope_discovery::{
    Error, Evidence, Formula, Measured, Rule, Unwatched, Verdict, add, bic_of, discover_by, noise,
};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use rand::SeedableRng as _;
use rand::seq::index;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::Serialize;

use crate::interrupt;
use crate::run_folder::RunFolder;

use own::Distance;

pub(crate) use moved::{Moved, discoveries};
pub(crate) use tally::Table;

/// BIC by which the truth must beat the base for a case to count as detectable.
const DETECTABLE: f64 = 20.0;

/// Share of its size by which a formula may miss a law and still have its form.
const FORM: f64 = 0.05;
/// One case in that many more hides a law that nobody programmed.
const UNPROGRAMMED: usize = 10;

/// One discovery in that many is timed, with nothing beside it.
const TIMED: usize = 10;

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
    /// A law that nobody programmed, in one variable or in several.
    Unprogrammed,
    /// Two effects at once.
    Pair,
    /// An effect of another size, or other noise, than usual.
    Graded,
}

/// How strong the noise is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Noise {
    Small,
    Medium,
    Large,
}

/// How hard a case is: the size of what hides, and the noise around it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Grade {
    /// Factor on the usual size of what hides.
    size: f64,
    noise: Noise,
}

impl Grade {
    /// What the published rates are for.
    const USUAL: Self = Self { size: 1.0, noise: Noise::Medium };
    /// The others, one thing changed at a time.
    const OTHERS: [Self; 4] = [
        Self { size: 0.5, ..Self::USUAL },
        Self { size: 2.0, ..Self::USUAL },
        Self { noise: Noise::Small, ..Self::USUAL },
        Self { noise: Noise::Large, ..Self::USUAL },
    ];
}

/// A machine with its recordings and the truth.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    group: Group,
    /// Whether an independent program made it.
    foreign: bool,
    grade: Grade,
    /// Kinds that are hidden.
    hidden: Vec<String>,
    /// The hidden law where nobody programmed it.
    law: Option<own::HiddenLaw>,
    /// The drive file to start from.
    drive: Drive,
    estimation: Record,
    validation: Record,
}

/// A recording with its noise: signals and their standard deviations, SI.
#[derive(Debug, Clone, PartialEq)]
struct Record {
    recording: Recording,
    noise: Vec<(String, f64)>,
}

/// What became of a case.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Outcome {
    group: Group,
    foreign: bool,
    grade: Grade,
    /// Whether the discovery was told the noise, or estimated it.
    noise_given: bool,
    hidden: Vec<String>,
    /// Whether the truth beats the base by enough; absent where nothing of the library is hidden.
    detectable: Option<bool>,
    /// What the discovery answered, or why it did not.
    answer: Result<Discovered, String>,
    /// Time of the discovery with nothing beside it, s; where it was taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    alone_s: Option<f64>,
}

/// What a discovery answered.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Discovered {
    named: Vec<String>,
    /// What was named, with its confusion sets.
    sets: Vec<Vec<String>>,
    verdict: Verdict,
    /// What was ranked, with the probability that it was given.
    probabilities: Vec<(String, f64)>,
    /// Formulas that are offered.
    formulas: usize,
    /// Place of the first formula that has the form of the hidden law, from 1: equal where the
    /// machine went within [`FORM`] of it, and of what the base leaves of it.
    form: Option<usize>,
    strict_form: Option<usize>,
    before: f64,
    after: f64,
    validation_before: f64,
    validation_after: f64,
}

/// What a run of the benchmark found.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) outcomes: Vec<Outcome>,
    pub(crate) real: real::Real,
}

/// Draws and judges that many cases, and times some of them ([`timed`]); each counts as an advance.
/// `keep` is a folder for them as files.
///
/// # Errors
/// No Python for the independent generators, a folder that cannot be written, or the user stops.
pub(crate) fn run(
    cases: usize,
    seed: u64,
    python: &foreign::Python,
    keep: Option<&Path>,
    advance: &(dyn Fn() + Sync),
) -> miette::Result<Found> {
    // Before the minutes that drawing them takes.
    let folder = keep.map(RunFolder::take).transpose()?;
    let all = drawn(cases, seed, python)?;
    if let Some(folder) = folder {
        kept::keep(&all, folder.work())?;
        folder.finish()?;
    }
    let judged = all.par_iter().enumerate().map(|(number, case)| {
        interrupt::check()?;
        let outcome = judge(case, gives_noise(number));
        advance();
        Ok(outcome)
    });
    let mut outcomes: Vec<Outcome> = judged.collect::<miette::Result<_>>()?;
    // Beside others a discovery waits for its turn: a fair part runs again, one at a time.
    let mut random = Pcg64::seed_from_u64(seed);
    for number in index::sample(&mut random, all.len(), timed(all.len())) {
        interrupt::check()?;
        let start = Instant::now();
        // One that ends in an error takes its time too.
        let _ = answer(&Rule::NAMING, &all[number], gives_noise(number));
        outcomes[number].alone_s = Some(start.elapsed().as_secs_f64());
        advance();
    }
    Ok(Found { outcomes, real: real::Real::run(&Rule::NAMING)? })
}

/// Half of that many cases from independent programs, half from the plant, and those whose law
/// nobody programmed.
fn drawn(cases: usize, seed: u64, python: &foreign::Python) -> miette::Result<Vec<Case>> {
    let mut all = python.cases(cases / 2, seed)?;
    interrupt::check()?;
    all.extend(own::cases(cases - all.len(), seed));
    all.extend(own::unprogrammed(unprogrammed(cases), seed));
    Ok(all)
}

/// Cases beside so many that hide a law that nobody programmed.
pub(crate) fn unprogrammed(cases: usize) -> usize {
    cases.div_ceil(UNPROGRAMMED)
}

/// Discoveries that run again to be timed.
pub(crate) fn timed(cases: usize) -> usize {
    cases.div_ceil(TIMED)
}

/// Whether the discovery of a case is told the noise: half of the cases of every group.
fn gives_noise(number: usize) -> bool {
    number.is_multiple_of(2)
}

/// A recording as evidence, its noise given or estimated.
fn evidence(drive: &Drive, record: &Record, given: bool) -> Result<Evidence, Error> {
    let measured = Measured::new(drive, &record.recording)?;
    let given = if given { record.noise.as_slice() } else { &[] };
    let sds = noise(drive, &measured, given).iter().map(|noise| noise.sd).collect();
    Ok(Evidence { recordings: vec![measured], noise: vec![sds] })
}

fn judge(case: &Case, noise_given: bool) -> Outcome {
    let detectable = match case.group {
        Group::Null | Group::NullLoaded | Group::NullZeroSpeed | Group::Outside => None,
        Group::Unprogrammed => Some(detectable_law(case, noise_given)),
        Group::Hidden | Group::HiddenLoaded | Group::Pair | Group::Graded => {
            Some(detectable(case, noise_given))
        }
    };
    Outcome { detectable, ..outcome(&Rule::NAMING, case, noise_given) }
}

/// What a rule answers, whether the truth could be found or not.
fn outcome(rule: &Rule, case: &Case, noise_given: bool) -> Outcome {
    let (hidden, grade) = (case.hidden.clone(), case.grade);
    let (group, foreign) = (case.group, case.foreign);
    let answer = answer(rule, case, noise_given);
    Outcome { group, foreign, grade, noise_given, hidden, detectable: None, answer, alone_s: None }
}

/// Whether each truth is worth its parameters beside the others; a truth that cannot be fitted
/// leaves no case out.
fn detectable(case: &Case, noise_given: bool) -> bool {
    let gain = |kind: &String| {
        let estimation = evidence(&case.drive, &case.estimation, noise_given)?;
        let validation = evidence(&case.drive, &case.validation, noise_given)?;
        let mut base = case.drive.clone();
        for other in case.hidden.iter().filter(|other| *other != kind) {
            base = add(&base, other, &estimation, &validation, &Unwatched)?.drive;
        }
        bic_of(&base, kind, &estimation, &validation)
    };
    case.hidden.iter().all(|kind| gain(kind).map_or(true, |gain| gain > DETECTABLE))
}

/// The same of a law that nobody programmed, typed as it is.
fn detectable_law(case: &Case, noise_given: bool) -> bool {
    let gain = || {
        let mut base = case.drive.clone();
        base.effects.extend(case.law.iter().map(own::HiddenLaw::at_null));
        let estimation = evidence(&case.drive, &case.estimation, noise_given)?;
        let validation = evidence(&case.drive, &case.validation, noise_given)?;
        bic_of(&base, &case.hidden[0], &estimation, &validation)
    };
    gain().map_or(true, |gain| gain > DETECTABLE)
}

/// What the discovery answers; why it does not.
fn answer(rule: &Rule, case: &Case, noise_given: bool) -> Result<Discovered, String> {
    let said = |error: Error| error.to_string();
    let estimation = evidence(&case.drive, &case.estimation, noise_given).map_err(said)?;
    let validation = evidence(&case.drive, &case.validation, noise_given).map_err(said)?;
    let both = (&estimation, &validation);
    let found = discover_by(rule, &case.drive, both, &Unwatched).map_err(said)?;
    let (Some(first), Some(last)) = (found.ladder.first(), found.ladder.last()) else {
        let wrong: Vec<String> = found.signals.iter().map(ToString::to_string).collect();
        return Err(format!("not judged: {}", wrong.join("; ")));
    };
    let set = |id: &String| {
        let ranked = found.ranking.iter().find(|it| it.effect == *id && it.refused.is_none());
        let others = ranked.map_or(vec![], |it| it.confusion_set.clone());
        std::iter::once(id.clone()).chain(others).collect()
    };
    let form = |far: fn(Distance) -> f64| {
        let law = case.law.as_ref()?;
        let right = |formula: &Formula| {
            let distance = law.distance(formula, &case.estimation.recording);
            distance.is_some_and(|it| far(it) <= FORM)
        };
        found.formulas.iter().position(right).map(|place| place + 1)
    };
    Ok(Discovered {
        probabilities: found
            .ranking
            .iter()
            .filter(|it| it.refused.is_none() && found.named.contains(&it.effect))
            .map(|it| (it.effect.clone(), it.probability))
            .collect(),
        formulas: found.formulas.len(),
        form: form(|it| it.of_law),
        strict_form: form(|it| it.of_rest),
        sets: found.named.iter().map(set).collect(),
        named: found.named.clone(),
        verdict: found.verdict,
        before: first.error,
        after: last.error,
        validation_before: first.validation_error,
        validation_after: last.validation_error,
    })
}

/// Where the Python that runs the generators is.
pub(crate) fn python() -> foreign::Python {
    foreign::Python::new(super::python())
}
