//! Exact derivatives of what the sensors show, along the run and through its stick-slip events.
//!
//! With y the outputs of the corrected run of [`crate::run`] and c a [`Direction`], the column is
//! d y / d c over the noise's standard deviation, so that residual = sum c_j column_j + noise to
//! first order. Directions are parameters, states at the beginning, and known series that are
//! added to a balance: the response to a torque series b is what a missing law b(t) would do.
//!
//! Derivatives come in passes of a few directions each, as duals. All passes advance together, on as
//! many threads as there are, by blocks of samples, so that memory depends on the length of a block and
//! not of the recording.

mod passes;

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::case::Case;
use passes::{Part, Pass, passes};

/// Samples in a block.
pub const BLOCK: usize = 1024;

/// What the outputs are differentiated by.
#[derive(Debug, Clone, PartialEq)]
pub enum Direction<'a> {
    /// A parameter by its name (`R`, `coulomb.T_c`); a tied K_m follows K_e.
    Parameter(&'a str),
    /// The beginning of a piece: by its number among its values.
    Start {
        /// Which piece of the recording.
        piece: usize,
        /// Which number.
        state: usize,
    },
    /// The factor of a torque series, N m (N), positive forward, one value a sample, held.
    Torque(&'a [f64]),
    /// The factor of a voltage series in the armature circuit, V (force-driven: units of u).
    Voltage(&'a [f64]),
}

/// The measured values of a block of samples, in the order of samples, then outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Sample of each row.
    pub sample: Vec<usize>,
    /// Output of each row, by its place in [`crate::Measured::outputs`].
    pub output: Vec<usize>,
    /// (y - y_model) / sd of each row.
    pub residual: Vec<f64>,
    /// d y_model / d c / sd: one row a direction, one column a measured value.
    pub columns: DMatrix<f64>,
}

impl<'a> Case<'a> {
    /// Residuals and columns, block by block of [`BLOCK`] samples, in order; what is not measured
    /// is left out. Where the model overflows, so do the residuals. The rows are the visitor's to
    /// change.
    pub fn blocks(&self, directions: &'a [Direction<'a>], mut visit: impl FnMut(&mut Rows)) {
        let mut passes = passes(self, directions);
        let samples: Vec<usize> = self.measured.pieces.iter().cloned().flatten().collect();
        for samples in samples.chunks(BLOCK) {
            visit(&mut self.filled(&mut passes, samples, directions.len()));
        }
    }

    /// The same in one piece, for recordings whose columns fit into memory: 8 bytes a direction
    /// and measured value.
    pub fn sensitivities(&self, directions: &'a [Direction<'a>]) -> Rows {
        let samples: Vec<usize> = self.measured.pieces.iter().cloned().flatten().collect();
        self.filled(&mut passes(self, directions), &samples, directions.len())
    }

    /// Rows of those samples: each pass knows a part, and they run side by side.
    fn filled(
        &self,
        passes: &mut [Box<dyn Pass + '_>],
        samples: &[usize],
        directions: usize,
    ) -> Rows {
        let mut rows = self.rows(samples, directions);
        let values = rows.sample.len();
        let parts: Vec<Part> =
            passes.par_iter_mut().map(|pass| pass.part(self, samples, values)).collect();
        parts.into_iter().for_each(|part| part.put(&mut rows));
        rows
    }

    /// Rows to be filled.
    fn rows(&self, samples: &[usize], directions: usize) -> Rows {
        let mut rows = Rows {
            sample: vec![],
            output: vec![],
            residual: vec![],
            columns: DMatrix::zeros(0, 0),
        };
        for &k in samples {
            for (j, channel) in self.measured.outputs.iter().enumerate() {
                if channel.values[k].is_finite() {
                    rows.sample.push(k);
                    rows.output.push(j);
                }
            }
        }
        rows.residual = vec![0.0; rows.sample.len()];
        rows.columns = DMatrix::zeros(directions, rows.sample.len());
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_plant::drive::EffectData;

    use crate::rig::Rig;
    use crate::start::Start;
    use crate::testing::{bench, dr300};

    /// Central differences through located events, relative to the largest entry of a column.
    const DIFFERENCE: f64 = 2e-4;

    fn relative(
        case: &Case<'_>,
        directions: &[Direction<'_>],
        number: usize,
        changed: [&Case<'_>; 2],
        step: f64,
    ) -> f64 {
        let rows = case.sensitivities(directions);
        let [up, down] = changed.map(|case| case.sensitivities(&[]).residual);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for (row, (up, down)) in up.iter().zip(&down).enumerate() {
            let difference = (down - up) / (2.0 * step);
            let column = rows.columns[(number, row)];
            worst = worst.max((difference - column).abs());
            largest = largest.max(column.abs());
        }
        worst / largest
    }

    #[test]
    fn columns_are_the_differences_through_stick_slip() {
        let drive = dr300();
        let recording = bench(&drive, 3.0, 0.001);
        for hz in [0.0, 10.0] {
            let rig = Rig::new(drive.clone(), &recording, &[0.01, 0.3], hz);
            let case = rig.case();
            let names: Vec<String> = drive.fitted().iter().map(|it| it.name.clone()).collect();
            let directions: Vec<Direction<'_>> =
                names.iter().map(|name| Direction::Parameter(name)).collect();
            for (number, name) in names.iter().enumerate() {
                let value = drive.fitted()[number].value;
                let step = 1e-5 * value;
                let at = |value: f64| {
                    let mut other = drive.clone();
                    other.set(name, value).expect("possible");
                    other
                };
                let (up, down) = (at(value + step), at(value - step));
                let changed = [&Case { drive: &up, ..case }, &Case { drive: &down, ..case }];
                let off = relative(&case, &directions, number, changed, step);
                assert!(off < DIFFERENCE, "{name} at {hz} Hz: {off}");
            }
        }
    }

    #[test]
    fn the_column_of_a_delay_is_its_difference() {
        let mut drive = dr300();
        let recording = bench(&drive, 2.0, 0.001);
        let delay = EffectData {
            kind: "delay".into(),
            id: "delay".into(),
            parameters: vec![("tau".into(), 4e-4)],
            law: None,
        };
        drive.effects.push(delay);
        let rig = Rig::new(drive, &recording, &[0.01, 0.3], 0.0);
        let at = |tau: f64| {
            let mut other = rig.drive.clone();
            other.set("delay.tau", tau).expect("possible");
            other
        };
        let (up, down) = (at(4.01e-4), at(3.99e-4));
        let case = rig.case();
        let changed = [&Case { drive: &up, ..case }, &Case { drive: &down, ..case }];
        let off = relative(&case, &[Direction::Parameter("delay.tau")], 0, changed, 1e-6);
        assert!(off < DIFFERENCE, "{off}");
    }

    #[test]
    fn a_series_in_a_balance_is_a_load_or_a_voltage() {
        let drive = dr300();
        let recording = bench(&drive, 2.0, 0.001);
        let rig = Rig::new(drive, &recording, &[0.01, 0.3], 0.0);
        let (case, measured) = (rig.case(), &rig.measured);
        let series: Vec<f64> = (0..measured.len()).map(|k| (0.02 * k as f64).sin()).collect();
        let directions = [Direction::Torque(&series), Direction::Voltage(&series)];
        for (number, step) in [(0, 1e-7), (1, 1e-5)] {
            let at = |factor: f64| {
                let mut other = measured.clone();
                if number == 0 {
                    other.load = Some(series.iter().map(|b| -factor * b).collect());
                } else {
                    other.u = measured.u.iter().zip(&series).map(|(u, b)| u + factor * b).collect();
                }
                other
            };
            let (up, down) = (at(step), at(-step));
            let changed = [&Case { measured: &up, ..case }, &Case { measured: &down, ..case }];
            let off = relative(&case, &directions, number, changed, step);
            assert!(off < DIFFERENCE, "{number}: {off}");
        }
    }

    #[test]
    fn starts_fade_and_blocks_are_the_whole() {
        let drive = dr300();
        let mut recording = bench(&drive, 3.0, 0.001);
        recording.signals[0].values[1400..1420].fill(f64::NAN);
        let mut rig = Rig::new(drive, &recording, &[0.01, 0.3], 0.0);
        rig.starts.fill(Start { current: 0.5, speed: 40.0, ..Start::REST });
        assert_eq!(rig.starts.len(), 2, "a piece each");
        let (case, starts) = (rig.case(), &rig.starts);
        let start = |piece, state| Direction::Start { piece, state };
        let directions = [start(0, 0), Direction::Parameter("R"), start(1, 1), start(1, 0)];
        let whole = case.sensitivities(&directions);
        let mut residual = Vec::new();
        let mut from = 0;
        case.blocks(&directions, |rows| {
            residual.extend_from_slice(&rows.residual);
            let n = rows.residual.len();
            assert_eq!(rows.columns, whole.columns.columns(from, n).into_owned());
            from += n;
        });
        assert_eq!(residual, whole.residual);
        for (number, piece, state) in [(0, 0, 0), (2, 1, 1), (3, 1, 0)] {
            let at = |step: f64| {
                let mut other = starts.clone();
                match state {
                    0 => other[piece].current += step,
                    _ => other[piece].speed += step,
                }
                other
            };
            let (up, down) = (at(1e-4), at(-1e-4));
            let changed = [&Case { starts: &up, ..case }, &Case { starts: &down, ..case }];
            let off = relative(&case, &directions, number, changed, 1e-4);
            assert!(off < DIFFERENCE, "start {number}: {off}");
        }
    }
}
