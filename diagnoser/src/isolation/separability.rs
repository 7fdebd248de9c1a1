//! Which faults can be told apart, and the classes that are left.
//!
//! Our own test: two faults are separable if a quadratic discriminant (each fault a normal
//! distribution of its symptoms) confuses no more than a stated share of the samples of either.
//! It is cross-validated: fitted on every other sample and judged on the rest, and the other way
//! round. Faults that are not separable share a class, and so does what each of them is
//! inseparable from. The classes are then compared with those that others drew up.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::symptoms::{FaultSymptoms, Symptoms};

/// Ridge on a covariance, as a share of its trace: signals may be tied by an equation.
const RIDGE: f64 = 1e-9;

/// Normal distribution of the symptoms of one fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cloud {
    pub mean: Vec<f64>,
    /// Inverse of the covariance's lower Cholesky factor, row by row.
    pub whitening: Vec<Vec<f64>>,
}

impl Cloud {
    /// Mean and covariance of samples.
    pub(super) fn of<'a>(samples: impl Iterator<Item = &'a Vec<f64>> + Clone) -> Self {
        let n = samples.clone().count() as f64;
        let d = samples.clone().next().map_or(0, Vec::len);
        let mut mean = DVector::<f64>::zeros(d);
        samples.clone().for_each(|x| mean += DVector::from_column_slice(x) / n);
        let mut covariance = DMatrix::<f64>::zeros(d, d);
        for x in samples {
            let off = DVector::from_column_slice(x) - &mean;
            covariance += &off * off.transpose() / (n - 1.0);
        }
        let ridge = RIDGE * covariance.trace() + f64::MIN_POSITIVE.sqrt();
        covariance += DMatrix::identity(d, d) * ridge;
        let identity = DMatrix::identity(d, d);
        // With the ridge the covariance is definite unless something overflowed.
        let whitening = covariance
            .cholesky()
            .and_then(|factor| factor.l().solve_lower_triangular(&identity))
            .unwrap_or(identity);
        let whitening = whitening.row_iter().map(|row| row.iter().copied().collect()).collect();
        Self { mean: mean.as_slice().to_vec(), whitening }
    }

    /// Squared Mahalanobis distance of a sample.
    pub fn distance(&self, x: &[f64]) -> f64 {
        let off: Vec<f64> = x.iter().zip(&self.mean).map(|(x, mean)| x - mean).collect();
        let along = |row: &Vec<f64>| row.iter().zip(&off).map(|(w, x)| w * x).sum::<f64>();
        self.whitening.iter().map(|row| along(row).powi(2)).sum()
    }

    /// -2 ln density, up to a constant.
    fn surprise(&self, x: &[f64]) -> f64 {
        let diagonal = self.whitening.iter().enumerate().map(|(i, row)| row[i]);
        self.distance(x) - 2.0 * diagonal.map(f64::ln).sum::<f64>()
    }
}

/// Faults grouped into classes; every fault is in one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Partition {
    /// Indices of faults; ascending within a class, classes by their first fault.
    pub classes: Vec<Vec<usize>>,
}

impl Partition {
    /// Every fault a class of its own.
    pub fn singletons(faults: usize) -> Self {
        Self { classes: (0..faults).map(|fault| vec![fault]).collect() }
    }

    /// The paper's ten classes of its twelve faults f_1..6^1, f_1..6^2: C_1 = {f_1^1, f_6^2},
    /// C_2 = {f_2^1, f_5^2}, every other fault alone.
    pub fn paper() -> Self {
        let alone = (2..10).map(|fault| vec![fault]);
        Self { classes: [vec![0, 11], vec![1, 10]].into_iter().chain(alone).collect() }
    }

    /// Whether every one of `faults` faults is in exactly one class.
    pub fn covers(&self, faults: usize) -> bool {
        let mut seen: Vec<usize> = self.classes.iter().flatten().copied().collect();
        seen.sort_unstable();
        seen == (0..faults).collect::<Vec<_>>() && self.classes.iter().all(|c| !c.is_empty())
    }

    /// Class of a fault.
    pub fn class_of(&self, fault: usize) -> Option<usize> {
        self.classes.iter().position(|class| class.contains(&fault))
    }

    /// Pairs of faults that share a class.
    pub fn merged(&self) -> Vec<(usize, usize)> {
        let pairs = self.classes.iter().flat_map(|class| {
            let later = move |i: usize| class[i + 1..].iter().map(move |b| (class[i], *b));
            (0..class.len()).flat_map(later)
        });
        pairs.collect()
    }

    /// Pairs of faults that share a class here and not in the other partition.
    pub fn merged_only_here(&self, other: &Self) -> Vec<(usize, usize)> {
        let apart = |(a, b): &(usize, usize)| other.class_of(*a) != other.class_of(*b);
        self.merged().into_iter().filter(apart).collect()
    }
}

/// Outcome of the test.
#[derive(Debug, Clone, PartialEq)]
pub struct Separability {
    /// Share of samples of fault i taken for fault j when only these two are asked for.
    pub confusion: Vec<Vec<f64>>,
    /// Classes of what could not be separated.
    pub partition: Partition,
}

impl Separability {
    /// Confusion from which on two faults share a class: the paper is content with 90 % recognition.
    pub const LIMIT: f64 = 0.1;

    /// Tests all pairs; two faults are inseparable if more than `limit` of the samples of either are
    /// taken for the other.
    pub fn test(symptoms: &Symptoms, limit: f64) -> Self {
        let faults = symptoms.faults();
        let half = |fault: usize, part: usize| faults[fault].samples.iter().skip(part).step_by(2);
        let clouds: Vec<[Cloud; 2]> = (0..faults.len())
            .map(|fault| [0, 1].map(|part| Cloud::of(half(fault, part))))
            .collect();
        let confused = |i: usize, j: usize| {
            let wrong = |part: usize| {
                let (own, other) = (&clouds[i][1 - part], &clouds[j][1 - part]);
                half(i, part).filter(|x| other.surprise(x) < own.surprise(x)).count()
            };
            (wrong(0) + wrong(1)) as f64 / faults[i].samples.len() as f64
        };
        let confusion: Vec<Vec<f64>> = (0..faults.len())
            .map(|i| (0..faults.len()).map(|j| if i == j { 0.0 } else { confused(i, j) }).collect())
            .collect();
        Self::of(confusion, limit)
    }

    /// The test on the mean confusion of several tests of the same faults: one draw of the noise
    /// leaves a confusion near the limit on either side of it.
    ///
    /// # Panics
    /// If the tests are of different numbers of faults.
    pub fn pooled(tests: &[Self], limit: f64) -> Self {
        let faults = tests.first().map_or(0, |test| test.confusion.len());
        let mean = |i: usize, j: usize| {
            tests.iter().map(|test| test.confusion[i][j]).sum::<f64>() / tests.len() as f64
        };
        let confusion = (0..faults).map(|i| (0..faults).map(|j| mean(i, j)).collect()).collect();
        Self::of(confusion, limit)
    }

    /// Classes as connected components: the smallest fault that each is tied to.
    fn of(confusion: Vec<Vec<f64>>, limit: f64) -> Self {
        let faults = confusion.len();
        let mut first: Vec<usize> = (0..faults).collect();
        for i in 0..faults {
            for j in 0..i {
                if confusion[i][j] > limit || confusion[j][i] > limit {
                    let (from, to) = (first[i].max(first[j]), first[i].min(first[j]));
                    first.iter_mut().filter(|f| **f == from).for_each(|f| *f = to);
                }
            }
        }
        let members = |class: usize| -> Vec<usize> {
            (0..faults).filter(|fault| first[*fault] == class).collect()
        };
        let classes = (0..faults).filter(|f| first[*f] == *f).map(members).collect();
        Self { confusion, partition: Partition { classes } }
    }
}

/// A quadratic discriminant: every fault a normal distribution of its symptoms.
#[derive(Debug, Clone, PartialEq)]
pub struct Discriminant {
    clouds: Vec<Cloud>,
}

impl Discriminant {
    /// Over the learning symptoms of every fault.
    pub fn of(learning: &Symptoms) -> Self {
        let cloud = |fault: &FaultSymptoms| Cloud::of(fault.samples.iter());
        Self { clouds: learning.faults().iter().map(cloud).collect() }
    }

    /// The likeliest fault.
    pub fn answer(&self, symptom: &[f64]) -> Option<usize> {
        let surprise = |fault: &usize| self.clouds[*fault].surprise(symptom);
        (0..self.clouds.len()).min_by(|a, b| surprise(a).total_cmp(&surprise(b)))
    }
}

/// Share of fresh symptoms of every fault for which the most likely fault is of its class, each
/// fault normally distributed as its learning symptoms are: what the symptoms allow a classifier of
/// another kind.
///
/// # Panics
/// If the fresh symptoms are of other faults than the learning ones or the classes.
pub fn discriminant(learning: &Symptoms, fresh: &Symptoms, partition: &Partition) -> Vec<f64> {
    let discriminant = Discriminant::of(learning);
    let likely = |x: &Vec<f64>| discriminant.answer(x);
    let right = |(fault, symptoms): (usize, &FaultSymptoms)| {
        let class = partition.class_of(fault);
        let hit = |x: &&Vec<f64>| likely(x).and_then(|answer| partition.class_of(answer)) == class;
        let hits = symptoms.samples.iter().filter(hit).count();
        hits as f64 / symptoms.samples.len() as f64
    };
    fresh.faults().iter().enumerate().map(right).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isolation::testing::{clouds, paper_like};

    #[test]
    fn overlapping_faults_share_a_class_and_others_do_not() {
        let symptoms = paper_like(100, 1);
        let found = Separability::test(&symptoms, Separability::LIMIT);
        assert!(found.confusion[0][11] > 0.2 && found.confusion[0][5] == 0.0);
        assert_eq!(found.partition, Partition::paper());
        assert_eq!(
            found.partition.merged_only_here(&Partition::singletons(12)),
            [(0, 11), (1, 10)]
        );
        assert!(Partition::paper().covers(12) && !Partition::paper().covers(11));
    }

    #[test]
    fn several_draws_are_pooled() {
        let draws: Vec<Separability> = (10..20)
            .map(|seed| Separability::test(&paper_like(20, seed), Separability::LIMIT))
            .collect();
        let pooled = Separability::pooled(&draws, Separability::LIMIT);
        assert_eq!(pooled.partition, Partition::paper());
        let mean = draws.iter().map(|draw| draw.confusion[11][0]).sum::<f64>() / 10.0;
        assert!((pooled.confusion[11][0] - mean).abs() < 1e-12);
    }

    #[test]
    fn a_discriminant_tells_classes_and_not_what_is_merged() {
        let (learning, fresh) = (paper_like(100, 1), paper_like(200, 2));
        let merged = discriminant(&learning, &fresh, &Partition::paper());
        assert!(merged.iter().all(|share| *share > 0.95), "{merged:?}");
        let alone = discriminant(&learning, &fresh, &Partition::singletons(12));
        assert!(alone[0].min(alone[11]) < 0.8 && alone[5] > 0.99, "{alone:?}");
    }

    #[test]
    fn a_chain_of_neighbours_is_one_class() {
        // Each overlaps the next; the ends do not overlap.
        let chain = clouds(&[[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [20.0, 0.0]], 200, 2);
        let found = Separability::test(&chain, Separability::LIMIT);
        assert!(found.confusion[0][2] < 0.1);
        assert_eq!(found.partition.classes, [vec![0, 1, 2], vec![3]]);
    }

    #[test]
    fn distances_are_those_of_mahalanobis() {
        let samples = [vec![1.0, 0.0], vec![-1.0, 0.0], vec![0.0, 2.0], vec![0.0, -2.0]];
        let cloud = Cloud::of(samples.iter());
        // Covariance diag(2, 8) / 3.
        assert!((cloud.distance(&[1.0, 2.0]) - (1.5 + 1.5)).abs() < 1e-6);
    }
}
