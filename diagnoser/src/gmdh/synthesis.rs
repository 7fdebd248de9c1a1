//! Synthesis of the network (Section 2.3, steps 1 to 3), pruning, and retraining (Section 2.4).
//!
//! Step 1: a neuron for every couple of the layer's input variables and every activation, by
//! linear least squares on xi^-1(y) (equation error) and then by Levenberg-Marquardt on its own
//! free-run error. Step 2: the best on validation data go on. Step 3: their outputs are the next
//! layer's inputs, as long as a layer lowers the validation error. What the best neuron does not
//! use is removed, and all remaining parameters are trained together, again in free run.

use std::sync::Arc;

use drivescope_numerics::{Residuals, minimise};

use super::fit::{Feed, FreeRun, Unit};
use super::layer::{Layer, candidates, next_layer};
use super::options::{GmdhError, GmdhOptions, GmdhReport, LayerRow};
use super::series::{Series, first_layer, scales};
use super::{Gmdh, GmdhNeuron, NeuronOrders, Source};
use crate::data::Data;

impl Gmdh {
    /// Synthesises a network on `estimation` recordings; neurons, depth and retraining are judged
    /// on `validation` recordings of the same signals.
    pub fn synthesise(
        estimation: &[Data],
        validation: &[Data],
        options: &GmdhOptions,
    ) -> Result<(Arc<Self>, GmdhReport), GmdhError> {
        let &GmdhOptions { orders, first_delay, delays, run_up, .. } = options;
        let inputs = check(estimation, validation, options)?;
        let (input_scales, output_scale) = scales(estimation);
        let sources = first_layer(inputs, first_delay, delays, orders);
        let series = |data: &Data| Series::new(data, &sources, &input_scales, output_scale, run_up);
        let mut layer = Layer {
            estimation: estimation.iter().map(series).collect(),
            validation: validation.iter().map(series).collect(),
            sources: sources.clone(),
        };
        let first = layer.copy();
        let unit = output_scale.deviation;
        let judged: usize = first.validation.iter().map(Series::judged).sum();
        let rms = |sse: f64| unit * (sse / judged as f64).sqrt();
        let (mut neurons, mut rows): (Vec<GmdhNeuron>, Vec<LayerRow>) = (Vec::new(), Vec::new());
        let (mut best, mut kept) = (f64::INFINITY, 0);
        for number in 1..=options.most_layers.max(1) {
            let (tried, mut fitted) = candidates(&layer, options);
            fitted.sort_by(|a, b| a.validation.total_cmp(&b.validation));
            fitted.truncate(options.survivors.max(1));
            let Some(winner) = fitted.first() else {
                if kept == 0 {
                    return Err(GmdhError::NoNeuron { candidates: tried });
                }
                break;
            };
            let reached = rms(winner.validation);
            rows.push(LayerRow { layer: number, candidates: tried, validation: reached });
            let gains = reached < (1.0 - options.least_gain) * best;
            if !gains {
                break;
            }
            (best, kept) = (reached, number);
            layer = next_layer(&layer, &fitted, number, orders, &mut neurons);
        }
        // The winner was the first of its layer; later layers only appended after it.
        let output = neurons.iter().position(|neuron| neuron.layer == kept).unwrap_or(0);
        let mut network = Self { input_scales, output_scale, neurons: pruned(&neurons, output) };
        let (before, validation, sse) = network.retrain(&first, options);
        let counted: usize = first.estimation.iter().map(Series::judged).sum();
        let report = GmdhReport {
            layers: rows,
            kept,
            before_retraining: rms(before),
            validation: rms(validation),
            estimation: unit * (sse / counted as f64).sqrt(),
        };
        Ok((Arc::new(network), report))
    }

    /// Trains all parameters together and keeps what validation data prefer. Validation error
    /// before and after, and estimation error after.
    fn retrain(&mut self, first: &Layer, options: &GmdhOptions) -> (f64, f64, f64) {
        let orders = options.orders;
        let units = self.units(&first.sources);
        let memory = options.memory;
        let on = |recordings| FreeRun { units: &units, orders, memory, recordings };
        let (fit, judge) = (on(&first.estimation), on(&first.validation));
        let start: Vec<f64> = self.neurons.iter().flat_map(GmdhNeuron::parameters).collect();
        let before = judge.sse(&start);
        let found = minimise(&fit, &start, options.retraining).parameters;
        let after = judge.sse(&found);
        let (parameters, validation) =
            if after < before { (found, after) } else { (start, before) };
        for (neuron, p) in self.neurons.iter_mut().zip(parameters.chunks_exact(orders.parameters()))
        {
            neuron.take(p, orders);
        }
        (before, validation, fit.sse(&parameters))
    }

    /// The neurons as units of a fit over the first layer's variables.
    pub(super) fn units(&self, sources: &[Source]) -> Vec<Unit> {
        let feed = |source: &Source| match source {
            Source::Neuron(n) => Feed::Unit(*n),
            input => Feed::Variable(sources.iter().position(|s| s == input).unwrap_or(0)),
        };
        let unit = |neuron: &GmdhNeuron| Unit {
            feeds: [feed(&neuron.sources[0]), feed(&neuron.sources[1])],
            activation: neuron.activation,
        };
        self.neurons.iter().map(unit).collect()
    }
}

impl GmdhNeuron {
    pub(super) fn take(&mut self, p: &[f64], orders: NeuronOrders) {
        self.a = p[..orders.n_a].to_vec();
        self.b = [0, 1].map(|j| p[orders.taps(j)].to_vec());
        self.constant = p[orders.parameters() - 1];
    }
}

fn check(
    estimation: &[Data],
    validation: &[Data],
    options: &GmdhOptions,
) -> Result<usize, GmdhError> {
    let expected = estimation.first().map_or(0, |data| data.inputs().len());
    for (set, recordings) in [("estimation", estimation), ("validation", validation)] {
        if recordings.is_empty() {
            return Err(GmdhError::NoRecording { set });
        }
        for (recording, data) in recordings.iter().enumerate() {
            let found = data.inputs().len();
            if found != expected {
                return Err(GmdhError::Inputs { set, recording, expected, found });
            }
            let needed = options.run_up + 2 * options.orders.parameters() + 1;
            data.require_samples(needed, "GMDH synthesis after its run-up")
                .and_then(|()| data.require_variation())
                .map_err(|source| GmdhError::Data { set, recording, source })?;
        }
    }
    if expected * options.delays < 2 {
        return Err(GmdhError::NoCouple { inputs: expected, delays: options.delays });
    }
    Ok(expected)
}

/// The neurons that `output` depends on, itself last.
fn pruned(neurons: &[GmdhNeuron], output: usize) -> Vec<GmdhNeuron> {
    let mut used = vec![false; neurons.len()];
    used[output] = true;
    for n in (0..=output).rev() {
        if used[n] {
            for source in neurons[n].sources {
                if let Source::Neuron(fed_by) = source {
                    used[fed_by] = true;
                }
            }
        }
    }
    let place = |n: usize| used[..n].iter().filter(|used| **used).count();
    let kept = neurons.iter().zip(&used).take(output + 1).filter(|(_, used)| **used);
    kept.map(|(neuron, _)| GmdhNeuron {
        sources: neuron.sources.map(|source| match source {
            Source::Neuron(n) => Source::Neuron(place(n)),
            input => input,
        }),
        ..neuron.clone()
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Column, data};
    use crate::signal_model::{Start, free_run, residual};
    use crate::testing::{multisine, noise};
    use crate::threshold::mean_and_deviation;

    #[test]
    fn layers_are_added_as_long_as_they_help_and_the_rest_is_removed() {
        let runs = [multisine(1000, 1), multisine(1000, 2), multisine(1000, 3)];
        let [estimation, validation, fresh] = runs.each_ref().map(data);
        let options = GmdhOptions::default();
        let (network, report) = Gmdh::synthesise(&[estimation], &[validation], &options).unwrap();
        assert!(report.kept >= 2, "{report:?}");
        for rows in report.layers[..report.kept].windows(2) {
            assert!(rows[1].validation < rows[0].validation, "{report:?}");
        }
        assert!(report.layers.len() <= report.kept + 1);
        // Four delays: six couples, two activations.
        assert_eq!(report.layers[0].candidates, 12);
        // Every neuron but the last is used by a later one.
        for n in 0..network.neurons.len() - 1 {
            let later = network.neurons[n + 1..].iter();
            let mut sources = later.flat_map(|neuron| neuron.sources);
            assert!(sources.any(|source| source == Source::Neuron(n)), "neuron {n} is idle");
        }
        assert!(report.validation < report.before_retraining, "{report:?}");
        let remainder = residual(&mut network.run(), &fresh, Start::Rest);
        let (_, remainder) = mean_and_deviation(&remainder[options.run_up..]);
        let (_, speed) = mean_and_deviation(&runs[2].speed);
        assert!(remainder < 0.04 * speed, "{remainder} of {speed} rpm, {report:?}");
    }

    #[test]
    fn the_report_counts_the_error_of_the_network_returned() {
        let (one, two) = (multisine(400, 1), multisine(500, 2));
        let (estimation, validation) = ([data(&one)], [data(&two), data(&one)]);
        let options = GmdhOptions { survivors: 3, delays: 3, ..GmdhOptions::default() };
        let (network, report) = Gmdh::synthesise(&estimation, &validation, &options).unwrap();
        let (mut sse, mut n) = (0.0, 0.0);
        for data in &validation {
            let remainder = residual(&mut network.run(), data, Start::Rest);
            sse += remainder[options.run_up..].iter().map(|e| e * e).sum::<f64>();
            n += (remainder.len() - options.run_up) as f64;
        }
        let rms = (sse / n).sqrt();
        assert!((report.validation / rms - 1.0).abs() < 1e-9, "{report:?} and {rms}");
    }

    #[test]
    fn a_clone_replays_and_threads_do_not_decide() {
        let (one, two) = (multisine(300, 1), multisine(300, 2));
        let options = GmdhOptions { survivors: 2, delays: 3, ..GmdhOptions::default() };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Gmdh::synthesise(&[data(&one)], &[data(&two)], &options)).unwrap()
        };
        let (network, report) = on(1);
        assert_eq!((&network, &report), (&on(3).0, &on(3).1));
        let mut run = network.run();
        let first = free_run(&mut run, data(&one).inputs());
        assert_eq!(free_run(&mut run.clone(), data(&one).inputs()), first);
    }

    #[test]
    fn unusable_data_are_refused() {
        let run = multisine(300, 1);
        let good = data(&run);
        let options = GmdhOptions::default();
        let refusal = Gmdh::synthesise(&[], std::slice::from_ref(&good), &options).unwrap_err();
        assert_eq!(refusal, GmdhError::NoRecording { set: "estimation" });
        let short = good.span(0..110);
        let refusal =
            Gmdh::synthesise(std::slice::from_ref(&good), &[short], &options).unwrap_err();
        let message = refusal.to_string();
        assert!(message.contains("validation recording 0") && message.contains("113"), "{message}");
        let still = vec![2.0; 300];
        let dead = Data::new(vec![Column { name: "C_m", values: &still }], good.output()).unwrap();
        let refusal = Gmdh::synthesise(&[dead], std::slice::from_ref(&good), &options).unwrap_err();
        assert!(refusal.to_string().contains("signal C_m is constant at 2"), "{refusal}");
        let one = GmdhOptions { delays: 1, ..options };
        let refusal =
            Gmdh::synthesise(std::slice::from_ref(&good), std::slice::from_ref(&good), &one)
                .unwrap_err();
        assert_eq!(refusal, GmdhError::NoCouple { inputs: 1, delays: 1 });
        let extra = noise(300, 4);
        let inputs = vec![good.inputs()[0], Column { name: "extra", values: &extra }];
        let wide = Data::new(inputs, good.output()).unwrap();
        let refusal = Gmdh::synthesise(&[good], &[wide], &options).unwrap_err();
        assert!(matches!(refusal, GmdhError::Inputs { expected: 1, found: 2, .. }));
    }
}
