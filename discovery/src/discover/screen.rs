//! The screen: what each candidate would gain, by one linearised run and without a refit.
//!
//! The sensitivities of the outputs to a candidate's coefficients at their null, projected beside
//! the base, give the squared error that it would take away; k ln n is its price (BIC). Several
//! candidates share a pass of duals: at their nulls they do not see each other. Candidates whose
//! null is an infinite stiffness are run as they are, at each point of their grid.

use drivescope_plant::drive::Drive;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::columns::{At, Columns, Owned};
use super::projection::{Explained, Projection, STANDS_OUT};
use super::ripple::{Trajectory, directions, trajectories};
use crate::case::{Case, Setting};
use crate::estimate::with_own;

/// Directions of a pass.
const A_PASS: usize = 8;

/// A candidate with its best shape.
#[derive(Debug, Clone)]
pub(crate) struct Screened {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// Number of its best variant.
    pub(crate) variant: usize,
    /// Coefficients to begin a refit with.
    pub(crate) coefficients: Vec<f64>,
    /// Squared error that goes, in units of the noise.
    pub(crate) gain: f64,
    /// Gain less its price.
    pub(crate) worth: f64,
    /// Share of its signature that stands out of the base.
    pub(crate) stands_out: f64,
}

impl Screened {
    /// Whether the base parameters do the same on these recordings.
    pub(crate) fn is_imitated(&self) -> bool {
        self.stands_out < STANDS_OUT
    }
}

/// One variant in a pass.
#[derive(Debug, Clone, Copy)]
struct Seat {
    candidate: usize,
    variant: usize,
}

/// Every candidate with the best of its variants, best candidate first.
pub(crate) fn screen(
    at: &At<'_>,
    projection: &Projection,
    candidates: &[Candidate],
    stopped: &(dyn Fn() -> bool + Sync),
) -> Vec<Screened> {
    let values = projection.residual().len() as f64;
    let runs = trajectories(at);
    let passes = passes(candidates);
    let linear = passes.par_iter().flat_map_iter(|seats| {
        if stopped() { Vec::new() } else { pass(at, &runs, projection, candidates, seats) }
    });
    let stiff: Vec<Seat> = seats(candidates, false).collect();
    let stiff = stiff.par_iter().flat_map_iter(|seat| {
        if stopped() { None } else { scanned(at, projection, candidates, *seat) }
    });
    let all: Vec<Screened> = linear.chain(stiff).collect();
    let price = |one: &Screened| {
        let candidate = &candidates[one.candidate];
        // The search over a grid is a parameter of its own.
        let shape = usize::from(candidate.variants.len() > 1);
        (candidate.coefficients.len() + shape) as f64 * values.ln()
    };
    let mut best: Vec<Screened> = Vec::new();
    for mut one in all {
        one.worth = one.gain - price(&one);
        match best.iter_mut().find(|other| other.candidate == one.candidate) {
            Some(other) if other.worth < one.worth => *other = one,
            Some(_) => {}
            None => best.push(one),
        }
    }
    best.sort_by(|a, b| b.worth.total_cmp(&a.worth).then(a.candidate.cmp(&b.candidate)));
    best
}

fn seats(candidates: &[Candidate], linear: bool) -> impl Iterator<Item = Seat> + '_ {
    let some = candidates.iter().enumerate().filter(move |(_, it)| it.is_linear() == linear);
    some.flat_map(|(candidate, it)| {
        (0..it.variants.len()).map(move |variant| Seat { candidate, variant })
    })
}

/// Whether it is one of the ripples, whose variants are many and cheap.
fn is_ripple(candidate: &Candidate) -> bool {
    candidate.entry.parameters.iter().any(|parameter| parameter.name == "N")
}

/// Variants that share a pass: ripples keep to their kind, and stiff effects, whose steps are
/// short, to themselves.
fn passes(candidates: &[Candidate]) -> Vec<Vec<Seat>> {
    let mut passes: Vec<Vec<Seat>> = Vec::new();
    let (mut room, mut before) = (0, usize::MAX);
    for seat in seats(candidates, true) {
        let candidate = &candidates[seat.candidate];
        let slow = candidate.entry.info.stiff || candidate.entry.info.id == "delay";
        let alone = is_ripple(candidate) || slow;
        let company = if alone { seat.candidate } else { usize::MAX };
        // The flux acts in two balances.
        let ripples = if is_ripple(candidate) { candidate.entry.info.acts_on.len() } else { 1 };
        let k = candidate.coefficients.len() * ripples;
        if room < k || company != before || passes.is_empty() {
            passes.push(Vec::new());
            room = A_PASS;
        }
        if let Some(pass) = passes.last_mut() {
            pass.push(seat);
        }
        (room, before) = (room - k, company);
    }
    passes
}

/// Columns of some ripples of one kind.
fn ripples(at: &At<'_>, runs: &[Trajectory], candidates: &[Candidate], seats: &[Seat]) -> Columns {
    let rows = at.rows(Drive::clone, at.setting, |recording, _| {
        let of = |seat: &Seat| {
            let candidate = &candidates[seat.candidate];
            let (_, n) = candidate.variants[seat.variant].effect.parameters[0];
            directions(candidate.entry.info.id, n, at.drive, &runs[recording])
        };
        seats.iter().flat_map(of).collect()
    });
    let mut columns = Columns::shared(at.evidence, &rows);
    // The responses to torque and voltage together are that to the flux.
    let each = columns.columns.nrows() / (2 * seats.len());
    if each == 2 {
        let (all, n) = (&columns.columns, columns.columns.ncols());
        columns.columns = nalgebra::DMatrix::from_fn(all.nrows() / 2, n, |row, value| {
            all[(2 * row, value)] + all[(2 * row + 1, value)]
        });
    }
    columns
}

/// The drive with the variants of a pass, each under a name of its own.
fn with_all(drive: &Drive, candidates: &[Candidate], seats: &[Seat]) -> Drive {
    let mut with = drive.clone();
    for (number, seat) in seats.iter().enumerate() {
        let mut effect = candidates[seat.candidate].variants[seat.variant].effect.clone();
        effect.id = seat_name(number);
        with.effects.push(effect);
    }
    with
}

fn seat_name(number: usize) -> String {
    format!("seat {number}")
}

fn pass(
    at: &At<'_>,
    runs: &[Trajectory],
    projection: &Projection,
    candidates: &[Candidate],
    seats: &[Seat],
) -> Vec<Screened> {
    let columns = if is_ripple(&candidates[seats[0].candidate]) {
        ripples(at, runs, candidates, seats)
    } else {
        columns(at, candidates, seats)
    };
    let mut from = 0;
    let mut found = Vec::new();
    for seat in seats {
        let candidate = &candidates[seat.candidate];
        let k = candidate.coefficients.len();
        let own = columns.columns.rows(from, k).into_owned();
        from += k;
        if own.iter().any(|value| !value.is_finite()) {
            continue;
        }
        let explained = within(candidate, projection, &own);
        let judged = explained.stands_out >= STANDS_OUT;
        found.push(Screened {
            candidate: seat.candidate,
            variant: seat.variant,
            coefficients: explained.coefficients.as_slice().to_vec(),
            gain: if judged { explained.gain } else { 0.0 },
            worth: 0.0,
            stands_out: explained.stands_out,
        });
    }
    found
}

/// What the columns explain with coefficients that are possible: one that would leave its range
/// is left out.
fn within(
    candidate: &Candidate,
    projection: &Projection,
    columns: &nalgebra::DMatrix<f64>,
) -> Explained {
    let mut columns = columns.clone();
    loop {
        let explained = projection.explain(&columns);
        let range = |name: &str| {
            let parameters = candidate.entry.parameters;
            parameters.iter().find(|it| it.name == name).map_or((0.0, 0.0), |it| it.range)
        };
        let outside = candidate.coefficients.iter().zip(explained.coefficients.iter());
        let worst = outside.enumerate().find(|(row, (name, value))| {
            let (low, high) = range(name);
            columns.row(*row).iter().any(|v| *v != 0.0) && (**value < low || **value > high)
        });
        let Some((row, _)) = worst else { return explained };
        columns.row_mut(row).fill(0.0);
    }
}

/// Columns of the coefficients of some variants, in one run.
fn columns(at: &At<'_>, candidates: &[Candidate], seats: &[Seat]) -> Columns {
    let names: Vec<String> = seats
        .iter()
        .enumerate()
        .flat_map(|(number, seat)| {
            let of = move |name: &&str| format!("{}.{name}", seat_name(number));
            candidates[seat.candidate].coefficients.iter().map(of)
        })
        .collect();
    let with = |drive: &Drive| with_all(drive, candidates, seats);
    let setting = finer(at.setting, &with(at.drive));
    let rows =
        at.rows(with, &setting, |_, _| names.iter().cloned().map(Owned::Parameter).collect());
    Columns::shared(at.evidence, &rows)
}

/// The setting with sub-steps that resolve the drive's fastest effect too.
pub(crate) fn finer(setting: &Setting, drive: &Drive) -> Setting {
    let own = Setting::new(drive, setting.observer);
    Setting { longest_s: setting.longest_s.min(own.longest_s), ..*setting }
}

/// The gain of a variant as it is.
fn scanned(
    at: &At<'_>,
    projection: &Projection,
    candidates: &[Candidate],
    seat: Seat,
) -> Option<Screened> {
    let candidate = &candidates[seat.candidate];
    let variant = &candidate.variants[seat.variant];
    let setting = finer(at.setting, &candidate.added(at.drive, variant));
    let sum: f64 = (0..at.fits.len())
        .map(|recording| {
            let own = with_own(at.drive, &at.fits[recording]);
            let drive = candidate.added(&own, variant);
            let case = Case {
                drive: &drive,
                measured: &at.evidence.recordings[recording],
                noise: &at.evidence.noise[recording],
                starts: &at.fits[recording].starts,
                setting: &setting,
            };
            case.squares().sum
        })
        .sum();
    sum.is_finite().then(|| Screened {
        candidate: seat.candidate,
        variant: seat.variant,
        coefficients: Vec::new(),
        gain: projection.residual().norm_squared() - sum,
        worth: 0.0,
        stands_out: 1.0,
    })
}
