//! A solution of the search with what is known of its errors.

use drivescope_numerics::Residuals;
use drivescope_plant::drive::Drive;
use nalgebra::DMatrix;

use super::problem::Problem;
use super::scale::Reach;
use super::uncertainty;
use super::unknowns::Unknown;
use super::{Estimate, Fit};
use crate::case::Squares;

/// How well a solution is known.
pub(super) struct Solved {
    /// In coordinates; infinite where the information is singular.
    pub(super) covariance: DMatrix<f64>,
    pub(super) block_s: f64,
}

impl Solved {
    pub(super) fn new(problem: &Problem<'_>, found: &[f64]) -> Self {
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

    pub(super) fn estimate(
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
    pub(super) fn recordings(
        &self,
        problem: &Problem<'_>,
        found: &[f64],
        base: &Drive,
    ) -> Vec<Fit> {
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
