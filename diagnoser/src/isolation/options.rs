//! How a classifier is trained, and why that may be refused.

use drivescope_numerics::Limits;
use thiserror::Error;

/// How a classifier is trained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsolatorOptions {
    /// Neurons of both hidden layers.
    pub hidden: [usize; 2],
    /// When a search stops; the paper: 200 steps.
    pub limits: Limits,
    /// Random starts; the one that does best on held-out symptoms is kept.
    pub starts: usize,
    /// Seed of all randomness.
    pub seed: u64,
    /// Share of the learning samples that the gate may call unknown.
    pub outside: f64,
}

impl Default for IsolatorOptions {
    fn default() -> Self {
        let limits = Limits { steps: 200, relative_decrease: 1e-8 };
        Self { hidden: [15, 10], limits, starts: 4, seed: 0, outside: 0.005 }
    }
}

/// Why a classifier cannot be trained.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IsolationError {
    /// The classes do not cover the faults.
    #[error("the classes {classes:?} do not hold each of the {faults} faults once")]
    Classes {
        /// Classes given.
        classes: Vec<Vec<usize>>,
        /// Faults of the symptoms.
        faults: usize,
    },
    /// Held-out symptoms of other faults or signals.
    #[error(
        "held-out symptoms have {faults} faults of {signals} signals, the learning set {expected:?}"
    )]
    HeldOut {
        /// Faults found.
        faults: usize,
        /// Signals found.
        signals: usize,
        /// Faults and signals of the learning set.
        expected: (usize, usize),
    },
    /// A layer without neurons, no start, or a share outside [0, 1).
    #[error(
        "hidden layers {hidden:?} and {starts} starts must be at least 1, a share {outside} of unknown samples below 1"
    )]
    Options {
        /// Hidden neurons asked for.
        hidden: [usize; 2],
        /// Starts asked for.
        starts: usize,
        /// Share asked for.
        outside: f64,
    },
    /// A symptom with other signals than the classifier was trained on.
    #[error("a symptom of {found} finite signals is needed as in training, not {given:?}")]
    Symptom {
        /// Signals of the training.
        found: usize,
        /// The symptom.
        given: Vec<f64>,
    },
}
