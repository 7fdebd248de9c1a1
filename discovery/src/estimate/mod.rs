//! The one estimator: all parameters jointly, over all recordings, by the error of the observed
//! run in units of the noise (SCIENCE: output error with a frozen observer).
//!
//! [`fit`] searches by Levenberg and Marquardt with exact sensitivities, from the drive's own
//! values and, where these do not lead to the noise floor, from further starts drawn around them.
//! Parameters that the recordings do not tell are named and kept. [`evaluate`] judges a drive on
//! recordings it was not fitted to: there only what belongs to a recording is estimated.

mod identifiable;
mod problem;
mod scale;
mod search;
mod uncertainty;
mod unknowns;

use drivescope_numerics::{Limits, Residuals};
use drivescope_plant::drive::Drive;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand::distr::{Distribution, Uniform};
use rand_pcg::Pcg64;
use serde::Serialize;

pub use identifiable::NotIdentifiable;

use crate::case::{Case, Setting, Squares};
use crate::error::Error;
use crate::measured::{Channel, Measured};
use crate::start::{Start, first_starts};
use problem::Problem;
use scale::Reach;
use search::minimise_within;
use unknowns::{Unknown, Unknowns, Which, set};

/// Steps of a search.
const STEPS: usize = 60;
/// Decrease of the squared error, in units of the noise, that is no longer worth a step: the
/// parameters are then within a few per cent of a standard error of the minimum.
const WORTH_A_STEP: f64 = 1e-3;
/// Error over the noise floor up to which a search has found it and no further start is tried.
const AT_THE_FLOOR: f64 = 1.05;
/// Points that are looked at for each further start.
const LOOKED_AT: usize = 8;
/// Further starts lie within this factor of the drive's values.
const AROUND: f64 = 3.0;

/// Recordings of one machine with what is known of their noise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evidence {
    /// The recordings.
    pub recordings: Vec<Measured>,
    /// Standard deviation of the noise of each one's outputs, in their units.
    pub noise: Vec<Vec<f64>>,
}

impl Evidence {
    /// Measured values in all of them.
    pub fn values(&self) -> usize {
        self.recordings.iter().map(Measured::values).sum()
    }

    /// Squares of all measured values less their mean, in units of the noise.
    pub fn power(&self) -> f64 {
        let of = |(channel, sd): (&Channel, &f64)| {
            let values = || channel.values.iter().filter(|value| value.is_finite());
            let mean = values().sum::<f64>() / values().count() as f64;
            values().map(|y| ((y - mean) / sd).powi(2)).sum::<f64>()
        };
        let each = self.recordings.iter().zip(&self.noise);
        each.flat_map(|(measured, noise)| measured.outputs.iter().zip(noise)).map(of).sum()
    }
}

/// How hard to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Starts at most, the drive's own values among them.
    pub starts: usize,
    /// Seed of the further starts.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { starts: 3, seed: 1 }
    }
}

/// An estimated parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Standard error of the value.
    pub std_error: f64,
    /// The value it had in the drive file.
    pub before: f64,
    /// Its unit.
    pub unit: String,
    /// Whether the search ended at the limit of what is possible.
    pub at_bound: bool,
}

/// What belongs to one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Parameters that may differ from recording to recording.
    pub own: Vec<Estimate>,
    /// State at the beginning of each piece.
    pub starts: Vec<Start>,
    /// Its squared errors.
    pub squares: Squares,
}

/// A drive on recordings it was not fitted to, or as it was before.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluated {
    /// Each recording.
    pub recordings: Vec<Fit>,
    /// Squared errors over all of them.
    pub squares: Squares,
}

/// A drive fitted to recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The drive with the estimates; of what differs between recordings, their mean.
    pub drive: Drive,
    /// Parameters of the machine, in the drive's order.
    pub parameters: Vec<Estimate>,
    /// Correlations of the errors of [`Self::parameters`].
    pub correlation: DMatrix<f64>,
    /// What the recordings do not tell.
    pub not_identifiable: Vec<NotIdentifiable>,
    /// Each recording.
    pub recordings: Vec<Fit>,
    /// Squared errors over all of them.
    pub squares: Squares,
    /// Length of the blocks of the robust standard errors, s.
    pub block_s: f64,
    /// Starts of the search that were tried.
    pub starts_tried: usize,
}

impl Fitted {
    /// The drive with what belongs to that recording.
    pub fn drive_of(&self, recording: usize) -> Drive {
        with_own(&self.drive, &self.recordings[recording])
    }

    /// The case of that recording, to look at what is left.
    pub fn case<'a>(
        &'a self,
        drive: &'a Drive,
        evidence: &'a Evidence,
        setting: &'a Setting,
        recording: usize,
    ) -> Case<'a> {
        Case {
            drive,
            measured: &evidence.recordings[recording],
            noise: &evidence.noise[recording],
            starts: &self.recordings[recording].starts,
            setting,
        }
    }
}

/// The drive with what was estimated for one recording.
pub fn with_own(drive: &Drive, fit: &Fit) -> Drive {
    let mut own = drive.clone();
    for estimate in &fit.own {
        set(&mut own, &estimate.name, estimate.value);
    }
    own
}

/// Fits the drive to the recordings.
///
/// # Errors
/// [`Error::Overflow`] if the model overflows from every start.
pub fn fit(
    base: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    options: &Options,
) -> Result<Fitted, Error> {
    let base = &tied(base);
    let mut kept: Vec<NotIdentifiable> = Vec::new();
    let mut from = base.clone();
    let mut starts = guesses(&from, evidence, setting);
    let mut tried = 0;
    loop {
        let names: Vec<String> = kept.iter().map(|it| it.parameter.clone()).collect();
        let unknowns = Unknowns::new(&from, evidence, starts, Which::AllBut(&names));
        let problem = Problem { base: &from, evidence, setting, unknowns };
        // Once what cannot be told is out, the search goes on from where it was.
        let found = if tried == 0 {
            let (found, count) = search(&problem, options.starts.max(1), options.seed)?;
            tried = count;
            found
        } else {
            search(&problem, 1, options.seed)?.0
        };
        let more = not_identifiable(&problem, &found, base);
        if more.is_empty() {
            return conclude(&problem, &found, base, kept, tried);
        }
        // What cannot be told goes back to the file's value, the rest starts from where it is.
        let mut next = problem.unknowns.at(&from, 0, &found).0;
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
/// [`Error::Overflow`] if the model overflows.
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
    let (found, _) = search(&problem, 1, 0)?;
    let at = Solved::new(&problem, &found);
    let recordings = at.recordings(&problem, &found, drive);
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

/// The best minimum from up to that many starts, and how many were tried.
fn search(problem: &Problem<'_>, starts: usize, seed: u64) -> Result<(Vec<f64>, usize), Error> {
    let reaches = problem.unknowns.reaches();
    let values = problem.evidence.values() as f64;
    let limits = Limits { steps: STEPS, relative_decrease: WORTH_A_STEP / values };
    let mut random = Pcg64::seed_from_u64(seed);
    let mut best = minimise_within(problem, &problem.unknowns.guess, &reaches, limits);
    let mut tried = 1;
    let floors = problem.evidence.recordings.iter().map(|it| problem.setting.observer.floor(it));
    let floor = AT_THE_FLOOR * floors.fold(1.0, f64::max);
    while tried < starts && (best.sse / values).sqrt().total_cmp(&floor).is_gt() {
        let drawn: Vec<Vec<f64>> =
            (0..LOOKED_AT).map(|_| around(&problem.unknowns, &mut random)).collect();
        let looked = drawn.into_iter().map(|point| (problem.sse(&point), point));
        let Some((_, start)) = looked.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        let found = minimise_within(problem, &start, &reaches, limits);
        if found.sse < best.sse || !best.sse.is_finite() {
            best = found;
        }
        tried += 1;
    }
    if best.sse.is_finite() {
        return Ok((best.parameters, tried));
    }
    Err(Error::Overflow { recording: problem.evidence.recordings[0].name.clone(), starts: tried })
}

/// A start drawn around the guess: parameters within a factor, states as they are.
fn around(unknowns: &Unknowns, random: &mut Pcg64) -> Vec<f64> {
    let range = Uniform::new_inclusive(-AROUND.ln(), AROUND.ln()).expect("a range");
    let draw = |k: usize| {
        let factor = range.sample(random).exp();
        let (guess, scale) = (unknowns.guess[k], &unknowns.scales[k]);
        match unknowns.all[k] {
            Unknown::Start { .. } => guess,
            _ => scale.coordinate(scale.value(guess) * factor),
        }
    };
    (0..unknowns.all.len()).map(draw).collect()
}

/// How well a solution is known.
struct Solved {
    /// In coordinates; infinite where the information is singular.
    covariance: DMatrix<f64>,
    block_s: f64,
}

impl Solved {
    fn new(problem: &Problem<'_>, found: &[f64]) -> Self {
        let at = problem.linearise(found);
        let values = problem.evidence.values();
        let freedom = values.saturating_sub(found.len()).max(1) as f64;
        let variance = at.sse / freedom;
        let (block_s, blocks) = problem.blocks_of_time(found);
        let unknowns = found.len();
        let covariance = uncertainty::covariance(&at.hessian, variance, &blocks)
            .unwrap_or_else(|| DMatrix::from_element(unknowns, unknowns, f64::INFINITY));
        Self { covariance, block_s }
    }

    fn std_error(&self, problem: &Problem<'_>, found: &[f64], k: usize) -> f64 {
        problem.unknowns.scales[k].slope(found[k]) * self.covariance[(k, k)].sqrt()
    }

    fn estimate(
        &self,
        problem: &Problem<'_>,
        found: &[f64],
        k: usize,
        name: &str,
        base: &Drive,
    ) -> Estimate {
        let all = base.parameters();
        let known = all.iter().find(|it| it.name == name).expect("a parameter of the drive");
        let Reach { low, high, .. } = problem.unknowns.scales[k].reach;
        Estimate {
            name: name.to_owned(),
            value: problem.unknowns.scales[k].value(found[k]),
            std_error: self.std_error(problem, found, k),
            before: known.value,
            unit: known.unit.clone(),
            at_bound: found[k] <= low || found[k] >= high,
        }
    }

    /// What belongs to each recording.
    fn recordings(&self, problem: &Problem<'_>, found: &[f64], base: &Drive) -> Vec<Fit> {
        let squares = problem.squares(found);
        let of = |(number, squares): (usize, Squares)| {
            let own =
                problem.unknowns.all.iter().enumerate().filter_map(|(k, unknown)| match unknown {
                    Unknown::Own { recording, name } if *recording == number => {
                        Some(self.estimate(problem, found, k, name, base))
                    }
                    _ => None,
                });
            let starts = problem.unknowns.at(problem.base, number, found).1;
            Fit { own: own.collect(), starts, squares }
        };
        squares.into_iter().enumerate().map(of).collect()
    }
}

/// Parameters of the machine that the recordings do not tell.
fn not_identifiable(problem: &Problem<'_>, found: &[f64], base: &Drive) -> Vec<NotIdentifiable> {
    let at = problem.linearise(found);
    let variance = (at.sse / problem.evidence.values() as f64).max(1.0);
    let power = problem.evidence.power();
    let name = |k: usize| match &problem.unknowns.all[k] {
        Unknown::Shared(name) => Some(name.clone()),
        _ => None,
    };
    let shared = (0..found.len()).take_while(|k| name(*k).is_some()).count();
    let sizes: Vec<f64> = (0..shared)
        .map(|k| match problem.unknowns.scales[k].is_sizeless(problem.unknowns.guess[k]) {
            // What moves the outputs by as much as they move at all.
            true if at.hessian[(k, k)] > 0.0 => (power / at.hessian[(k, k)]).sqrt(),
            _ => 1.0,
        })
        .collect();
    let Some(mut information) = identifiable::marginal(&(at.hessian / variance), shared) else {
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
    let told = |it: identifiable::Combination| NotIdentifiable {
        kept: all.iter().find(|p| p.name == named(it.kept)).map_or(f64::NAN, |p| p.value),
        parameter: named(it.kept),
        with: it.with.into_iter().map(named).collect(),
    };
    identifiable::unknown(&information, &preference).into_iter().map(told).collect()
}

fn conclude(
    problem: &Problem<'_>,
    found: &[f64],
    base: &Drive,
    not_identifiable: Vec<NotIdentifiable>,
    starts_tried: usize,
) -> Result<Fitted, Error> {
    let at = Solved::new(problem, found);
    let recordings = at.recordings(problem, found, base);
    let squares = total(&recordings);
    let mut drive = problem.base.clone();
    let mut parameters = Vec::new();
    for (k, unknown) in problem.unknowns.all.iter().enumerate() {
        if let Unknown::Shared(name) = unknown {
            let estimate = at.estimate(problem, found, k, name, base);
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
    })
}
