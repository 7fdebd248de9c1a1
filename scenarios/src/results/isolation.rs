//! Which fault it is, and how large.

/// Size of a fault relative to the others.
pub use drivescope_diagnoser::Size as SizeGroup;
use serde::{Deserialize, Serialize};

use super::FaultName;

/// Symptoms of one fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SymptomPoints {
    pub fault: FaultName,
    /// (C_m, r), V and unit of T.
    pub points: Vec<[f64; 2]>,
}

/// Two faults that share a class, by their names.
pub type Pair = [String; 2];

/// How often two faults came out inseparable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Merge {
    /// The two.
    pub faults: Pair,
    /// Draws in which they shared a class.
    pub draws: usize,
}

/// Which faults can be told apart by their symptoms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeparabilitySummary {
    /// Share of samples of a fault taken for another from which on the two share a class.
    pub limit: f64,
    /// Draws of the noise that the test was made on.
    pub draws: usize,
    /// Share of samples of fault i taken for fault j, faults in the order of `symptoms`: the mean
    /// over the draws, which the classes come from.
    pub confusion: Vec<Vec<f64>>,
    /// Every pair that shared a class in any of the draws.
    pub merges: Vec<Merge>,
    /// Share of the variance of r over all symptoms that a cubic in C_m explains.
    pub explained: f64,
    /// Our classes, by the names of their faults.
    pub classes: Vec<Vec<String>>,
    pub classes_paper: Vec<Vec<String>>,
    /// Pairs that share a class here and not in the paper.
    pub merged_only_here: Vec<Pair>,
    /// Pairs that share a class in the paper and not here.
    pub merged_only_in_paper: Vec<Pair>,
}

/// Answers of a classifier to samples of every fault that it was not trained on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IsolationTable {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// Names of the faults, a row each.
    pub faults: Vec<String>,
    /// Shares: rows true faults, columns answered classes, the last column `unknown`.
    pub matrix: Vec<Vec<f64>>,
    /// Class of each fault.
    pub class_of: Vec<usize>,
    /// Share of the same samples of each fault that a quadratic discriminant, learned on the same
    /// symptoms as the classifier, puts into its class.
    pub discriminant: Vec<f64>,
}

impl IsolationTable {
    /// Share of the samples of a fault that were answered with its class.
    pub fn right(&self, fault: usize) -> f64 {
        let row = self.matrix.get(fault).zip(self.class_of.get(fault));
        row.and_then(|(row, class)| row.get(*class).copied()).unwrap_or(f64::NAN)
    }
}

/// Size of a symptom (27).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdentificationRow {
    pub fault: FaultName,
    /// Mean of |r| over the constant threshold while the fault acts.
    #[serde(rename = "S")]
    pub s: f64,
    #[serde(rename = "S_paper")]
    pub s_paper: f64,
    /// Its group among the twelve.
    pub group: SizeGroup,
    pub group_paper: SizeGroup,
}
