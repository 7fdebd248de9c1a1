//! Symptoms for tests: round clouds at given places.

use super::symptoms::{FaultSymptoms, Symptoms};
use crate::testing::noise;

pub(super) fn clouds(centres: &[[f64; 2]], count: usize, seed: u64) -> Symptoms {
    let mut draws = noise(2 * count * centres.len(), seed).into_iter();
    let faults = centres.iter().enumerate().map(|(i, centre)| FaultSymptoms {
        fault: format!("f_{i}"),
        samples: (0..count)
            .map(|_| centre.iter().map(|c| c + draws.next().unwrap()).collect())
            .collect(),
    });
    Symptoms::new(faults.collect()).unwrap()
}

/// Twelve faults on a curve, of which two pairs overlap as in the paper's Fig. 5.
pub(super) fn paper_like(count: usize, seed: u64) -> Symptoms {
    let mut centres: Vec<[f64; 2]> =
        (0..12).map(|i| [8.0 * f64::from(i) - 40.0, 30.0 * (f64::from(i) * 0.7).sin()]).collect();
    centres[11] = [centres[0][0] + 0.8, centres[0][1]];
    centres[10] = [centres[1][0], centres[1][1] + 0.8];
    clouds(&centres, count, seed)
}
