//! Models in free run over lanes of runs, for campaigns: a lane gives the same bits as
//! [`crate::SignalModel::step`] of the stored model.
//!
//! Everything is `#[inline(always)]`, so that it is compiled for the instruction set of the block
//! around it.

mod arx;
mod history;
mod network;

use crate::model::Model;
use arx::ArxLanes;
use network::NetworkLanes;

pub(crate) use history::{HistoryLanes, dot};

/// A model of one input and one output, in free run over `N` lanes.
#[derive(Debug, Clone)]
pub struct ModelLanes<const N: usize>(Kind<N>);

#[derive(Debug, Clone)]
enum Kind<const N: usize> {
    Arx(ArxLanes<N>),
    Network(NetworkLanes<N>),
}

impl<const N: usize> ModelLanes<N> {
    /// The model at rest in every lane; nothing for a model of several signals, or a GMDH network,
    /// which has no lanes.
    pub fn new(model: &Model) -> Option<Self> {
        if model.signals() != Some((1, 1)) {
            return None;
        }
        match model {
            Model::Arx(arx) => Some(Self(Kind::Arx(ArxLanes::new(arx)))),
            Model::Network(network) => NetworkLanes::new(network).map(|it| Self(Kind::Network(it))),
            Model::Gmdh(_) => None,
        }
    }

    /// Outputs at this sample, from the inputs of the same sample.
    #[inline(always)]
    pub fn step(&mut self, u: &[f64; N]) -> [f64; N] {
        match &mut self.0 {
            Kind::Arx(arx) => arx.step(u),
            Kind::Network(network) => network.step(u),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::arx::Arx;
    use crate::network::{Structure, Theta};
    use crate::scale::Scale;
    use crate::signal_model::SignalModel;
    use crate::testing::noise;

    const LANES: usize = 8;

    fn lanes_equal_runs(model: &Model) {
        let inputs: [Vec<f64>; LANES] = std::array::from_fn(|l| noise(200, 10 + l as u64));
        let mut lanes = ModelLanes::<LANES>::new(model).expect("one input, one output");
        let mut runs: [_; LANES] = std::array::from_fn(|_| model.run());
        for k in 0..200 {
            let u = std::array::from_fn(|l| inputs[l][k]);
            let together = lanes.step(&u);
            for (l, run) in runs.iter_mut().enumerate() {
                assert_eq!(run.step(&[u[l]])[0], together[l], "lane {l} at {k}");
            }
        }
    }

    #[test]
    fn a_lane_of_a_network_is_its_run_bit_for_bit() {
        for order in [1, 2] {
            let structure = Structure { order, ..Structure::PAPER };
            let mut draws = noise(1000, 1).into_iter();
            let theta = Theta::draw(structure, || draws.next().expect("there are enough"));
            let scale = Scale { mean: 1.0, deviation: 2.0 };
            lanes_equal_runs(&Model::Network(Arc::new(theta.network(vec![scale], vec![scale]))));
        }
    }

    #[test]
    fn a_lane_of_an_arx_model_is_its_run_bit_for_bit() {
        for (n_a, n_b) in [(20, 20), (3, 5), (1, 1)] {
            let draws = noise(n_a + n_b, 2);
            let a = draws[..n_a].iter().map(|x| 0.02 * x).collect();
            let arx = Arx { a, b: vec![draws[n_a..].to_vec()], constant: 0.3 };
            lanes_equal_runs(&Model::Arx(Arc::new(arx)));
        }
    }

    #[test]
    fn models_of_several_inputs_have_no_lanes() {
        let arx = Arx { a: vec![], b: vec![vec![1.0], vec![1.0]], constant: 0.0 };
        assert!(ModelLanes::<LANES>::new(&Model::Arx(Arc::new(arx))).is_none());
    }
}
