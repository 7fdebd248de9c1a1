//! Every formula beside the base: what it explains as a column, and which ones are worth a fit.

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::model::{CURRENT, POSITION, SPEED};
use rayon::prelude::*;

use super::grammar::{Form, Names, complexity};
use super::proposals::{Greatest, Kind, names, proposals};
use crate::likelihood::{Alongside, GroupEvidence, Series};

/// Columns that are held at once: some 16 MB at 8,000 samples.
const COLUMNS: usize = 256;

/// A formula with the values that a fit of it begins with, or ended with.
#[derive(Debug, Clone)]
pub(super) struct Valued {
    pub(super) form: Form,
    /// The number of its kind among the proposals.
    pub(super) kind: usize,
    /// ln of the number of formulas that are no more complex: what choosing it costs.
    pub(super) price: f64,
    /// In their own units.
    pub(super) coefficients: Vec<f64>,
}

/// A formula with what it explains, its coefficients the most probable.
#[derive(Debug)]
pub(super) struct Weighed {
    pub(super) valued: Valued,
    /// ln of its evidence over that of the base, averaged over its shapes.
    evidence: f64,
}

/// The variables along the recordings, and what they are called.
pub(super) struct Visited {
    /// Speed, current and position, of each recording and sample.
    runs: Vec<Vec<[f64; 3]>>,
    pub(super) names: Names,
    greatest: Greatest,
}

impl Visited {
    /// Of a drive along those recordings.
    pub(super) fn of(drive: &Drive, alongside: &Alongside) -> Self {
        let force = drive.motor.input == Input::Force;
        let runs: Vec<Vec<[f64; 3]>> = alongside
            .recordings()
            .map(|(it, ticks)| {
                let at = ticks.iter().map(|tick| {
                    let state = &tick.mean;
                    let current = if force { it.measured.u[tick.sample] } else { state[CURRENT] };
                    [state[SPEED], current, state[POSITION]]
                });
                at.collect()
            })
            .collect();
        let all = || runs.iter().flatten();
        let most = |place: usize| all().fold(0.0_f64, |most, it| most.max(it[place].abs()));
        let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| {
            (low.min(it[2]), high.max(it[2]))
        });
        let greatest = Greatest { speed: most(0), current: most(1), travel: (high - low).max(0.0) };
        let names = names(drive, &greatest);
        Self { runs, names, greatest }
    }

    /// Those of one recording.
    #[cfg(test)]
    pub(super) fn along(drive: &Drive, run: Vec<[f64; 3]>, greatest: Greatest) -> Self {
        Self { runs: vec![run], names: names(drive, &greatest), greatest }
    }

    /// Every formula that is tried for the drive.
    pub(super) fn proposals(&self, drive: &Drive) -> Vec<Kind> {
        proposals(drive, &self.greatest)
    }

    /// The greatest speed and current.
    pub(super) fn greatest(&self) -> [f64; 2] {
        [self.greatest.speed, self.greatest.current]
    }

    /// At most so many of the places, evenly.
    pub(super) fn places(&self, most: usize) -> Vec<[f64; 3]> {
        let count: usize = self.runs.iter().map(Vec::len).sum();
        self.runs.iter().flatten().step_by(count.div_ceil(most).max(1)).copied().collect()
    }

    /// Columns of a formula along a recording.
    fn series(&self, form: &Form, recording: usize) -> Vec<Series> {
        let run = &self.runs[recording];
        let mut columns = vec![Vec::with_capacity(run.len()); form.coefficients().len()];
        for at in run {
            let values = form.at(*at, &self.names);
            for (column, value) in columns.iter_mut().zip(values) {
                column.push(value);
            }
        }
        let series = |values: Vec<f64>| match form.target {
            Target::Voltage => Series { voltage: values, ..Series::default() },
            _ => Series { torque: values, ..Series::default() },
        };
        columns.into_iter().map(series).collect()
    }
}

/// Each kind of formula in its best shape, best first: evidence less price. Nothing where it is stopped.
pub(super) fn weighed(
    kinds: &[Kind],
    visited: &Visited,
    alongside: &Alongside,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Weighed>> {
    let forms: Vec<Form> = kinds.iter().flatten().copied().collect();
    let mut groups_evidence: Vec<GroupEvidence> = Vec::with_capacity(forms.len());
    for some in forms.chunks(COLUMNS / 2) {
        let groups: Vec<usize> = some.iter().map(|it| it.coefficients().len()).collect();
        let series = |recording: usize| -> Vec<Series> {
            some.par_iter().flat_map_iter(|it| visited.series(it, recording)).collect()
        };
        groups_evidence.extend(alongside.evidence(series, &groups, stopped)?);
    }
    let sizes: Vec<usize> = kinds.iter().map(|kind| size(kind, &visited.names)).collect();
    let mut groups_evidence = groups_evidence.into_iter();
    let one = |(number, (kind, size)): (usize, (&Kind, &usize))| {
        let own: Vec<GroupEvidence> = groups_evidence.by_ref().take(kind.len()).collect();
        best((number, kind), own, sizes.iter().filter(|it| *it <= size).count())
    };
    let mut all: Vec<Weighed> = kinds.iter().zip(&sizes).enumerate().filter_map(one).collect();
    all.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    Some(all)
}

fn size(kind: &Kind, names: &Names) -> usize {
    kind.first().map_or(0, |form| complexity(&form.written(names).text))
}

fn best(
    (number, kind): (usize, &Kind),
    groups_evidence: Vec<GroupEvidence>,
    as_simple: usize,
) -> Option<Weighed> {
    let shapes = groups_evidence.len() as f64;
    let (form, it) = kind
        .iter()
        .zip(groups_evidence)
        .max_by(|(_, a), (_, b)| a.evidence.total_cmp(&b.evidence))?;
    let price = (as_simple as f64).ln();
    let valued = Valued { form: *form, kind: number, price, coefficients: it.coefficients };
    // Of few shapes that are far apart one holds nearly all of the mean.
    Some(Weighed { valued, evidence: it.evidence - shapes.ln() })
}

impl Weighed {
    /// Evidence less price.
    pub(super) fn worth(&self) -> f64 {
        self.evidence - self.valued.price
    }
}
