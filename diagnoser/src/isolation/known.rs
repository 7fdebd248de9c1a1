//! What a diagnoser knows of faults: their classes (26) and their sizes (27), at work sample by sample.
//!
//! While a fault stands declared, every sample is a symptom (u_1.., r) of its own and gets its own
//! answer. The class named is the one answered most often; "unknown" is an answer like any other,
//! so that a fault that no one showed is called unknown as soon as most of its symptoms lie where
//! none were seen.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::isolator::{Isolated, Isolator};
use super::options::IsolationError;
use crate::identification::{Size, size_groups, thresholds_off};
use crate::memory::{Memory, MemoryError, Walk};
use crate::threshold::Band;

/// The faults that a diagnoser was shown, in the form they are stored in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownFaults {
    /// S (27) of every fault in constant thresholds, in the order of the isolator's faults.
    pub sizes: Vec<f64>,
    /// Classes of faults and the classifier; its signals are the inputs and the residual.
    pub isolator: Isolator,
}

/// What the symptoms of a standing fault come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// The answer given most often; the first of several.
    pub answer: Isolated,
    /// Symptoms answered.
    pub samples: usize,
    /// Share of every class in the answers, in the order of the classes; `unknown` last.
    pub shares: Vec<f64>,
    /// S (27) over these samples.
    pub size: f64,
    /// The group of the known fault whose ln S is nearest.
    pub group: Size,
}

impl KnownFaults {
    /// Names of the faults of a class.
    ///
    /// # Panics
    /// If there is no such class.
    pub fn class(&self, class: usize) -> Vec<&str> {
        let faults = self.isolator.partition.classes[class].iter();
        faults.map(|fault| self.isolator.faults[*fault].as_str()).collect()
    }

    /// The group of every known fault, in their order.
    pub fn groups(&self) -> Vec<Size> {
        size_groups(&self.sizes)
    }

    /// Whether the parts fit together and that many input signals, all numbers finite.
    pub fn is_valid(&self, inputs: usize) -> bool {
        self.isolator.is_valid()
            && self.isolator.scales.len() == inputs + 1
            && self.sizes.len() == self.isolator.faults.len()
            && self.sizes.iter().all(|size| size.is_finite() && *size > 0.0)
    }

    fn group(&self, size: f64) -> Size {
        let off = |known: &f64| (size / known).ln().abs();
        let nearest =
            self.sizes.iter().zip(self.groups()).min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
        nearest.map_or(Size::Small, |(_, group)| group)
    }
}

/// Counts the answers to the symptoms of one fault, in memory that does not grow.
#[derive(Debug, Clone)]
pub struct Naming {
    known: Arc<KnownFaults>,
    /// Constant thresholds: the T of (27).
    threshold: Band,
    /// Answers by class, `unknown` last.
    answers: Vec<usize>,
    /// Sum of |r| / T.
    thresholds: f64,
}

impl Naming {
    /// Nothing counted yet.
    pub fn new(known: Arc<KnownFaults>, threshold: Band) -> Self {
        let answers = vec![0; known.isolator.partition.classes.len() + 1];
        Self { known, threshold, answers, thresholds: 0.0 }
    }

    /// Takes inputs and residual of the process model at a sample at which a fault stands declared.
    pub fn step(&mut self, u: &[f64], residual: f64) -> Result<Isolated, IsolationError> {
        let symptom: Vec<f64> = u.iter().copied().chain([residual]).collect();
        let answer = self.known.isolator.answer(&symptom)?;
        let unknown = self.answers.len() - 1;
        self.answers[match answer {
            Isolated::Class(class) => class,
            Isolated::Unknown => unknown,
        }] += 1;
        self.thresholds += thresholds_off(residual, &self.threshold);
        Ok(answer)
    }

    /// What the symptoms so far come to; none before the first.
    pub fn named(&self) -> Option<Named> {
        let samples: usize = self.answers.iter().sum();
        if samples == 0 {
            return None;
        }
        let unknown = self.answers.len() - 1;
        let most = (0..=unknown)
            .fold(0, |best, i| if self.answers[i] > self.answers[best] { i } else { best });
        let size = self.thresholds / samples as f64;
        Some(Named {
            answer: if most == unknown { Isolated::Unknown } else { Isolated::Class(most) },
            samples,
            shares: self.answers.iter().map(|count| *count as f64 / samples as f64).collect(),
            size,
            group: self.known.group(size),
        })
    }
}

impl Memory for Naming {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(&mut self.answers)?;
        self.thresholds.walk(walk)
    }
}
