//! Intervals of whole networks over recordings.

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
    let given = BoundOptions { given: Some([lower, upper]), ..options(Uncertain::OutputNeuron) };
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
    let robust = RobustGmdh::design(&network, &[data(&design)], &[data(&open[1])], &how).unwrap();
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
    let design = |data: &[Data], how: &BoundOptions| RobustGmdh::design(&network, data, &[], how);
    assert_eq!(design(&[], &good).unwrap_err(), RobustError::NoRecording);
    let none = BoundOptions { inflation: 0.9, ..good };
    assert_eq!(
        design(&[data(&run)], &none).unwrap_err(),
        RobustError::Inflation { inflation: 0.9 }
    );
    let reversed = BoundOptions { given: Some([1.0, -1.0]), ..good };
    let refusal = design(&[data(&run)], &reversed).unwrap_err();
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
    let refusal = RobustGmdh::design(&Arc::new(unstable), &[data(&run)], &[], &good).unwrap_err();
    assert!(matches!(refusal, RobustError::Network { .. }));
}
