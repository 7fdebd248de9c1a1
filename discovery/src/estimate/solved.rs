//! A solution of the search with what is known of its errors.

use drivescope_plant::drive::Drive;
use nalgebra::DMatrix;

use super::problem::Problem;
use super::scale::Reach;
use super::search::Found;
use super::uncertainty;
use super::unknowns::Unknown;
use super::{Estimate, Fit};
use crate::case::Squares;

/// How well a solution is known.
pub(super) struct Solved<'a> {
    problem: &'a Problem<'a>,
    found: &'a Found,
    /// In coordinates; infinite where the information is singular.
    pub(super) covariance: DMatrix<f64>,
    pub(super) block_s: f64,
    /// Squared errors of each recording.
    squares: Vec<Squares>,
}

impl<'a> Solved<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, found: &'a Found) -> Self {
        let unknowns = found.coordinates.len();
        let freedom = problem.evidence.values().saturating_sub(unknowns).max(1) as f64;
        let variance = found.at.sse / freedom;
        let (block_s, squares) = problem.block_s(&found.coordinates);
        let scores = problem.scores(&found.coordinates, block_s);
        let covariance = uncertainty::covariance(&found.at.normal_matrix, variance, &scores)
            .unwrap_or_else(|| DMatrix::from_element(unknowns, unknowns, f64::INFINITY));
        Self { problem, found, covariance, block_s, squares }
    }

    fn std_error(&self, k: usize) -> f64 {
        let slope = self.problem.unknowns.scales[k].slope(self.found.coordinates[k]);
        slope * self.covariance[(k, k)].sqrt()
    }

    /// The estimate of unknown `k`, a parameter of that name; `base` knows what it was.
    pub(super) fn estimate(&self, k: usize, name: &str, base: &Drive) -> Estimate {
        let all = base.parameters();
        let known = all.iter().find(|it| it.name == name).expect("a parameter of the drive");
        let (scale, coordinate) = (&self.problem.unknowns.scales[k], self.found.coordinates[k]);
        let Reach { low, high, .. } = scale.reach;
        let at_bound = coordinate <= low || coordinate >= high;
        Estimate {
            name: name.to_owned(),
            value: scale.value(coordinate),
            std_error: if at_bound { f64::NAN } else { self.std_error(k) },
            before: known.value,
            unit: known.unit.clone(),
            at_bound,
        }
    }

    /// What belongs to each recording.
    pub(super) fn recordings(&self, base: &Drive) -> Vec<Fit> {
        let unknowns = &self.problem.unknowns;
        let of = |(number, squares): (usize, &Squares)| {
            let own = unknowns.all.iter().enumerate().filter_map(|(k, unknown)| match unknown {
                Unknown::Own { recording, name } if *recording == number => {
                    Some(self.estimate(k, name, base))
                }
                _ => None,
            });
            let starts = unknowns.at(self.problem.base, number, &self.found.coordinates).1;
            Fit { own: own.collect(), starts, squares: *squares }
        };
        self.squares.iter().enumerate().map(of).collect()
    }
}

/// What belongs to each recording where nothing but starts was estimated.
pub(super) fn started(problem: &Problem<'_>, found: &Found) -> Vec<Fit> {
    let of = |(number, squares): (usize, Squares)| {
        let starts = problem.unknowns.at(problem.base, number, &found.coordinates).1;
        Fit { own: vec![], starts, squares }
    };
    problem.squares(&found.coordinates).into_iter().enumerate().map(of).collect()
}
