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

use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Gmdh;
use super::bands::Intervals;
use super::bound_options::{BoundOptions, Orthants, RobustError, Uncertain};
use super::bounds::{BoundError, Equations, ParameterSet};
use crate::data::Data;

/// What is known of one neuron.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeuronBounds {
    /// Which one.
    pub neuron: usize,
    /// epsilon^m and epsilon^M, standardised as the output is.
    pub noise: [f64; 2],
    /// Its feasible parameters.
    pub set: ParameterSet,
}

/// A GMDH network with bounded parameters, in the form it is stored in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobustGmdh {
    /// The network.
    pub network: Arc<Gmdh>,
    /// Uncertain neurons, in the order of the network; the output neuron is one of them.
    pub bounds: Vec<NeuronBounds>,
}

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

    /// Noise bounds epsilon^m, epsilon^M of the output, in its unit.
    pub fn noise(&self) -> Option<[f64; 2]> {
        let last = self.bounds.last()?;
        Some(last.noise.map(|epsilon| epsilon * self.network.output_scale.deviation))
    }

    /// Input signals, or `None` if the parts do not fit together.
    pub fn inputs(&self) -> Option<usize> {
        let parameters = self.network.orders()?.parameters();
        let output = self.network.neurons.len() - 1;
        let fits = self.bounds.last().is_some_and(|last| last.neuron == output)
            && self
                .bounds
                .iter()
                .all(|bounds| bounds.neuron <= output && bounds.set.centre.len() == parameters);
        fits.then_some(self.network.input_scales.len())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Column, data};
    use crate::detector::Detector;
    use crate::gmdh::{Activation, GmdhNeuron, GmdhOptions, Source};
    use crate::scale::Scale;
    use crate::signal_model::free_run;
    use crate::testing::{Run, closed_loop, multisine, noise};
    use crate::threshold::Threshold;

    const RUN_UP: usize = 100;

    fn network() -> Arc<Gmdh> {
        let (one, two) = (multisine(400, 1), multisine(400, 2));
        let options = GmdhOptions { delays: 3, survivors: 3, ..GmdhOptions::default() };
        Gmdh::synthesise(&[data(&one)], &[data(&two)], &options).unwrap().0
    }

    fn options(uncertain: Uncertain) -> BoundOptions {
        BoundOptions { uncertain, run_up: RUN_UP, ..BoundOptions::default() }
    }

    #[test]
    fn the_design_data_never_leave_their_own_intervals() {
        let run = multisine(500, 3);
        let network = network();
        let options = options(Uncertain::OutputNeuron);
        let robust = RobustGmdh::design(&network, &[data(&run)], &[], &options).unwrap();
        assert_eq!((robust.bounds.len(), robust.inputs()), (1, Some(1)));
        let bands = robust.bands().unwrap();
        let mut detector = Detector::new(network.run(), bands, 1, RUN_UP).unwrap();
        assert!(detector.run(&data(&run)).unwrap().declarations().is_empty());
    }

    /// Two neurons on the same inputs with different poles, and one that averages them.
    fn averaging() -> Arc<Gmdh> {
        let input = |input| Source::Input { input, delay: 1 };
        let neuron = |layer, sources, a: f64, b: [f64; 2]| GmdhNeuron {
            layer,
            sources,
            activation: Activation::Identity,
            a: vec![a],
            b: b.map(|b| vec![b]),
            constant: 0.0,
        };
        let scale = Scale { mean: 0.0, deviation: 1.0 };
        let neurons = vec![
            neuron(1, [input(0), input(1)], -0.3, [0.10, 0.06]),
            neuron(1, [input(0), input(1)], -0.1, [0.12, 0.08]),
            neuron(2, [Source::Neuron(0), Source::Neuron(1)], 0.0, [0.5, 0.5]),
        ];
        Arc::new(Gmdh { input_scales: vec![scale; 2], output_scale: scale, neurons })
    }

    #[test]
    fn intervals_pass_from_layer_to_layer() {
        let network = averaging();
        let (u1, u2, e) = (noise(600, 1), noise(600, 2), noise(600, 3));
        let inputs = vec![Column { name: "u1", values: &u1 }, Column { name: "u2", values: &u2 }];
        let clean = free_run(&mut network.run(), &inputs).swap_remove(0);
        let y: Vec<f64> = clean.iter().zip(e).map(|(y, e)| y + 0.004 * e.tanh()).collect();
        let data = Data::new(inputs, Column { name: "y", values: &y }).unwrap();
        let robust = RobustGmdh::design(
            &network,
            std::slice::from_ref(&data),
            &[],
            &options(Uncertain::EveryNeuron),
        )
        .unwrap();
        assert_eq!(robust.bounds.len(), 3);
        let alone = RobustGmdh::design(
            &network,
            std::slice::from_ref(&data),
            &[],
            &options(Uncertain::OutputNeuron),
        )
        .unwrap();
        let run = |robust: &RobustGmdh| {
            let bands = robust.bands().unwrap();
            Detector::new(network.run(), bands, 1, RUN_UP).unwrap().run(&data).unwrap()
        };
        let (every, output) = (run(&robust), run(&alone));
        assert!(every.declarations().is_empty() && output.declarations().is_empty());
        let width = |trace: &crate::decision::Trace| -> f64 {
            trace.verdicts[RUN_UP..].iter().map(|v| v.upper - v.lower).sum()
        };
        assert!(width(&every) > width(&output), "more uncertainty must show");
    }

    #[test]
    fn data_that_respect_the_bounds_raise_no_alarm_and_those_that_do_not_raise_one() {
        // A system of the network's own kind: other parameters of the output neuron, bounded noise.
        let network = network();
        let robust = RobustGmdh::design(
            &network,
            &[data(&multisine(500, 3))],
            &[],
            &options(Uncertain::OutputNeuron),
        )
        .unwrap();
        let [lower, upper] = robust.noise().unwrap();
        let output = network.neurons.len() - 1;
        let mut bands = robust.bands().unwrap();
        let centre = robust.bounds[0].set.centre.clone();
        let (design, fresh) = (multisine(500, 5), multisine(500, 6));
        let imitated = |run: &Run, seed: u64| -> Vec<f64> {
            let draws = noise(run.control.len(), seed);
            let mut flow = bands.clone();
            run.control
                .iter()
                .zip(draws)
                .map(|(u, e)| {
                    flow.band(&[*u]);
                    let r = flow.regressor();
                    let q = r.values.iter().zip(&centre).map(|(r, p)| 1.01 * r * p).sum();
                    let s = network.neurons[output].activation.value(q);
                    let share = 0.5 + 0.5 * (0.4 * e).tanh();
                    network.output_scale.restore(s) + lower + share * (upper - lower)
                })
                .collect()
        };
        let (y_design, y_fresh) = (imitated(&design, 8), imitated(&fresh, 9));
        let (design, fresh) = (data(&design), data(&fresh));
        let given =
            BoundOptions { given: Some([lower, upper]), ..options(Uncertain::OutputNeuron) };
        let design = design.with_output("T", &y_design).unwrap();
        let robust = RobustGmdh::design(&network, &[design], &[], &given).unwrap();
        bands = robust.bands().unwrap();
        let mut detector = Detector::new(network.run(), bands, 1, RUN_UP).unwrap();
        let fresh = fresh.with_output("T", &y_fresh).unwrap();
        assert!(detector.run(&fresh).unwrap().declarations().is_empty());
        // Broken on purpose: twice the width of the noise on top leaves the band at once.
        let off: Vec<f64> = y_fresh.iter().map(|y| y + 3.0 * (upper - lower)).collect();
        let trace = detector.run(&fresh.with_output("T", &off).unwrap()).unwrap();
        assert_eq!(trace.declarations(), [RUN_UP + 1]);
    }

    #[test]
    fn a_fault_is_found_in_closed_loop_and_health_is_not() {
        let open = [multisine(1000, 1), multisine(1000, 2)];
        let closed = [3, 4].map(|seed| closed_loop(1500, seed, usize::MAX, 0.0));
        let design = closed_loop(4000, 5, usize::MAX, 0.0);
        let estimation = [data(&open[0]), data(&closed[0])];
        let validation = [data(&open[1]), data(&closed[1])];
        let options = GmdhOptions::default();
        let (network, _) = Gmdh::synthesise(&estimation, &validation, &options).unwrap();
        let how = BoundOptions { inflation: 1.2, ..BoundOptions::default() };
        let robust =
            RobustGmdh::design(&network, &[data(&design)], &[data(&open[1])], &how).unwrap();
        let watch = |fault: f64| {
            let run = closed_loop(5000, 6, 4000, fault);
            let bands = robust.bands().unwrap();
            let mut detector = Detector::new(network.run(), bands, 50, 500).unwrap();
            detector.run(&data(&run)).unwrap()
        };
        let r_fd = watch(0.0).exceedance_rate(500..5000).unwrap();
        let noise = robust.noise().unwrap();
        assert!(r_fd < 0.01, "r_fd {r_fd}, noise {noise:?}");
        for fault in [0.05, -0.05, 0.2] {
            let trace = watch(fault);
            let r_td = trace.exceedance_rate(4000..5000).unwrap();
            assert!(r_td > 0.9, "fault {fault}: r_td {r_td}, noise {noise:?}");
            assert!(trace.declarations()[0] >= 4050);
        }
    }

    #[test]
    fn unusable_designs_are_refused() {
        let network = network();
        let run = multisine(400, 3);
        let good = options(Uncertain::OutputNeuron);
        let design =
            |data: &[Data], how: &BoundOptions| RobustGmdh::design(&network, data, &[], how);
        assert_eq!(design(&[], &good).unwrap_err(), RobustError::NoRecording);
        let none = BoundOptions { inflation: 0.9, ..good };
        assert_eq!(
            design(&[data(&run)], &none).unwrap_err(),
            RobustError::Inflation { inflation: 0.9 }
        );
        let turned = BoundOptions { given: Some([1.0, -1.0]), ..good };
        let refusal = design(&[data(&run)], &turned).unwrap_err();
        assert_eq!(refusal, RobustError::Noise { lower: 1.0, upper: -1.0 });
        let tight = BoundOptions { given: Some([-1e-3, 1e-3]), ..good };
        let refusal = design(&[data(&run)], &tight).unwrap_err();
        let empty = BoundError::Empty { recording: 0, sample: 0 };
        let RobustError::Neuron { neuron, source } = refusal else { panic!("{refusal}") };
        assert_eq!(neuron, network.neurons.len() - 1);
        assert!(std::mem::discriminant(&source) == std::mem::discriminant(&empty), "{source}");
        assert!(source.to_string().contains("became empty at sample 1"), "{source}");
        let short = data(&run).span(0..105);
        let refusal = design(&[short], &good).unwrap_err();
        assert!(matches!(refusal, RobustError::Data { recording: 0, .. }));
        let mut unstable = Gmdh::clone(&network);
        unstable.neurons[0].a[0] = -1.2;
        let refusal =
            RobustGmdh::design(&Arc::new(unstable), &[data(&run)], &[], &good).unwrap_err();
        assert!(matches!(refusal, RobustError::Network { .. }));
    }
}
