//! One layer of the synthesis: every couple of its variables as a neuron, and the variables that
//! the survivors hand on.

use drivescope_numerics::{Regression, Residuals, minimise};
use rayon::prelude::*;

use super::fit::{Feed, FreeRun, Unit, delayed, forgets};
use super::options::GmdhOptions;
use super::series::Series;
use super::{Activation, GmdhNeuron, NeuronOrders, Source};

/// A fitted neuron of the layer in work.
pub(super) struct Candidate {
    feeds: [usize; 2],
    activation: Activation,
    parameters: Vec<f64>,
    pub(super) validation: f64,
}

/// The variables of a layer and where they come from.
pub(super) struct Layer {
    pub(super) sources: Vec<Source>,
    pub(super) estimation: Vec<Series>,
    pub(super) validation: Vec<Series>,
}

impl Layer {
    pub(super) fn copy(&self) -> Self {
        Self {
            sources: self.sources.clone(),
            estimation: self.estimation.clone(),
            validation: self.validation.clone(),
        }
    }
}

/// Step 1: how many neurons were tried, and those with a stable fit.
pub(super) fn candidates(layer: &Layer, options: &GmdhOptions) -> (usize, Vec<Candidate>) {
    let variables = layer.sources.len();
    let trials: Vec<([usize; 2], Activation)> = (0..variables)
        .flat_map(|i| (i + 1..variables).map(move |j| [i, j]))
        .flat_map(|feeds| [Activation::Identity, Activation::Tanh].map(|xi| (feeds, xi)))
        .collect();
    let fitted = trials
        .par_iter()
        .filter_map(|&(feeds, activation)| {
            let start = start(layer, feeds, activation, options)?;
            let units = [Unit { feeds: feeds.map(Feed::Variable), activation }];
            let (orders, memory) = (options.orders, options.memory);
            let on = |recordings| FreeRun { units: &units, orders, memory, recordings };
            let parameters = minimise(&on(&layer.estimation), &start, options.neuron).parameters;
            let validation = on(&layer.validation).sse(&parameters);
            let usable = validation.is_finite();
            usable.then_some(Candidate { feeds, activation, parameters, validation })
        })
        .collect();
    (trials.len(), fitted)
}

/// Linear least squares on q = xi^-1(y), measured past outputs in the regressor; its filter is drawn
/// into the unit circle if need be.
fn start(
    layer: &Layer,
    feeds: [usize; 2],
    activation: Activation,
    options: &GmdhOptions,
) -> Option<Vec<f64>> {
    let NeuronOrders { n_a, n_b } = options.orders;
    let mut equations = Regression::new(options.orders.parameters());
    for recording in &layer.estimation {
        let q: Vec<f64> = recording.y.iter().map(|y| activation.inverse(*y)).collect();
        let past = (1..=n_a).map(|i| delayed(&q, i).map(|q| -q).collect());
        let taps = feeds.iter().flat_map(|v| {
            (0..=n_b).map(|delay| delayed(&recording.variables[*v], delay).collect())
        });
        let columns: Vec<Vec<f64>> = past.chain(taps).collect();
        for k in recording.from..q.len() {
            equations.push(columns.iter().map(|column| column[k]).chain([1.0]), q[k]);
        }
    }
    let mut p = equations.solve().ok()?.parameters;
    // Scaling a_i by rho^i moves all roots towards zero by rho.
    const TOWARDS_ZERO: f64 = 0.98;
    while !forgets(&p[..n_a], options.memory) {
        let mut power = 1.0;
        for a in &mut p[..n_a] {
            power *= TOWARDS_ZERO;
            *a *= power;
        }
    }
    Some(p)
}

/// Step 3: the survivors' outputs are the variables of the next layer.
pub(super) fn next_layer(
    layer: &Layer,
    survivors: &[Candidate],
    number: usize,
    orders: NeuronOrders,
    neurons: &mut Vec<GmdhNeuron>,
) -> Layer {
    let mut next = Layer { sources: Vec::new(), ..layer.copy() };
    for series in next.estimation.iter_mut().chain(&mut next.validation) {
        series.variables.clear();
    }
    for survivor in survivors {
        let Candidate { feeds, activation, parameters, .. } = survivor;
        let units = [Unit { feeds: feeds.map(Feed::Variable), activation: *activation }];
        let sets =
            [(&layer.estimation, &mut next.estimation), (&layer.validation, &mut next.validation)];
        for (from, to) in sets {
            let run = FreeRun { units: &units, orders, memory: f64::INFINITY, recordings: from };
            for (from, to) in from.iter().zip(to) {
                to.variables.push(run.simulate(parameters, from).swap_remove(0).s);
            }
        }
        next.sources.push(Source::Neuron(neurons.len()));
        let mut neuron = GmdhNeuron {
            layer: number,
            sources: feeds.map(|v| layer.sources[v]),
            activation: *activation,
            a: Vec::new(),
            b: [Vec::new(), Vec::new()],
            constant: 0.0,
        };
        neuron.take(parameters, orders);
        neurons.push(neuron);
    }
    next
}
