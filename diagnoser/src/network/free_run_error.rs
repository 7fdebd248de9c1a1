//! The error of a network in free run over segments of standardised signals.

use drivescope_numerics::{Linearisation, Residuals};

use super::Structure;
use super::sensitivity::{Rows, linearise, sse};
use crate::data::{Column, Data};
use crate::scale::Scale;

/// Standardised signals, row after row.
pub(super) struct Standardised {
    inputs: Vec<f64>,
    pub(super) outputs: Vec<f64>,
}

impl Standardised {
    /// The first sample is held for `held` samples before.
    pub(super) fn new(data: &Data, (inputs, outputs): (&[Scale], &[Scale]), held: usize) -> Self {
        Self {
            inputs: interleaved(data.inputs(), inputs, held),
            outputs: interleaved(data.outputs(), outputs, held),
        }
    }

    fn rows(&self, run_up: usize) -> Rows<'_> {
        Rows { inputs: &self.inputs, outputs: &self.outputs, run_up }
    }
}

fn interleaved(columns: &[Column], scales: &[Scale], held: usize) -> Vec<f64> {
    let samples = columns[0].values.len();
    let row = |k: usize| columns.iter().zip(scales).map(move |(c, s)| s.standardise(c.values[k]));
    std::iter::repeat_n(0, held).chain(0..samples).flat_map(row).collect()
}

pub(super) fn rows(segments: &[Standardised], run_up: usize) -> Vec<Rows<'_>> {
    segments.iter().map(|segment| segment.rows(run_up)).collect()
}

/// The free-run error over every segment, as a sum of squares to be made small.
pub(super) struct FreeRunError<'a> {
    pub(super) structure: Structure,
    pub(super) segments: Vec<Rows<'a>>,
}

impl Residuals for FreeRunError<'_> {
    fn sse(&self, values: &[f64]) -> f64 {
        self.segments.iter().map(|rows| sse(self.structure, values, *rows)).sum()
    }

    fn linearise(&self, values: &[f64]) -> Linearisation {
        let each = self.segments.iter().map(|rows| linearise(self.structure, values, *rows));
        let both = |all: Linearisation, one: Linearisation| Linearisation {
            sse: all.sse + one.sse,
            gradient: all.gradient + one.gradient,
            normal_matrix: all.normal_matrix + one.normal_matrix,
        };
        each.reduce(both).unwrap_or_else(|| Linearisation::new(values.len()))
    }
}
