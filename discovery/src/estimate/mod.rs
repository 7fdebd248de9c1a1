//! The one estimator: all parameters jointly, over all recordings, by the error of the observed
//! run in units of the noise (output error with a frozen observer).
//!
//! [`fit`] searches by Levenberg and Marquardt with exact sensitivities: from the values that least
//! squares on the balances give and, where these do not lead to the noise floor, from the drive's
//! own and from further starts drawn around the best.
//! Parameters that the recordings do not tell are named and kept. [`evaluate`] judges a drive on
//! recordings it was not fitted to: there only what belongs to a recording is estimated.

mod balanced;
mod evidence;
mod fitted;
mod identifiable;
mod output_fits;
mod problem;
mod scale;
mod search;
mod solved;
mod starts;
mod swing;
mod uncertainty;
mod unknowns;

use drivescope_plant::drive::Drive;
use nalgebra::{DMatrix, DVector};

pub use evidence::Evidence;
pub use fitted::{Estimate, Evaluated, Fit, Fitted, with_own};
pub use identifiable::NotIdentifiable;
pub(crate) use output_fits::fit_percent;
pub use output_fits::{OutputFits, output_fits};

use crate::balances::begin;
use crate::case::{Setting, Squares};
use crate::error::Error;
use crate::start::{Start, first_starts};
use balanced::balanced;
pub(crate) use balanced::{AS_WELL, at_its_balances, is_worse};
use problem::Problem;
pub(crate) use scale::recorded_speeds;
use search::Found;
use solved::{Solved, started};
use starts::search;
pub(crate) use uncertainty::correlation_samples;
pub(crate) use unknowns::set;
use unknowns::{Unknown, Unknowns, Which};

/// Who sees a search: told the error, in units of the noise, after every step; true ends it.
pub type Seen<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// The usual [`Options::worth_a_step`]: the parameters are then within a few per cent of a standard
/// error of the minimum.
const WORTH_A_STEP: f64 = 1e-3;
/// The usual [`Options::steps`].
const STEPS: usize = 60;

/// How hard to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Starts at most; one is the drive's own values, of several the first is that of the
    /// balances.
    pub starts: usize,
    /// Seed of the further starts.
    pub seed: u64,
    /// Decrease of the squared error, in units of the noise, that is no longer worth a step.
    pub worth_a_step: f64,
    /// Steps from each start at most.
    pub steps: usize,
    /// Whether a fit that explains the balances worse than least squares on them gives way to
    /// these; not where errors of several models are compared.
    pub balanced: bool,
}

impl Options {
    /// One start, the drive's own values: it is near the minimum.
    pub(crate) const NEAR: Self =
        Self { starts: 1, seed: 1, worth_a_step: WORTH_A_STEP, steps: STEPS, balanced: false };
}

impl Default for Options {
    fn default() -> Self {
        Self { starts: 3, balanced: true, ..Self::NEAR }
    }
}

/// Fits the drive to the recordings.
///
/// # Errors
/// [`Error::Overflow`] or [`Error::OutOfBudget`] if the model overflows from every start.
pub fn fit(
    base: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    options: &Options,
) -> Result<Fitted, Error> {
    fit_seen(base, evidence, setting, options, &|_| false)
}

/// As [`fit`], with somebody who sees the error fall and may end the search: the fit then is where
/// it came to.
///
/// # Errors
/// As [`fit`].
pub fn fit_seen(
    base: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    options: &Options,
    seen: Seen<'_>,
) -> Result<Fitted, Error> {
    let base = &tied(base);
    let mut kept: Vec<NotIdentifiable> = Vec::new();
    let begun = (options.starts > 1).then(|| begin(base, evidence));
    let mut from = begun.as_ref().map_or(base, |begun| &begun.drive).clone();
    let mut starts = guesses(&from, evidence, setting);
    let mut tried = 0;
    loop {
        let names: Vec<String> = kept.iter().map(|it| it.parameter.clone()).collect();
        let unknowns = Unknowns::new(&from, evidence, starts, Which::AllBut(&names));
        let problem = Problem { base: &from, evidence, setting, unknowns };
        // Once what cannot be told is out, the search goes on from where it was.
        let found = if tried == 0 {
            let (found, count) = search(&problem, base, options, seen)?;
            tried = count;
            found
        } else {
            let near = Options { starts: 1, ..*options };
            let found = search(&problem, base, &near, seen);
            // A value that goes back alone may make no drive with the others.
            found.or_else(|_| search(&problem, base, &Options { starts: 2, ..near }, seen))?.0
        };
        let more = not_identifiable(&problem, &found, base);
        if more.is_empty() {
            let fitted = conclude(&problem, &found, base, kept, tried)?;
            return match begun.filter(|_| options.balanced) {
                Some(begun) => balanced(fitted, &begun, base, evidence, setting),
                None => Ok(fitted),
            };
        }
        // What cannot be told goes back to the file's value, the rest starts from where it is.
        let mut next = problem.unknowns.at(&from, 0, &found.coordinates).0;
        more.iter().for_each(|it| set(&mut next, &it.parameter, it.kept));
        starts = guesses(&next, evidence, setting);
        from = next;
        kept.extend(more);
    }
}

/// Judges the drive on recordings: only their starts and, with `own`, their own parameters are
/// estimated.
///
/// # Errors
/// [`Error::Overflow`] or [`Error::OutOfBudget`] if the model overflows.
pub fn evaluate(
    drive: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    own: bool,
) -> Result<Evaluated, Error> {
    let drive = &tied(drive);
    let which = if own { Which::Own } else { Which::StartsOnly };
    let unknowns = Unknowns::new(drive, evidence, guesses(drive, evidence, setting), which);
    let problem = Problem { base: drive, evidence, setting, unknowns };
    let (found, _) = search(&problem, drive, &Options::NEAR, &|_| false)?;
    let has_own = problem.unknowns.all.iter().any(|it| matches!(it, Unknown::Own { .. }));
    let recordings = if has_own {
        Solved::new(&problem, &found).recordings(drive)
    } else {
        started(&problem, &found)
    };
    let squares = total(&recordings);
    Ok(Evaluated { recordings, squares })
}

/// The drive as an estimate sees it: a tied K_m is K_e.
fn tied(drive: &Drive) -> Drive {
    let mut tied = drive.clone();
    if let (true, Some(k_e)) = (drive.motor.tie_k, drive.motor.k_e) {
        tied.motor.k_m = k_e;
    }
    tied
}

fn guesses(drive: &Drive, evidence: &Evidence, setting: &Setting) -> Vec<Vec<Start>> {
    let each = evidence.recordings.iter().zip(&evidence.noise);
    each.map(|(measured, noise)| first_starts(drive, measured, noise, setting)).collect()
}

fn total(recordings: &[Fit]) -> Squares {
    recordings.iter().fold(Squares::default(), |sum, fit| sum.and(fit.squares))
}

/// Parameters of the machine that the recordings do not tell.
fn not_identifiable(problem: &Problem<'_>, found: &Found, base: &Drive) -> Vec<NotIdentifiable> {
    let at = &found.at;
    let variance = (at.sse / problem.evidence.values() as f64).max(1.0);
    let power = problem.evidence.power();
    let name = |k: usize| match &problem.unknowns.all[k] {
        Unknown::Shared(name) => Some(name.clone()),
        _ => None,
    };
    let shared = (0..found.coordinates.len()).take_while(|k| name(*k).is_some()).count();
    let sizes: Vec<f64> = (0..shared)
        .map(|k| match problem.unknowns.scales[k].is_sizeless(problem.unknowns.guess[k]) {
            // What moves the outputs by as much as they move at all.
            true if at.normal_matrix[(k, k)] > 0.0 => (power / at.normal_matrix[(k, k)]).sqrt(),
            _ => 1.0,
        })
        .collect();
    let Some(mut information) = identifiable::marginal(&(&at.normal_matrix / variance), shared)
    else {
        return Vec::new();
    };
    for j in 0..shared {
        for k in 0..shared {
            information[(j, k)] *= sizes[j] * sizes[k];
        }
    }
    // A torque constant is read off a data sheet before anything else; then the file's order.
    let mut preference: Vec<usize> = (0..shared).collect();
    preference.sort_by_key(|k| name(*k).as_deref() != Some("K_m"));
    let all = base.parameters();
    let named = |k: usize| name(k).expect("shared");
    let combination = |it: identifiable::Combination| NotIdentifiable {
        kept: all.iter().find(|p| p.name == named(it.kept)).map_or(f64::NAN, |p| p.value),
        parameter: named(it.kept),
        with: it.with.into_iter().map(named).collect(),
    };
    identifiable::unknown(&information, &preference).into_iter().map(combination).collect()
}

fn conclude(
    problem: &Problem<'_>,
    found: &Found,
    base: &Drive,
    not_identifiable: Vec<NotIdentifiable>,
    starts_tried: usize,
) -> Result<Fitted, Error> {
    let at = Solved::new(problem, found);
    let recordings = at.recordings(base);
    let squares = total(&recordings);
    let mut drive = problem.base.clone();
    let mut parameters = Vec::new();
    for (k, unknown) in problem.unknowns.all.iter().enumerate() {
        if let Unknown::Shared(name) = unknown {
            let estimate = at.estimate(k, name, base);
            set(&mut drive, name, estimate.value);
            parameters.push(estimate);
        }
    }
    for name in &base.per_recording {
        let own: Vec<f64> = recordings
            .iter()
            .filter_map(|fit| fit.own.iter().find(|it| it.name == *name))
            .map(|it| it.value)
            .collect();
        if !own.is_empty() {
            set(&mut drive, name, own.iter().sum::<f64>() / own.len() as f64);
        }
    }
    let sd = DVector::from_fn(parameters.len(), |k, _| at.covariance[(k, k)].sqrt());
    let correlation = DMatrix::from_fn(parameters.len(), parameters.len(), |j, k| {
        if j == k { 1.0 } else { at.covariance[(j, k)] / (sd[j] * sd[k]) }
    });
    Ok(Fitted {
        drive,
        parameters,
        correlation,
        not_identifiable,
        recordings,
        squares,
        block_s: at.block_s,
        starts_tried,
        by_balances: false,
    })
}
