//! The screen: what each candidate would gain, by one linearised run and without a refit.
//!
//! The sensitivities of the outputs to a candidate's coefficients at their null, projected beside
//! the base, give the squared error that it would take away; k ln n is its price (BIC). Several
//! candidates share a pass of duals: at their nulls they do not see each other. Candidates whose
//! null is an infinite stiffness are run as they are, at each point of their grid.

use drivescope_plant::drive::Drive;
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::columns::{At, Columns, Owned, Place};
use super::projection::{Explained, Projection, STANDS_OUT};
use super::ripple::{Trajectory, forcings};
use super::sight::Sight;
use super::whiten::Whitener;
use crate::case::Setting;

/// Share of the residual's variance that its past does not foretell, below which the screen looks
/// at its innovations too.
const COLOURED: f64 = 0.98;
/// Further variants from which a law without a derivative at its null is fitted.
const OTHERS: usize = 4;
/// Directions of a pass.
const A_PASS: usize = 8;

/// A candidate with its best shape.
#[derive(Debug, Clone)]
pub(crate) struct Screened {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// Number of its best variant.
    pub(crate) variant: usize,
    /// Further variants to begin a refit with, where the law is so far from linear that one does
    /// not lead to the others.
    pub(crate) others: Vec<usize>,
    /// Coefficients to begin a refit with.
    pub(crate) coefficients: Vec<f64>,
    /// Squared error that goes, in units of the noise.
    pub(crate) gain: f64,
    /// Gain less its price.
    pub(crate) worth: f64,
    /// Greatest share of a column of its signature that stands out of the base.
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

/// The residual with its base, as it is and in innovations: under a random load, or beside a
/// larger effect, a small one shows only there.
#[derive(Debug)]
struct Views {
    plain: Projection,
    white: Option<(Whitener, Vec<Place>, Projection)>,
}

impl Views {
    /// Of these columns of a base; in innovations too where the residual remembers anything.
    fn of(base: &Columns) -> Self {
        let plain = Projection::new(base.columns.clone(), &base.residual);
        let whitener = Whitener::of(&base.places, plain.residual().as_slice());
        let white = (whitener.unforeseen() < COLOURED).then(|| {
            let columns = whitener.filtered(&base.places, &base.columns);
            let residual = whitener.applied(&base.places, &base.residual);
            (whitener, base.places.clone(), Projection::new(columns, &residual))
        });
        Self { plain, white }
    }

    /// The columns as each view sees them.
    fn seen(&self, columns: DMatrix<f64>) -> Vec<(&Projection, DMatrix<f64>)> {
        let white = self.white.as_ref().map(|(whitener, places, projection)| {
            (projection, whitener.filtered(places, &columns))
        });
        std::iter::once((&self.plain, columns)).chain(white).collect()
    }
}

/// What was screened: as it is, and in innovations, best candidate first.
#[derive(Debug, Default)]
pub(crate) struct Screen {
    pub(crate) plain: Vec<Screened>,
    pub(crate) white: Vec<Screened>,
}

impl Screen {
    /// The most promising of both views by turns, every candidate once, but a ripple of other
    /// periods again.
    pub(crate) fn promising<'a>(
        &'a self,
        candidates: &[Candidate],
        enough: impl Fn(&Screened) -> bool,
    ) -> Vec<&'a Screened> {
        let mut all: Vec<&Screened> = Vec::new();
        for place in 0..self.plain.len().max(self.white.len()) {
            for one in [self.plain.get(place), self.white.get(place)].into_iter().flatten() {
                let same = |other: &&Screened| {
                    let variant = !candidates[one.candidate].is_ripple();
                    other.candidate == one.candidate && (variant || other.variant == one.variant)
                };
                if enough(one) && !all.iter().any(same) {
                    all.push(one);
                }
            }
        }
        all
    }
}

/// Every candidate that `may` take part, with the best of its variants in each view.
pub(crate) fn screen(
    sight: &Sight<'_>,
    candidates: &[Candidate],
    may: &dyn Fn(&Candidate) -> bool,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Screen {
    let (at, views) = (&sight.at, &Views::of(sight.columns()));
    let passes = passes(candidates, may);
    let linear = passes.par_iter().flat_map_iter(|seats| {
        if stopped() { Vec::new() } else { pass(sight, views, candidates, seats) }
    });
    let stiff: Vec<Seat> = seats(candidates, may, false).collect();
    let stiff = stiff.par_iter().flat_map_iter(|seat| {
        if stopped() { Vec::new() } else { scanned(at, views, candidates, *seat) }
    });
    let all: Vec<(usize, Screened)> = linear.chain(stiff).collect();
    let of = |view: usize| {
        let some = all.iter().filter(|(own, _)| *own == view).map(|(_, one)| one.clone());
        best_variants(some, candidates, views.plain.residual().len())
    };
    Screen { plain: of(0), white: of(1) }
}

/// The best variant of every candidate, best candidate first.
fn best_variants(
    all: impl Iterator<Item = Screened>,
    candidates: &[Candidate],
    values: usize,
) -> Vec<Screened> {
    let values = values as f64;
    let price = |one: &Screened| {
        let candidate = &candidates[one.candidate];
        // The search over a grid is a parameter of its own.
        let shape = usize::from(candidate.variants.len() > 1);
        (candidate.coefficients.len() + shape) as f64 * values.ln()
    };
    let mut all: Vec<Screened> =
        all.map(|one| Screened { worth: one.gain - price(&one), ..one }).collect();
    all.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    let mut best: Vec<Screened> = Vec::new();
    for one in all {
        match best.iter_mut().find(|other| other.candidate == one.candidate) {
            Some(other)
                if candidates[one.candidate].is_linear() || other.others.len() == OTHERS => {}
            Some(other) => other.others.push(one.variant),
            None => best.push(one),
        }
    }
    best.sort_by(|a, b| b.worth.total_cmp(&a.worth).then(a.candidate.cmp(&b.candidate)));
    best
}

fn seats<'a>(
    candidates: &'a [Candidate],
    may: &'a dyn Fn(&Candidate) -> bool,
    linear: bool,
) -> impl Iterator<Item = Seat> + 'a {
    let wanted = move |it: &Candidate| it.is_linear() == linear && may(it);
    let some = candidates.iter().enumerate().filter(move |(_, it)| wanted(it));
    some.flat_map(|(candidate, it)| {
        (0..it.variants.len()).map(move |variant| Seat { candidate, variant })
    })
}

/// Variants that share a pass: ripples keep to their kind, and stiff effects, whose steps are
/// short, to themselves, as do typed laws, which may overflow.
fn passes(candidates: &[Candidate], may: &dyn Fn(&Candidate) -> bool) -> Vec<Vec<Seat>> {
    let mut passes: Vec<Vec<Seat>> = Vec::new();
    let (mut room, mut before) = (0, usize::MAX);
    for seat in seats(candidates, may, true) {
        let candidate = &candidates[seat.candidate];
        let slow = candidate.info.stiff || candidate.info.id == "delay";
        let alone = candidate.is_ripple() || slow || candidate.is_typed();
        let company = if alone { seat.candidate } else { usize::MAX };
        let k = candidate.coefficients.len();
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
fn ripples(
    at: &At<'_>,
    runs: &[Trajectory],
    candidates: &[Candidate],
    seats: &[Seat],
) -> DMatrix<f64> {
    at.responses(runs, |recording| {
        let of = |seat: &Seat| {
            let candidate = &candidates[seat.candidate];
            let (_, n) = candidate.variants[seat.variant].effect.parameters[0];
            forcings(candidate.info.id, n, at.drive, &runs[recording])
        };
        seats.iter().flat_map(of).collect()
    })
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
    sight: &Sight<'_>,
    views: &Views,
    candidates: &[Candidate],
    seats: &[Seat],
) -> Vec<(usize, Screened)> {
    let columns = if candidates[seats[0].candidate].is_ripple() {
        ripples(&sight.at, sight.runs(), candidates, seats)
    } else {
        columns(&sight.at, candidates, seats).columns
    };
    let seen = views.seen(columns);
    let mut from = 0;
    let mut found = Vec::new();
    for seat in seats {
        let candidate = &candidates[seat.candidate];
        let k = candidate.coefficients.len();
        for (view, (projection, columns)) in seen.iter().enumerate() {
            let own = columns.rows(from, k).into_owned();
            if own.iter().any(|value| !value.is_finite()) {
                continue;
            }
            let explained = within(candidate, projection, own);
            let stands_out = explained.stands_out.iter().fold(0.0_f64, |most, it| most.max(*it));
            let one = Screened {
                candidate: seat.candidate,
                variant: seat.variant,
                others: Vec::new(),
                coefficients: explained.coefficients.as_slice().to_vec(),
                gain: explained.gain,
                worth: 0.0,
                stands_out,
            };
            found.push((view, one));
        }
        from += k;
    }
    found
}

/// What the columns explain with coefficients that are told and possible: one that the base
/// imitates, or that would leave its range, is left out and stays at its null. All that stands
/// out is that of the best column.
fn within(candidate: &Candidate, projection: &Projection, mut columns: DMatrix<f64>) -> Explained {
    let mut explained = projection.explain(&columns);
    let stands_out = explained.stands_out.clone();
    let untold = (0..columns.nrows()).filter(|row| stands_out[*row] < STANDS_OUT);
    untold.for_each(|row| columns.row_mut(row).fill(0.0));
    if stands_out.iter().any(|share| *share < STANDS_OUT) {
        explained = projection.explain(&columns);
    }
    for _ in 0..columns.nrows() {
        let all = candidate.ranges.iter().zip(explained.coefficients.iter()).enumerate();
        let beyond = |(row, ((low, high), value)): (usize, (&(f64, f64), &f64))| {
            let left_out = columns.row(row).iter().all(|v| *v == 0.0);
            (!left_out && (value < low || value > high)).then_some(row)
        };
        let Some(row) = all.filter_map(beyond).next() else { break };
        columns.row_mut(row).fill(0.0);
        explained = projection.explain(&columns);
    }
    Explained { stands_out, ..explained }
}

/// Columns of the coefficients of some variants, in one run.
fn columns(at: &At<'_>, candidates: &[Candidate], seats: &[Seat]) -> Columns {
    let names: Vec<String> = seats
        .iter()
        .enumerate()
        .flat_map(|(number, seat)| {
            let of = move |name: &String| format!("{}.{name}", seat_name(number));
            candidates[seat.candidate].coefficients.iter().map(of)
        })
        .collect();
    let with = |drive: &Drive| with_all(drive, candidates, seats);
    let setting = finer(at.setting, &with(at.drive));
    let rows = at.rows(&with, &setting, |_| names.iter().cloned().map(Owned::Parameter).collect());
    Columns::shared(at.evidence, &rows)
}

/// The setting with sub-steps that resolve the drive's fastest effect too.
pub(crate) fn finer(setting: &Setting, drive: &Drive) -> Setting {
    let own = Setting::new(drive, setting.observer);
    Setting { longest_s: setting.longest_s.min(own.longest_s), ..*setting }
}

/// The gain of a variant as it is, with the base moved beside it, in each view: in innovations for
/// what rings, but not for what stands for dry friction, of which they show little.
fn scanned(
    at: &At<'_>,
    views: &Views,
    candidates: &[Candidate],
    seat: Seat,
) -> Vec<(usize, Screened)> {
    let candidate = &candidates[seat.candidate];
    let variant = &candidate.variants[seat.variant];
    let setting = finer(at.setting, &candidate.added(at.drive, variant));
    let change = |own: &Drive| candidate.added(own, variant);
    let rows = at.rows(&change, &setting, |_| Vec::new());
    let residual = Columns::shared(at.evidence, &rows).residual;
    let white = views.white.as_ref().filter(|_| !candidate.info.replaces_dry);
    let white = white.map(|(whitener, places, projection)| {
        projection.gain(&whitener.applied(places, &residual))
    });
    let one = |(view, gain): (usize, f64)| {
        let one = Screened {
            candidate: seat.candidate,
            variant: seat.variant,
            others: Vec::new(),
            coefficients: Vec::new(),
            gain,
            worth: 0.0,
            stands_out: 1.0,
        };
        (view, one)
    };
    let gains = std::iter::once(views.plain.gain(&residual)).chain(white).enumerate();
    gains.filter(|(_, gain)| gain.is_finite()).map(one).collect()
}
