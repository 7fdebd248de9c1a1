//! The classifier: perceptron, nearest code (26), and a gate in front of forced answers.
//!
//! j = arg min_i |x - K_i|, x the perceptron's output, K_i the binary code of class i (26). A
//! perceptron answers with some class whatever it is shown. So the symptom must also lie where
//! those of the answered class were: within a Mahalanobis distance of one of its faults that all
//! but a stated share of the learning samples keep to their own fault. Else the answer is unknown.

use drivescope_numerics::{Residuals, minimise};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::mlp::{Mlp, MlpSize};
use super::options::{IsolationError, IsolatorOptions};
use super::separability::{Cloud, Partition};
use super::symptoms::Symptoms;
use super::training::OutputErrors;
use crate::scale::Scale;

/// Fewest bits of a code, as in the paper.
const BITS: usize = 4;
/// Step between the random streams of neighbouring starts.
const STREAM: u128 = 2;

/// What a symptom points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Isolated {
    /// A class of faults, by index.
    Class(usize),
    /// None that the classifier was trained on.
    Unknown,
}

/// Shares of answers: a row a fault, a column a class, the last column `unknown`.
#[derive(Debug, Clone, PartialEq)]
pub struct IsolationMatrix {
    /// Shares; every row sums to 1.
    pub rows: Vec<Vec<f64>>,
}

/// What the training found on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct IsolationReport {
    /// Of every start, the share of right classes on held-out symptoms, gate aside.
    pub starts: Vec<f64>,
    /// The same of the fault that it does worst on.
    pub worst: Vec<f64>,
    /// Index of the best.
    pub best: usize,
    /// Mean squared error of its outputs on the learning set.
    pub mean_square: f64,
}

/// A trained classifier, in the form it is stored in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Isolator {
    /// Names of the faults.
    pub faults: Vec<String>,
    /// Which faults share a class.
    pub partition: Partition,
    /// How each signal is standardised.
    pub scales: Vec<Scale>,
    /// The perceptron.
    pub mlp: Mlp,
    /// Standardised symptoms of every fault.
    pub clouds: Vec<Cloud>,
    /// Largest squared distance from a fault of the answered class.
    pub gate: f64,
}

impl Isolator {
    /// Trains a classifier on symptoms; starts are judged on held-out symptoms of the same faults.
    pub fn train(
        learning: &Symptoms,
        held_out: &Symptoms,
        partition: &Partition,
        options: &IsolatorOptions,
    ) -> Result<(Self, IsolationReport), IsolationError> {
        let &IsolatorOptions { hidden, limits, starts, seed, outside } = options;
        let faults = learning.faults();
        check(learning, held_out, partition, options)?;
        let all = || faults.iter().flat_map(|fault| &fault.samples);
        let scales: Vec<Scale> = (0..learning.signals())
            .map(|signal| Scale::of(&all().map(|sample| sample[signal]).collect::<Vec<_>>()))
            .collect();
        let clouds: Vec<Cloud> = faults
            .iter()
            .map(|fault| {
                let samples: Vec<_> = fault.samples.iter().map(|x| standard(&scales, x)).collect();
                Cloud::of(samples.iter())
            })
            .collect();
        let bits = BITS.max(partition.classes.len().next_power_of_two().ilog2() as usize);
        let size = MlpSize { inputs: learning.signals(), hidden, outputs: bits };
        let inputs: Vec<f64> = all().flat_map(|x| standard(&scales, x)).collect();
        let wanted: Vec<f64> = faults
            .iter()
            .enumerate()
            .flat_map(|(fault, symptoms)| {
                let class = partition.class_of(fault).unwrap_or(0);
                symptoms.samples.iter().flat_map(move |_| code(class, bits))
            })
            .collect();
        let names = faults.iter().map(|fault| fault.fault.clone()).collect();
        let mut distances: Vec<f64> = faults
            .iter()
            .zip(&clouds)
            .flat_map(|(fault, cloud)| {
                fault.samples.iter().map(|x| cloud.distance(&standard(&scales, x)))
            })
            .collect();
        distances.sort_by(f64::total_cmp);
        let kept = ((1.0 - outside) * distances.len() as f64).ceil() as usize;
        let gate = distances[kept.clamp(1, distances.len()) - 1];
        let empty = Mlp { size, weights: vec![0.0; size.parameters()] };
        let partition = partition.clone();
        let mut isolator = Self { faults: names, partition, scales, mlp: empty, clouds, gate };
        let errors = OutputErrors { size, inputs: &inputs, wanted: &wanted };
        let ends: Vec<(Mlp, [f64; 2])> = (0..starts)
            .into_par_iter()
            .map(|index| {
                let mut random = Pcg64::new(u128::from(seed), STREAM * index as u128);
                let start = Mlp::draw(size, || StandardNormal.sample(&mut random));
                let weights = minimise(&errors, &start, limits).parameters;
                let mlp = Mlp { size, weights };
                let shares = isolator.right_shares(&mlp, held_out);
                (mlp, shares)
            })
            .collect();
        let [shares, worst] =
            [0, 1].map(|k| ends.iter().map(|(_, of)| of[k]).collect::<Vec<f64>>());
        // A search can lose a whole class and still be right on most samples, so the worst fault
        // counts as much as the mean. The first of the best: the seed decides, not the order in
        // which starts end.
        let good = |i: usize| shares[i] + worst[i];
        let best = (0..starts).fold(0, |best, i| if good(i) > good(best) { i } else { best });
        isolator.mlp = ends.into_iter().nth(best).map_or(isolator.mlp, |(mlp, _)| mlp);
        let mean_square = errors.sse(&isolator.mlp.weights) / wanted.len() as f64;
        Ok((isolator, IsolationReport { starts: shares, worst, best, mean_square }))
    }

    /// The class with the nearest code (26), or unknown if the symptom lies where none of its
    /// faults was seen.
    pub fn answer(&self, symptom: &[f64]) -> Result<Isolated, IsolationError> {
        let found = self.scales.len();
        if symptom.len() != found || symptom.iter().any(|value| !value.is_finite()) {
            return Err(IsolationError::Symptom { found, given: symptom.to_vec() });
        }
        let x = standard(&self.scales, symptom);
        let class = self.nearest(&self.mlp, &x);
        let members = self.partition.classes[class].iter();
        let nearest =
            members.map(|fault| self.clouds[*fault].distance(&x)).fold(f64::MAX, f64::min);
        Ok(if nearest <= self.gate { Isolated::Class(class) } else { Isolated::Unknown })
    }

    /// Answers to labelled symptoms.
    pub fn matrix(&self, symptoms: &Symptoms) -> Result<IsolationMatrix, IsolationError> {
        let classes = self.partition.classes.len();
        let row = |samples: &Vec<Vec<f64>>| {
            let mut shares = vec![0.0; classes + 1];
            for sample in samples {
                let column = match self.answer(sample)? {
                    Isolated::Class(class) => class,
                    Isolated::Unknown => classes,
                };
                shares[column] += 1.0 / samples.len() as f64;
            }
            Ok(shares)
        };
        let rows = symptoms.faults().iter().map(|fault| row(&fault.samples));
        Ok(IsolationMatrix { rows: rows.collect::<Result<_, _>>()? })
    }

    /// Whether the parts fit together, all numbers finite.
    pub fn is_valid(&self) -> bool {
        let (faults, signals) = (self.faults.len(), self.scales.len());
        let MlpSize { inputs, outputs, .. } = self.mlp.size;
        self.partition.covers(faults)
            && inputs == signals
            && outputs < usize::BITS as usize
            && self.partition.classes.len() <= 1 << outputs
            && self.mlp.weights.len() == self.mlp.size.parameters()
            && self.mlp.weights.iter().all(|weight| weight.is_finite())
            && self.scales.iter().all(Scale::is_usable)
            && self.clouds.len() == faults
            && self.clouds.iter().all(|cloud| {
                cloud.mean.len() == signals && cloud.whitening.iter().all(|w| w.len() == signals)
            })
            && self.gate >= 0.0
    }

    fn nearest(&self, mlp: &Mlp, x: &[f64]) -> usize {
        let y = mlp.outputs(x);
        let distance = |class: usize| -> f64 {
            code(class, y.len()).zip(&y).map(|(k, y)| (k - y) * (k - y)).sum()
        };
        let classes = 0..self.partition.classes.len();
        classes.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0)
    }

    /// Share of all symptoms and of those of the worst fault that are answered right.
    fn right_shares(&self, mlp: &Mlp, symptoms: &Symptoms) -> [f64; 2] {
        let (mut right, mut all, mut worst) = (0, 0, 1.0_f64);
        for (fault, of_fault) in symptoms.faults().iter().enumerate() {
            let class = self.partition.class_of(fault);
            all += of_fault.samples.len();
            let hits = |x: &&Vec<f64>| Some(self.nearest(mlp, &standard(&self.scales, x))) == class;
            let of_this = of_fault.samples.iter().filter(hits).count();
            right += of_this;
            worst = worst.min(of_this as f64 / of_fault.samples.len() as f64);
        }
        [right as f64 / all as f64, worst]
    }
}

impl IsolationMatrix {
    /// Share of every fault's samples that were answered with its class.
    pub fn right(&self, partition: &Partition) -> Vec<f64> {
        let share = |(fault, row): (usize, &Vec<f64>)| {
            partition.class_of(fault).and_then(|class| row.get(class).copied()).unwrap_or(0.0)
        };
        self.rows.iter().enumerate().map(share).collect()
    }

    /// Share of every fault's samples that were answered `unknown`.
    pub fn unknown(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.last().copied().unwrap_or(0.0)).collect()
    }
}

fn check(
    learning: &Symptoms,
    held_out: &Symptoms,
    partition: &Partition,
    options: &IsolatorOptions,
) -> Result<(), IsolationError> {
    let &IsolatorOptions { hidden, starts, outside, .. } = options;
    if hidden.contains(&0) || starts == 0 || !(0.0..1.0).contains(&outside) {
        return Err(IsolationError::Options { hidden, starts, outside });
    }
    let expected = (learning.faults().len(), learning.signals());
    if !partition.covers(expected.0) {
        let (classes, faults) = (partition.classes.clone(), expected.0);
        return Err(IsolationError::Classes { classes, faults });
    }
    let (faults, signals) = (held_out.faults().len(), held_out.signals());
    if (faults, signals) != expected {
        return Err(IsolationError::HeldOut { faults, signals, expected });
    }
    Ok(())
}

fn standard(scales: &[Scale], symptom: &[f64]) -> Vec<f64> {
    scales.iter().zip(symptom).map(|(scale, x)| scale.standardise(*x)).collect()
}

/// K_i: the class in binary, the highest bit first.
fn code(class: usize, bits: usize) -> impl Iterator<Item = f64> {
    (0..bits).rev().map(move |bit| if class >> bit & 1 == 1 { 1.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use drivescope_numerics::Limits;

    use super::*;
    use crate::isolation::FaultSymptoms;
    use crate::isolation::testing::{clouds, paper_like};

    fn quick() -> IsolatorOptions {
        IsolatorOptions {
            starts: 2,
            seed: 3,
            limits: Limits { steps: 60, ..Limits::default() },
            ..IsolatorOptions::default()
        }
    }

    fn trained(partition: &Partition, learning: &Symptoms) -> Isolator {
        Isolator::train(learning, &paper_like(50, 12), partition, &quick()).unwrap().0
    }

    #[test]
    fn merged_classes_are_recognised_and_unmerged_ones_cannot_be() {
        let learning = paper_like(100, 11);
        let fresh = paper_like(400, 13);
        let ten = trained(&Partition::paper(), &learning);
        assert!(ten.is_valid() && ten.mlp.size.parameters() == 249);
        let right = ten.matrix(&fresh).unwrap().right(&ten.partition);
        assert!(right.iter().all(|right| *right > 0.9), "{right:?}");
        let twelve = trained(&Partition::singletons(12), &learning);
        let right = twelve.matrix(&fresh).unwrap().right(&twelve.partition);
        assert!(right[0].min(right[11]) < 0.8, "{right:?}");
        let rows = twelve.matrix(&fresh).unwrap().rows;
        assert!(rows.iter().all(|row| (row.iter().sum::<f64>() - 1.0).abs() < 1e-9));
    }

    #[test]
    fn shuffled_labels_collapse_to_chance() {
        // Every fault is shown the others' symptoms in turn: nothing is left to be learned.
        let learning = paper_like(96, 11);
        let mixed = |fault: usize| FaultSymptoms {
            fault: format!("f_{fault}"),
            samples: (0..96)
                .map(|k| learning.faults()[(fault + k) % 12].samples[k].clone())
                .collect(),
        };
        let shuffled = Symptoms::new((0..12).map(mixed).collect()).unwrap();
        let isolator = trained(&Partition::singletons(12), &shuffled);
        let right = isolator.matrix(&paper_like(200, 13)).unwrap().right(&isolator.partition);
        let mean = right.iter().sum::<f64>() / 12.0;
        assert!(mean < 0.25, "{mean} of {right:?}");
    }

    #[test]
    fn what_was_never_seen_is_unknown_and_what_was_is_not() {
        let learning = paper_like(100, 11);
        let isolator = trained(&Partition::paper(), &learning);
        let strange = clouds(&[[0.0, 70.0], [-60.0, 0.0], [0.0, -60.0], [90.0, 40.0]], 200, 14);
        let unknown = isolator.matrix(&strange).unwrap().unknown();
        assert!(unknown.iter().all(|share| *share > 0.99), "{unknown:?}");
        let known = isolator.matrix(&paper_like(400, 13)).unwrap().unknown();
        let mean = known.iter().sum::<f64>() / 12.0;
        assert!(mean < 0.03, "{mean}");
        // An open gate forces an answer.
        let open = Isolator { gate: f64::INFINITY, ..isolator };
        assert_eq!(open.matrix(&strange).unwrap().unknown(), [0.0; 4]);
    }

    #[test]
    fn the_seed_decides_and_the_threads_do_not() {
        let (learning, held_out) = (paper_like(20, 1), paper_like(20, 2));
        let options =
            IsolatorOptions { limits: Limits { steps: 5, ..Limits::default() }, ..quick() };
        let on = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let options = IsolatorOptions { seed, ..options };
            pool.install(|| Isolator::train(&learning, &held_out, &Partition::paper(), &options))
        };
        assert_eq!(on(1, 7), on(2, 7));
        assert_ne!(on(1, 7), on(1, 8));
    }

    #[test]
    fn unusable_symptoms_and_options_are_refused() {
        let learning = paper_like(20, 1);
        let train = |partition: &Partition, options: &IsolatorOptions| {
            Isolator::train(&learning, &learning, partition, options).unwrap_err()
        };
        let refusal = train(&Partition::singletons(11), &quick());
        assert!(matches!(refusal, IsolationError::Classes { faults: 12, .. }));
        let refusal = train(&Partition::paper(), &IsolatorOptions { starts: 0, ..quick() });
        assert!(matches!(refusal, IsolationError::Options { starts: 0, .. }));
        let few = clouds(&[[0.0, 0.0], [5.0, 0.0]], 20, 1);
        let refusal = Isolator::train(&learning, &few, &Partition::paper(), &quick()).unwrap_err();
        assert!(matches!(refusal, IsolationError::HeldOut { faults: 2, .. }));
        let isolator = trained(&Partition::paper(), &learning);
        assert!(isolator.answer(&[1.0]).is_err() && isolator.answer(&[1.0, f64::NAN]).is_err());
        let mut broken = isolator;
        broken.mlp.weights.pop();
        assert!(!broken.is_valid());
    }
}
