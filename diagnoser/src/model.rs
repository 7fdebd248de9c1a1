//! Any model that a diagnoser file can hold.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::arx::{Arx, ArxRun};
use crate::gmdh::{Gmdh, GmdhRun};
use crate::memory::{Memory, MemoryError, Walk};
use crate::network::{Network, NetworkRun};
use crate::signal_model::SignalModel;
use crate::stability::{largest_root, time_constant};

/// Time constants in which a model settles; e^-5 is less than a hundredth.
pub(crate) const SETTLED_AFTER: f64 = 5.0;

/// A model as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Model {
    /// A linear difference equation.
    Arx(Arc<Arx>),
    /// A locally recurrent cascade network.
    Network(Arc<Network>),
    /// A GMDH network.
    Gmdh(Arc<Gmdh>),
}

impl Model {
    /// Input and output signals, or `None` if the parts of the model do not fit together.
    pub fn signals(&self) -> Option<(usize, usize)> {
        match self {
            Self::Arx(arx) => Some((arx.b.len(), 1)),
            Self::Network(network) => {
                network.structure().map(|structure| (structure.inputs, structure.outputs))
            }
            Self::Gmdh(gmdh) => gmdh.orders().map(|_| (gmdh.input_scales.len(), 1)),
        }
    }

    /// Whether a free run stays bounded.
    pub fn is_stable(&self) -> bool {
        match self {
            Self::Arx(arx) => arx.is_stable(),
            Self::Network(network) => network.is_stable(),
            Self::Gmdh(gmdh) => gmdh.is_stable(),
        }
    }

    /// Samples in which a free run forgets where it began: five of its slowest time constants.
    pub fn run_up(&self) -> usize {
        let roots: Vec<f64> = match self {
            Self::Arx(arx) => vec![largest_root(&arx.a)],
            Self::Network(network) => network.iir.iter().map(|it| largest_root(&it.a)).collect(),
            Self::Gmdh(gmdh) => gmdh.neurons.iter().map(|it| largest_root(&it.a)).collect(),
        };
        let slowest = roots.into_iter().fold(0.0, f64::max);
        (SETTLED_AFTER * time_constant(slowest)).ceil() as usize
    }

    /// The same model with an output higher by `by`, in its unit, once it has settled.
    pub(crate) fn raised(&self, by: f64) -> Self {
        match self {
            Self::Arx(arx) => {
                let mut arx = Arx::clone(arx);
                arx.constant += by * (1.0 + arx.a.iter().sum::<f64>());
                Self::Arx(Arc::new(arx))
            }
            Self::Network(network) => {
                let mut network = Network::clone(network);
                network.output_scales.iter_mut().for_each(|scale| scale.mean += by);
                Self::Network(Arc::new(network))
            }
            Self::Gmdh(gmdh) => {
                let mut gmdh = Gmdh::clone(gmdh);
                gmdh.output_scale.mean += by;
                Self::Gmdh(Arc::new(gmdh))
            }
        }
    }

    /// A free run from rest.
    ///
    /// # Panics
    /// If the parts do not fit together ([`Model::signals`] is `None`).
    pub fn run(&self) -> ModelRun {
        match self {
            Self::Arx(arx) => ModelRun::Arx(arx.run()),
            Self::Network(network) => ModelRun::Network(network.run()),
            Self::Gmdh(gmdh) => ModelRun::Gmdh(gmdh.run()),
        }
    }
}

/// A stored model in free run.
#[derive(Debug, Clone)]
pub enum ModelRun {
    /// A linear difference equation.
    Arx(ArxRun),
    /// A locally recurrent cascade network.
    Network(NetworkRun),
    /// A GMDH network.
    Gmdh(GmdhRun),
}

impl SignalModel for ModelRun {
    fn inputs(&self) -> usize {
        match self {
            Self::Arx(run) => run.inputs(),
            Self::Network(run) => run.inputs(),
            Self::Gmdh(run) => run.inputs(),
        }
    }

    fn outputs(&self) -> usize {
        match self {
            Self::Arx(run) => run.outputs(),
            Self::Network(run) => run.outputs(),
            Self::Gmdh(run) => run.outputs(),
        }
    }

    fn reset(&mut self) {
        match self {
            Self::Arx(run) => run.reset(),
            Self::Network(run) => run.reset(),
            Self::Gmdh(run) => run.reset(),
        }
    }

    #[inline]
    fn step(&mut self, u: &[f64]) -> &[f64] {
        match self {
            Self::Arx(run) => run.step(u),
            Self::Network(run) => run.step(u),
            Self::Gmdh(run) => run.step(u),
        }
    }

    fn settle(&mut self, u: &[f64]) {
        match self {
            Self::Arx(run) => run.settle(u),
            Self::Network(run) => run.settle(u),
            Self::Gmdh(run) => run.settle(u),
        }
    }
}

impl Memory for ModelRun {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        match self {
            Self::Arx(run) => run.walk(walk),
            Self::Network(run) => run.walk(walk),
            Self::Gmdh(run) => run.walk(walk),
        }
    }
}
