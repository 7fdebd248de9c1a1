//! The sum of squares over all recordings, its derivatives, and what its blocks of time add.

use drivescope_numerics::{Linearisation, Residuals};
use drivescope_plant::drive::Drive;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::Evidence;
use super::uncertainty::{BlockScore, block_s};
use super::unknowns::{Unknown, Unknowns};
use crate::case::{Case, Setting, Squares};
use crate::sensitivity::{Direction, Rows};

/// Errors of all recordings over the unknowns.
pub(crate) struct Problem<'a> {
    pub(crate) base: &'a Drive,
    pub(crate) evidence: &'a Evidence,
    pub(crate) setting: &'a Setting,
    pub(crate) unknowns: Unknowns,
}

impl Problem<'_> {
    /// A recording's case at those coordinates, handed to the function.
    pub(crate) fn with_case<T>(
        &self,
        number: usize,
        coordinates: &[f64],
        then: impl FnOnce(&Case<'_>) -> T,
    ) -> T {
        let (drive, starts) = self.unknowns.at(self.base, number, coordinates);
        then(&self.evidence.case(number, &drive, &starts, self.setting))
    }

    /// Squared errors of each recording.
    pub(crate) fn squares(&self, coordinates: &[f64]) -> Vec<Squares> {
        let recordings = 0..self.evidence.recordings.len();
        recordings
            .into_par_iter()
            .map(|number| self.with_case(number, coordinates, |case| case.squares()))
            .collect()
    }

    /// Blocks of rows of a recording with the numbers of the unknowns; columns are d y_model by
    /// the coordinates, in units of the noise.
    fn blocks(&self, number: usize, coordinates: &[f64], mut visit: impl FnMut(&[usize], &Rows)) {
        let numbers = self.unknowns.of_recording(number);
        let directions: Vec<Direction<'_>> = numbers
            .iter()
            .map(|k| match &self.unknowns.all[*k] {
                Unknown::Shared(name) | Unknown::Own { name, .. } => Direction::Parameter(name),
                Unknown::Start { piece, state, .. } => {
                    Direction::Start { piece: *piece, state: *state }
                }
            })
            .collect();
        let slope = |k: &usize| self.unknowns.scales[*k].slope(coordinates[*k]);
        let slopes: Vec<f64> = numbers.iter().map(slope).collect();
        self.with_case(number, coordinates, |case| {
            case.blocks(&directions, |rows| {
                for (mut row, slope) in rows.columns.row_iter_mut().zip(&slopes) {
                    row *= *slope;
                }
                visit(&numbers, rows);
            });
        });
    }

    /// A length of blocks, s, beyond the memory of what is left at those coordinates, and the
    /// squared errors of each recording there.
    pub(crate) fn block_s(&self, coordinates: &[f64]) -> (f64, Vec<Squares>) {
        let recordings = 0..self.evidence.recordings.len();
        let residuals: Vec<(Vec<Vec<f64>>, f64)> = recordings
            .map(|number| {
                let residuals = self.with_case(number, coordinates, |case| case.residuals());
                (residuals, self.evidence.recordings[number].period_s)
            })
            .collect();
        let each = residuals.iter().flat_map(|(residuals, period_s)| {
            residuals.iter().map(|residual| (residual.as_slice(), *period_s))
        });
        let lengths = self.evidence.recordings.iter().map(|it| it.len() as f64 * it.period_s);
        let block_s = block_s(each, lengths.sum(), coordinates.len());
        let squares = |(residuals, _): &(Vec<Vec<f64>>, f64)| Squares::of(residuals);
        (block_s, residuals.iter().map(squares).collect())
    }

    /// Gradient and curvature by blocks of time.
    pub(crate) fn scores(&self, coordinates: &[f64], block_s: f64) -> Vec<BlockScore> {
        let unknowns = self.unknowns.all.len();
        let mut scores: Vec<BlockScore> = Vec::new();
        for (number, measured) in self.evidence.recordings.iter().enumerate() {
            let before = scores.len();
            let samples = ((block_s / measured.period_s).round() as usize).max(1);
            self.blocks(number, coordinates, |numbers, rows| {
                for (row, sample) in rows.sample.iter().enumerate() {
                    let block = before + sample / samples;
                    while scores.len() <= block {
                        let (gradient, normal_matrix) =
                            (DVector::zeros(unknowns), DMatrix::zeros(unknowns, unknowns));
                        scores.push(BlockScore { gradient, normal_matrix });
                    }
                    let score = &mut scores[block];
                    let column = rows.columns.column(row);
                    for (a, &j) in numbers.iter().enumerate() {
                        score.gradient[j] += column[a] * rows.residual[row];
                        for (b, &k) in numbers.iter().enumerate().take(a + 1) {
                            score.normal_matrix[(j, k)] += column[a] * column[b];
                        }
                    }
                }
            });
        }
        for score in &mut scores {
            score.normal_matrix.fill_upper_triangle_with_lower_triangle();
        }
        scores
    }

    /// What the guesses of the starts add to the sum of squares.
    fn prior(&self, coordinates: &[f64]) -> f64 {
        let each = coordinates.iter().zip(&self.unknowns.guess).zip(&self.unknowns.weights);
        each.map(|((q, guess), weight)| (weight * (q - guess)).powi(2)).sum()
    }
}

impl Residuals for Problem<'_> {
    fn sse(&self, coordinates: &[f64]) -> f64 {
        let recordings: f64 = self.squares(coordinates).iter().map(|squares| squares.sum).sum();
        recordings + self.prior(coordinates)
    }

    fn linearise(&self, coordinates: &[f64]) -> Linearisation {
        let unknowns = self.unknowns.all.len();
        let mut all = Linearisation::new(unknowns);
        let of = |number: usize| {
            let mut one = Linearisation::new(self.unknowns.of_recording(number).len());
            self.blocks(number, coordinates, |_, rows| one.add(&rows.columns, &rows.residual));
            one
        };
        let recordings = 0..self.evidence.recordings.len();
        // Side by side, and summed in their order: the same bytes on any number of threads.
        let each: Vec<Linearisation> = recordings.into_par_iter().map(of).collect();
        for (number, one) in each.iter().enumerate() {
            all.sse += one.sse;
            for (a, &j) in self.unknowns.of_recording(number).iter().enumerate() {
                // The residual falls as the model's output rises.
                all.gradient[j] -= one.gradient[a];
                for (b, &k) in self.unknowns.of_recording(number).iter().enumerate() {
                    all.normal_matrix[(j, k)] += one.normal_matrix[(a, b)];
                }
            }
        }
        all.sse += self.prior(coordinates);
        for k in 0..unknowns {
            let weight = self.unknowns.weights[k].powi(2);
            all.gradient[k] += weight * (coordinates[k] - self.unknowns.guess[k]);
            all.normal_matrix[(k, k)] += weight;
        }
        let finite = all.sse.is_finite() && all.normal_matrix.iter().all(|value| value.is_finite());
        Linearisation { sse: if finite { all.sse } else { f64::INFINITY }, ..all }
    }
}
