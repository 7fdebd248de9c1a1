//! Which parameters a recording tells, and which only in combination.
//!
//! The information on the parameters (the starts taken out as a Schur complement) is scaled so
//! that 1 is a change by a parameter's own size (or, of one that may have either sign, a change
//! that moves the outputs by as much as they move at all). An eigenvalue 1/s^2 of it then is a combination
//! that is known to the share s; beyond [`UNKNOWN`] it is not known, and of the parameters that
//! take part one is named and kept. This repeats until what remains is known.

use nalgebra::DMatrix;
use serde::Serialize;

/// Standard error, as a share of a parameter's size, from which on it is not known.
const UNKNOWN: f64 = 1.0;
/// Change of a parameter, as a share of its size, that a change of another by all of its size asks
/// for: from this on it takes part in a combination.
const TAKES_PART: f64 = 0.01;
/// Share of the largest part in what is not known from which on a parameter may be the one to
/// keep: keeping it must take something unknown away.
const SUBSTANTIAL: f64 = 0.1;

/// A parameter that the recordings do not tell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotIdentifiable {
    /// Its name.
    pub parameter: String,
    /// The value at which it is kept: that of the drive file.
    pub kept: f64,
    /// Parameters that could change with it and leave every prediction as it is; with none,
    /// nothing in the recordings depends on it.
    pub with: Vec<String>,
}

/// A combination of parameters that is not known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Combination {
    /// The parameter to keep, by its number.
    pub(super) kept: usize,
    /// The others that take part.
    pub(super) with: Vec<usize>,
}

/// Information on the first `parameters` unknowns whatever the others are.
pub(super) fn marginal(information: &DMatrix<f64>, parameters: usize) -> Option<DMatrix<f64>> {
    let others = information.nrows() - parameters;
    let part = |r: usize, c: usize, rows: usize, columns: usize| {
        information.view((r, c), (rows, columns)).into_owned()
    };
    let own = part(0, 0, parameters, parameters);
    if others == 0 {
        return Some(own);
    }
    let mixed = part(parameters, 0, others, parameters);
    let factor = part(parameters, parameters, others, others).cholesky()?;
    Some(&own - mixed.transpose() * factor.solve(&mixed))
}

/// The combinations that are not known. `information` is on parameters each in units of its size;
/// where several could be kept, the earliest in `preference` is.
pub(super) fn unknown(information: &DMatrix<f64>, preference: &[usize]) -> Vec<Combination> {
    let mut remainder: Vec<usize> = (0..information.nrows()).collect();
    let mut found = Vec::new();
    while !remainder.is_empty() {
        let some = information.select_rows(&remainder).select_columns(&remainder);
        let eigen = some.symmetric_eigen();
        let weak = |k: &usize| eigen.eigenvalues[*k] <= 1.0 / (UNKNOWN * UNKNOWN);
        let weak: Vec<usize> = (0..remainder.len()).filter(weak).collect();
        if weak.is_empty() {
            break;
        }
        // Onto all that is not known: single eigenvectors of it are arbitrary.
        let basis = eigen.eigenvectors.select_columns(&weak);
        let onto = &basis * basis.transpose();
        let largest = onto.diagonal().max();
        let substantial = (0..remainder.len()).filter(|k| onto[(*k, *k)] >= SUBSTANTIAL * largest);
        let rank = |k: &usize| preference.iter().position(|wanted| *wanted == remainder[*k]);
        let Some(kept) = substantial.min_by_key(rank) else { break };
        let part = |k: &usize| onto[(*k, kept)].abs() >= TAKES_PART * onto[(kept, kept)];
        let with =
            (0..remainder.len()).filter(|k| *k != kept && part(k)).map(|k| remainder[k]).collect();
        found.push(Combination { kept: remainder[kept], with });
        remainder.remove(kept);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of a made-up problem: a and b known by their sum alone, c by nothing, d well.
    fn information() -> DMatrix<f64> {
        let columns = DMatrix::from_fn(4, 100, |parameter, k| {
            let wave = (0.3 * k as f64).sin();
            match parameter {
                0 | 1 => wave,
                2 => 0.01 * (0.1 * k as f64).cos(),
                _ => (1.7 * k as f64).cos(),
            }
        });
        &columns * columns.transpose() * 10.0
    }

    #[test]
    fn a_sum_is_known_and_its_parts_are_not() {
        let found = unknown(&information(), &[1, 0, 2, 3]);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found.contains(&Combination { kept: 1, with: vec![0] }), "{found:?}");
        assert!(found.contains(&Combination { kept: 2, with: vec![] }), "{found:?}");
        let other = unknown(&information(), &[0, 1, 2, 3]);
        assert!(other.iter().any(|it| it.kept == 0 && it.with == [1]));
    }

    #[test]
    fn what_the_starts_explain_is_no_information() {
        // The third unknown explains all of the first.
        let columns = DMatrix::from_fn(3, 50, |row, k| match row {
            0 | 2 => (0.2 * k as f64).sin(),
            _ => (0.9 * k as f64).sin(),
        });
        let mut all = &columns * columns.transpose();
        all[(2, 2)] += 1e-9;
        let remainder = marginal(&all, 2).expect("it has a factor");
        assert!(remainder[(0, 0)] < 1e-6 && remainder[(1, 1)] > 20.0, "{remainder}");
    }
}
