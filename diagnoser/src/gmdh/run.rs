//! The network in free run, sample by sample.

use std::sync::Arc;

use super::{Activation, Gmdh, NeuronOrders, Source};
use crate::history::History;
use crate::memory::{Memory, MemoryError, Walk};
use crate::signal_model::SignalModel;

/// A GMDH network in free run, in the units of its signals.
#[derive(Debug, Clone)]
pub struct GmdhRun {
    flow: Flow,
    output: [f64; 1],
}

/// The running neurons: their regressors are their state.
#[derive(Debug, Clone)]
pub(super) struct Flow {
    network: Arc<Gmdh>,
    orders: NeuronOrders,
    parameters: Arc<[f64]>,
    past: Vec<History>,
    present: Vec<f64>,
    /// r(k) of every neuron, one after the other.
    regressors: Vec<f64>,
    /// q(k) of every neuron.
    filtered: Vec<f64>,
    /// s(k) of every neuron.
    outputs: Vec<f64>,
}

impl Flow {
    pub(super) fn new(network: &Arc<Gmdh>) -> Self {
        let orders = network.orders().expect("parts that fit together: checked on loading");
        let neurons = network.neurons.len();
        let longest = |input: usize| {
            let sources = network.neurons.iter().flat_map(|neuron| neuron.sources);
            let delays = sources.filter_map(|source| match source {
                Source::Input { input: i, delay } if i == input => Some(delay),
                _ => None,
            });
            delays.max().unwrap_or(0)
        };
        let inputs = network.input_scales.len();
        let mut flow = Self {
            orders,
            parameters: network.neurons.iter().flat_map(|neuron| neuron.parameters()).collect(),
            past: (0..inputs).map(|input| History::new(longest(input))).collect(),
            present: vec![0.0; inputs],
            regressors: vec![0.0; neurons * orders.parameters()],
            filtered: vec![0.0; neurons],
            outputs: vec![0.0; neurons],
            network: Arc::clone(network),
        };
        flow.reset();
        flow
    }

    pub(super) fn network(&self) -> &Arc<Gmdh> {
        &self.network
    }

    pub(super) fn reset(&mut self) {
        self.past.iter_mut().for_each(History::clear);
        self.filtered.fill(0.0);
        self.outputs.fill(0.0);
        self.regressors.fill(0.0);
        let count = self.orders.parameters();
        self.regressors.chunks_exact_mut(count).for_each(|r| r[count - 1] = 1.0);
    }

    /// The next sample: regressors, filters and outputs of all neurons.
    #[inline]
    pub(super) fn step(&mut self, u: &[f64]) {
        let NeuronOrders { n_a, .. } = self.orders;
        let count = self.orders.parameters();
        for ((present, u), scale) in self.present.iter_mut().zip(u).zip(&self.network.input_scales)
        {
            *present = scale.standardise(*u);
        }
        for (n, neuron) in self.network.neurons.iter().enumerate() {
            let r = &mut self.regressors[n * count..][..count];
            shift_in(&mut r[..n_a], -self.filtered[n]);
            for (j, source) in neuron.sources.iter().enumerate() {
                let fed = match *source {
                    Source::Input { input, delay: 0 } => self.present[input],
                    Source::Input { input, delay } => self.past[input].window()[delay - 1],
                    Source::Neuron(n) => self.outputs[n],
                };
                shift_in(&mut r[self.orders.taps(j)], fed);
            }
            let p = &self.parameters[n * count..][..count];
            self.filtered[n] = r.iter().zip(p).map(|(r, p)| r * p).sum();
            self.outputs[n] = neuron.activation.value(self.filtered[n]);
        }
        for (past, present) in self.past.iter_mut().zip(&self.present) {
            past.push(*present);
        }
    }

    /// r(k) of a neuron.
    #[inline]
    pub(super) fn regressor(&self, neuron: usize) -> &[f64] {
        let count = self.orders.parameters();
        &self.regressors[neuron * count..][..count]
    }

    /// s(k) of a neuron.
    #[inline]
    pub(super) fn output(&self, neuron: usize) -> f64 {
        self.outputs[neuron]
    }

    /// Output of the network, standardised.
    #[inline]
    pub(super) fn last(&self) -> f64 {
        self.outputs[self.outputs.len() - 1]
    }

    pub(super) fn activation(&self, neuron: usize) -> Activation {
        self.network.neurons[neuron].activation
    }
}

#[inline]
pub(super) fn shift_in<T: Copy>(delays: &mut [T], newest: T) {
    for l in (1..delays.len()).rev() {
        delays[l] = delays[l - 1];
    }
    if let Some(first) = delays.first_mut() {
        *first = newest;
    }
}

impl GmdhRun {
    pub(super) fn new(network: &Arc<Gmdh>) -> Self {
        Self { flow: Flow::new(network), output: [0.0] }
    }
}

impl SignalModel for GmdhRun {
    fn inputs(&self) -> usize {
        self.flow.past.len()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn reset(&mut self) {
        self.flow.reset();
    }

    #[inline]
    fn step(&mut self, u: &[f64]) -> &[f64] {
        self.flow.step(u);
        self.output = [self.flow.network.output_scale.restore(self.flow.last())];
        &self.output
    }
}

impl Memory for Flow {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(&mut self.past)?;
        let Self { regressors, filtered, outputs, .. } = self;
        walk.each([regressors, filtered, outputs].into_iter().flatten())
    }
}

impl Memory for GmdhRun {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.flow.walk(walk)
    }
}
