//! Bounding the parameters of a synthesised network on healthy data (Section 2.3.1).
//!
//! The regressor of a neuron is what the network with its trained parameters shows in free run.
//! With only the output neuron uncertain it is exact, and (8) to (12) hold as written. With every
//! neuron uncertain, a neuron of a later layer sees outputs that are known within their own
//! intervals (16), which makes errors in its regressor, (13) to (15). A network that was retrained
//! as a whole has hidden neurons that no longer imitate the output: their sets are then wide.
//!
//! Noise bounds: the smallest that leave any parameters (Chebyshev), times an inflation; or given.
//! They are those of the healthy runs that (19) is to watch. A loop that holds one set point says
//! nothing about the gain, so that its parameter set alone would explain every fault; excited runs
//! (an open loop) bound the parameters as well. The bounds (10) may depend on the sample: those of
//! an excited run exceed the healthy ones by as much as its own smallest bound does, for the model
//! errs more where it is driven through more.

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use super::Gmdh;
use super::bands::Intervals;
use super::bound_options::{BoundOptions, Orthants, RobustError, Uncertain};
use super::bounds::{BoundError, Equations, ParameterSet};
use super::robust::{NeuronBounds, RobustGmdh};
use crate::data::Data;

impl RobustGmdh {
    /// Bounds the parameters of a network on healthy recordings of the kind that it will watch,
    /// and on `excited` ones (healthy too), which say more of its parameters. Recordings count on
    /// from the healthy ones in errors.
    pub fn design(
        network: &Arc<Gmdh>,
        healthy: &[Data],
        excited: &[Data],
        options: &BoundOptions,
    ) -> Result<Self, RobustError> {
        if healthy.is_empty() {
            return Err(RobustError::NoRecording);
        }
        let all = [healthy, excited].concat();
        let run_up = |recording: usize| {
            if recording < healthy.len() { options.run_up } else { options.excited_run_up }
        };
        check(network, &all, run_up, options)?;
        let output = network.neurons.len() - 1;
        let unit = network.output_scale.deviation;
        let given = options.given.map(|noise| noise.map(|epsilon| epsilon / unit));
        let first = if options.uncertain == Uncertain::EveryNeuron { 0 } else { output };
        let mut bounds: Vec<NeuronBounds> = Vec::new();
        for neuron in first..=output {
            let refuse = |source| RobustError::Neuron { neuron, source };
            let noise = given.filter(|_| neuron == output);
            let mut equations =
                equations(network, neuron, &bounds, &all, run_up).map_err(refuse)?;
            let multiples = multiples(&equations, healthy.len()..all.len(), noise, options);
            equations.set_multiples(multiples.map_err(refuse)?);
            let every = options.orthants == Orthants::All;
            let found =
                ParameterSet::of(&equations, noise, options.inflation, every).map_err(refuse)?;
            bounds.push(NeuronBounds { neuron, noise: found.noise, set: found.set });
        }
        Ok(Self { network: Arc::clone(network), bounds })
    }
}

fn check(
    network: &Gmdh,
    healthy: &[Data],
    run_up: impl Fn(usize) -> usize,
    options: &BoundOptions,
) -> Result<(), RobustError> {
    // Written so that NaN is refused.
    let enough = options.inflation >= 1.0;
    if !enough {
        return Err(RobustError::Inflation { inflation: options.inflation });
    }
    if let Some([lower, upper]) = options.given
        && !(lower < upper && lower.is_finite() && upper.is_finite())
    {
        return Err(RobustError::Noise { lower, upper });
    }
    let orders = network.orders().filter(|_| network.is_stable());
    for (recording, data) in healthy.iter().enumerate() {
        let inputs = data.inputs().len();
        let fits = orders.filter(|_| inputs == network.input_scales.len());
        let Some(orders) = fits else { return Err(RobustError::Network { recording, inputs }) };
        data.require_samples(
            run_up(recording) + orders.parameters() + 1,
            "bounds after their run-up",
        )
        .and_then(|()| data.require_variation())
        .map_err(|source| RobustError::Data { recording, source })?;
    }
    Ok(())
}

/// The equations of one neuron, with the intervals of those before it.
fn equations(
    network: &Arc<Gmdh>,
    neuron: usize,
    before: &[NeuronBounds],
    healthy: &[Data],
    run_up: impl Fn(usize) -> usize,
) -> Result<Equations, BoundError> {
    let activation = network.neurons[neuron].activation;
    let dimension = network.neurons[neuron].parameters().len();
    let mut equations = Equations::new(dimension, activation);
    for (recording, data) in healthy.iter().enumerate() {
        let mut intervals = Intervals::new(network, before)?;
        let mut u = vec![0.0; data.inputs().len()];
        for (k, y) in data.output().values.iter().enumerate() {
            for (u, column) in u.iter_mut().zip(data.inputs()) {
                *u = column.values[k];
            }
            intervals.step(&u);
            if k >= run_up(recording) {
                let y = network.output_scale.standardise(*y);
                let regressor = intervals.regressor(neuron);
                equations.push(regressor.values, regressor.errors, y, (recording, k));
            }
        }
    }
    Ok(equations)
}

/// Noise bounds of every recording as a multiple of the healthy ones.
fn multiples(
    equations: &Equations,
    excited: Range<usize>,
    given: Option<[f64; 2]>,
    options: &BoundOptions,
) -> Result<Vec<f64>, BoundError> {
    let mut multiples = vec![1.0; excited.end];
    if excited.is_empty() {
        return Ok(multiples);
    }
    // Half the width that the excited runs' own bounds are compared with.
    let healthy = match given {
        Some([lower, upper]) => 0.5 * (upper - lower) / options.inflation,
        None => equations.of_recordings(0..excited.start).least_bound()?,
    };
    for recording in excited {
        let own = equations.of_recordings(recording..recording + 1).least_bound()?;
        multiples[recording] = own / healthy;
    }
    Ok(multiples)
}
