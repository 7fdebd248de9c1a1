//! Residuals and sensitivities of all recordings, side by side in one long list of values.
//!
//! Columns are d y_model / d c in units of the noise. What is shared by the recordings has values
//! everywhere; a start, or a parameter of one recording's own, is zero in the others.

use drivescope_plant::drive::Drive;
use nalgebra::DMatrix;

use crate::case::{Case, Setting};
use crate::estimate::{Evidence, Fit, with_own};
use crate::measured::Measured;
use crate::projection::Normal;
use crate::sensitivity::{Direction, Rows};

/// Where a value was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Measurement {
    pub(crate) recording: usize,
    pub(crate) sample: usize,
    /// Output: 0 current, 1 speed, 2 position.
    pub(crate) output: usize,
}

/// A drive, fitted, at the recordings.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FittedDrive<'a> {
    pub(crate) drive: &'a Drive,
    /// What belongs to each recording.
    pub(crate) fits: &'a [Fit],
    /// The recordings.
    pub(crate) evidence: &'a Evidence,
    /// What is frozen.
    pub(crate) setting: &'a Setting,
}

impl<'a> FittedDrive<'a> {
    /// What belongs to a recording.
    fn own(&self, recording: usize) -> impl Iterator<Item = Owned> + 'a {
        let fit = &self.fits[recording];
        let names = fit.own.iter().map(|it| Owned::Parameter(it.name.clone()));
        let (drive, measured) = (self.drive, &self.evidence.recordings[recording]);
        let starts = fit.starts.iter().enumerate().flat_map(move |(piece, start)| {
            let free = start.free_states(drive, measured, piece).into_iter();
            free.map(move |state| Owned::Start { piece, state })
        });
        names.chain(starts)
    }

    /// What is shared by the recordings, then what belongs to this one.
    fn directions(&self, recording: usize, shared: &[String]) -> Vec<Owned> {
        let names = shared.iter().cloned().map(Owned::Parameter);
        names.chain(self.own(recording)).collect()
    }

    /// A recording with what belongs to it, and its directions.
    fn with_case<T>(
        &self,
        recording: usize,
        owned: &[Owned],
        run: impl FnOnce(&Case<'_>, &[Direction<'_>]) -> T,
    ) -> T {
        let borrowed: Vec<Direction<'_>> = owned.iter().map(Owned::direction).collect();
        let fit = &self.fits[recording];
        let drive = with_own(self.drive, fit);
        run(&self.evidence.case(recording, &drive, &fit.starts, self.setting), &borrowed)
    }

    /// Squared residuals of all recordings, and what of them a change of what is shared and of what
    /// belongs to each recording leaves, to first order.
    pub(crate) fn squares_left(&self, shared: &[String]) -> [f64; 2] {
        let each: Vec<Vec<Owned>> =
            (0..self.fits.len()).map(|recording| self.directions(recording, shared)).collect();
        let all = shared.len() + each.iter().map(|it| it.len() - shared.len()).sum::<usize>();
        let mut normal = Normal::new(all);
        let mut first = shared.len();
        for (recording, owned) in each.iter().enumerate() {
            let place = |k: usize| if k < shared.len() { k } else { first + k - shared.len() };
            let places: Vec<usize> = (0..owned.len()).map(place).collect();
            self.with_case(recording, owned, |case, directions| {
                case.blocks(directions, |rows| normal.add(&places, &rows.columns, &rows.residual));
            });
            first += owned.len() - shared.len();
        }
        [normal.squares(), normal.left()]
    }

    /// Rows of every recording for those directions.
    fn rows(&self, directions: impl Fn(usize) -> Vec<Owned>) -> Vec<Rows> {
        let of = |recording: usize| {
            let owned = directions(recording);
            self.with_case(recording, &owned, |case, directions| case.sensitivities(directions))
        };
        (0..self.fits.len()).map(of).collect()
    }
}

/// A direction that owns what it needs.
#[derive(Debug, Clone)]
pub(crate) enum Owned {
    Parameter(String),
    Start { piece: usize, state: usize },
}

impl Owned {
    fn direction(&self) -> Direction<'_> {
        match self {
            Self::Parameter(name) => Direction::Parameter(name),
            Self::Start { piece, state } => Direction::Start { piece: *piece, state: *state },
        }
    }
}

/// Residuals and columns of all recordings.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    /// Where each value was measured.
    pub(crate) places: Vec<Measurement>,
    /// (y - y_model) / sd.
    pub(crate) residual: Vec<f64>,
    /// One row a direction, one column a value.
    pub(crate) columns: DMatrix<f64>,
}

impl Columns {
    /// Of one direction list shared by all recordings.
    pub(crate) fn shared(evidence: &Evidence, rows: &[Rows]) -> Self {
        let directions = rows.first().map_or(0, |rows| rows.columns.nrows());
        let values = rows.iter().map(|rows| rows.residual.len()).sum();
        let mut columns = DMatrix::zeros(directions, values);
        let (mut places, mut residual) = (Vec::with_capacity(values), Vec::with_capacity(values));
        for (recording, rows) in rows.iter().enumerate() {
            columns.columns_mut(places.len(), rows.residual.len()).copy_from(&rows.columns);
            push(&mut places, recording, rows, &evidence.recordings[recording]);
            residual.extend_from_slice(&rows.residual);
        }
        Self { places, residual, columns }
    }

    /// The residuals alone.
    pub(crate) fn residuals(at: &FittedDrive<'_>) -> Self {
        let rows = at.rows(|_| Vec::new());
        Self::shared(at.evidence, &rows)
    }

    /// The base of a fit: its parameters, and what belongs to each recording.
    pub(crate) fn base(at: &FittedDrive<'_>, shared: &[String]) -> Self {
        let counts: Vec<usize> = (0..at.fits.len()).map(|r| at.own(r).count()).collect();
        let rows = at.rows(|recording| at.directions(recording, shared));
        let values = rows.iter().map(|rows| rows.residual.len()).sum();
        let mut columns = DMatrix::zeros(shared.len() + counts.iter().sum::<usize>(), values);
        let (mut places, mut residual) = (Vec::with_capacity(values), Vec::with_capacity(values));
        let mut offset = shared.len();
        for (recording, rows) in rows.iter().enumerate() {
            let (from, n) = (places.len(), rows.residual.len());
            let common = rows.columns.rows(0, shared.len());
            columns.view_mut((0, from), (shared.len(), n)).copy_from(&common);
            let own = rows.columns.rows(shared.len(), counts[recording]);
            columns.view_mut((offset, from), (counts[recording], n)).copy_from(&own);
            offset += counts[recording];
            push(&mut places, recording, rows, &at.evidence.recordings[recording]);
            residual.extend_from_slice(&rows.residual);
        }
        Self { places, residual, columns }
    }
}

fn push(places: &mut Vec<Measurement>, recording: usize, rows: &Rows, measured: &Measured) {
    let of = |(sample, output): (&usize, &usize)| Measurement {
        recording,
        sample: *sample,
        output: measured.outputs[*output].output as usize,
    };
    places.extend(rows.sample.iter().zip(&rows.output).map(of));
}
