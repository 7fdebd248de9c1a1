//! Columns: what the outputs would do to each unknown, gathered by the [`Layout`].

use super::drive_motion::{DriveMotion, Scales};
use super::layout::Layout;
use super::series::Series;
use super::shape::Shape;
use crate::case::Case;
use crate::measured::Output;
use crate::response::{Forcing, Linearised, respond};
use crate::sensitivity::Direction;

/// Series that are computed together, and fewer of a recording of more samples than [`LONG`]: each has a value
/// a sample.
const TOGETHER: usize = 16;
const TOGETHER_IF_LONG: usize = 8;
const LONG: usize = 250_000;

/// Residuals and the columns of the base: its fitted parameters, then the starts of all pieces.
pub(super) fn base(
    cases: &[Case<'_>],
    layout: &Layout,
    parameters: &[String],
    own: &[String],
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut residual = vec![0.0; layout.rows()];
    let mut columns: Vec<Vec<f64>> = vec![vec![0.0; layout.rows()]; parameters.len()];
    for (place, case) in cases.iter().enumerate() {
        let mut directions: Vec<Direction<'_>> =
            parameters.iter().map(|name| Direction::Parameter(name)).collect();
        directions.extend(own.iter().map(|name| Direction::Parameter(name)));
        for (piece, start) in case.starts.iter().enumerate() {
            let free = start.free_states(case.drive, case.measured, piece).into_iter();
            directions.extend(free.map(|state| Direction::Start { piece, state }));
        }
        // Parameters are shared, everything else belongs to this recording.
        let first = columns.len();
        columns.resize(first + directions.len() - parameters.len(), vec![0.0; layout.rows()]);
        let number = |slot: usize| {
            if slot < parameters.len() { slot } else { first + slot - parameters.len() }
        };
        case.blocks(&directions, |rows| {
            for (at, (k, j)) in rows.sample.iter().zip(&rows.output).enumerate() {
                let row = layout.row(place, *k, *j);
                residual[row] += rows.residual[at];
                for slot in 0..directions.len() {
                    columns[number(slot)][row] += rows.columns[(slot, at)];
                }
            }
        });
    }
    layout.level(&mut residual);
    columns.iter_mut().for_each(|column| layout.level(column));
    (residual, columns)
}

/// What makes the columns of shapes.
pub(super) struct Builder<'a> {
    pub(super) cases: &'a [Case<'a>],
    /// Each of them linearised along its recording, where that fits into memory.
    pub(super) linearised: &'a [Option<Linearised>],
    pub(super) paths: &'a [DriveMotion],
    pub(super) scales: &'a Scales,
    pub(super) layout: &'a Layout,
    pub(super) limit: Option<f64>,
}

impl Builder<'_> {
    /// Columns of each shape.
    pub(super) fn shapes(&self, shapes: &[Shape]) -> Vec<Vec<Vec<f64>>> {
        let wanted: Vec<(Shape, usize)> =
            shapes.iter().flat_map(|it| (0..it.columns()).map(|j| (*it, j))).collect();
        let make = |number: usize, path: &DriveMotion| {
            wanted[number].0.series(wanted[number].1, path, self.scales, self.limit)
        };
        let mut flat = self.columns(wanted.len(), &make).into_iter();
        shapes.iter().map(|it| flat.by_ref().take(it.columns()).collect()).collect()
    }

    /// Columns of series, made when they are needed.
    pub(super) fn columns(
        &self,
        count: usize,
        make: &dyn Fn(usize, &DriveMotion) -> Series,
    ) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; self.layout.rows()]; count];
        for path in self.paths {
            let long = self.cases[path.place].measured.len() > LONG;
            let together = if long { TOGETHER_IF_LONG } else { TOGETHER };
            let mut from = 0;
            while from < count {
                let (mut numbers, mut series) = (Vec::new(), Vec::new());
                while from < count && series.len() < together {
                    let forcing = match make(from, path) {
                        Series::Balance(forcing) => Some(forcing),
                        Series::Shown(output, b) => {
                            self.shown(path.place, output, &b, &mut columns[from])
                        }
                    };
                    numbers.extend(forcing.iter().map(|_| from));
                    series.extend(forcing);
                    from += 1;
                }
                self.respond(path.place, &numbers, &series, &mut columns);
            }
        }
        columns.iter_mut().for_each(|column| self.layout.level(column));
        columns
    }

    /// Adds the responses to torques and voltages, each with the number of its column.
    fn respond(&self, place: usize, numbers: &[usize], series: &[Forcing], all: &mut [Vec<f64>]) {
        let (case, linearised) = (&self.cases[place], self.linearised[place].as_ref());
        respond(linearised, case, series, |response| {
            let row = self.layout.row(place, response.sample, response.output);
            for (number, value) in numbers[response.first..].iter().zip(response.of) {
                all[*number][row] += value;
            }
        });
    }

    /// Adds a sensor's error to its own output. An observer that is fed by that sensor corrects
    /// the speed by the opposite of its gain times the error: as the torque does that is returned.
    fn shown(
        &self,
        place: usize,
        output: Output,
        b: &[f64],
        column: &mut [f64],
    ) -> Option<Forcing> {
        let case = &self.cases[place];
        let measured = case.measured;
        let j = measured.outputs.iter().position(|it| it.output == output)?;
        for k in measured.pieces.iter().cloned().flatten() {
            if measured.outputs[j].values[k].is_finite() {
                column[self.layout.row(place, k, j)] += b[k] / case.noise[j];
            }
        }
        let gains = case.setting.observer.gains(measured).filter(|it| it.output == output)?;
        let factor = -self.scales.inertia * gains.speed / measured.period_s;
        Some(Forcing::torque(b.iter().map(|b| factor * b).collect()))
    }
}
