//! What the diagnoser costs: the network and its Jacobian, a sample of the running detector, an
//! ARX fit, intervals of bounded parameters, the training of the classifier. Bars: network <= 40 us
//! for 1000 samples, Jacobian <= 3.5 evaluations, detector <= 0.5 us a sample, ARX(20,20) below
//! numpy's lstsq (1.3 ms), an interval of 6 parameters <= 100 us by programs and <= 2 us a sample
//! with cached vertices, 200 steps of the classifier <= 3 s. Printed beside: the test error of LM in the
//! time of ARS, at least 2 times lower. `tools/compare_gradient.py` times the gradient in PyTorch, to be
//! at least 100 times the Jacobian's.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use drivescope_diagnoser::{
    Arx, BoundOptions, Column, Confidence, Data, Detector, ErrorBands, FaultSymptoms, Gmdh,
    GmdhOptions, Isolator, IsolatorOptions, Limits, Method, Network, Orders, Partition, RobustGmdh,
    SignalModel, Structure, Symptoms, Theta, Threshold, Trained, Training, free_run, residual,
    train,
};

#[path = "../src/testing.rs"]
#[allow(dead_code)]
mod testing;

const PAPER_ORDERS: Orders = Orders { n_a: 20, n_b: 20, constant: true };

fn theta(structure: Structure) -> Theta {
    let values = testing::noise(structure.parameters(), 1);
    Theta { structure, values: values.iter().map(|e| 0.5 * e).collect() }
}

fn network(c: &mut Criterion) {
    let inputs = testing::noise(1000, 2);
    let theta = theta(Structure::PAPER);
    let mut group = c.benchmark_group("paper network, 1000 samples");
    group.bench_function("evaluation", |b| b.iter(|| theta.simulate(black_box(&inputs))));
    group.bench_function("jacobian", |b| b.iter(|| theta.jacobian(black_box(&inputs))));
    group.finish();
}

fn training(c: &mut Criterion) {
    let (estimation, validation) = (testing::multisine(1000, 1), testing::multisine(1000, 2));
    let [estimation, validation] = [&estimation, &validation].map(|run| data(run).unwrap());
    let mut group = c.benchmark_group("training, one start");
    group.sample_size(10);
    let methods = [
        (
            "LM, 100 steps",
            Method::LevenbergMarquardt(Limits { steps: 100, relative_decrease: 0.0 }),
        ),
        ("ARS, 10 steps", Method::AdaptiveRandomSearch { outer: 10 }),
    ];
    for (name, method) in methods {
        let training = Training { method, starts: 1, ..Training::default() };
        group.bench_function(name, |b| {
            b.iter(|| train(Structure::PAPER, &estimation, &validation, &training).unwrap());
        });
    }
    group.finish();
}

/// Test errors of Adaptive Random Search as the paper ran it and of Levenberg-Marquardt in the time
/// that it took, both on one thread: random starts as long as time is left, the best on validation
/// data. The bar: at least 2 times lower.
fn error_at_equal_time(_: &mut Criterion) {
    let runs = [1, 2, 3].map(|seed| testing::multisine(1000, seed));
    let [estimation, validation, test] = runs.each_ref().map(|run| data(run).unwrap());
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for seed in 1..=3 {
        let trained = |method, seed| {
            let training = Training { method, starts: 1, seed, ..Training::default() };
            train(Structure::PAPER, &estimation, &validation, &training).unwrap()
        };
        let test_error = |network: &Arc<Network>| {
            let remainder = residual(&mut network.run(), &test, drivescope_diagnoser::Start::Rest);
            (remainder[100..].iter().map(|e| e * e).sum::<f64>() / (remainder.len() - 100) as f64)
                .sqrt()
        };
        one_thread.install(|| {
            let begun = Instant::now();
            let ars = trained(Method::AdaptiveRandomSearch { outer: 100 }, seed);
            let budget = begun.elapsed();
            let (begun, mut starts) = (Instant::now(), 0);
            let mut best: Option<Trained> = None;
            let validation = |trained: &Trained| trained.starts[0].validation;
            while begun.elapsed() < budget {
                let found = trained(Training::default().method, 1000 * seed + starts);
                starts += 1;
                if best.as_ref().is_none_or(|best| validation(&found) < validation(best)) {
                    best = Some(found);
                }
            }
            let (ars, lm) = (test_error(&ars.network), test_error(&best.unwrap().network));
            println!(
                "test error, rms, of ARS in {:.2} s: {ars:.1} rpm; of LM, {starts} starts in that \
                 time: {lm:.1} rpm, {:.1} times lower",
                budget.as_secs_f64(),
                ars / lm
            );
        });
    }
}

fn data(run: &testing::Run) -> Option<Data<'_>> {
    let input = Column { name: "C_m", values: &run.control };
    Data::new(vec![input], Column { name: "T", values: &run.speed }).ok()
}

fn arx(c: &mut Criterion) {
    let run = testing::closed_loop(3500, 3, usize::MAX, 0.0);
    let data = data(&run).unwrap().span(500..3500);
    c.bench_function("ARX(20,20) on 3000 samples", |b| {
        b.iter(|| Arx::fit(black_box(&data), PAPER_ORDERS).unwrap());
    });
    c.bench_function("ARX orders 1..20 x 1..20 by AIC on 3000 samples", |b| {
        b.iter(|| Arx::select(black_box(&data), PAPER_ORDERS).unwrap());
    });
}

fn detector(c: &mut Criterion) {
    let (estimation, validation) = (testing::multisine(1000, 1), testing::multisine(1000, 2));
    let training = Training { starts: 1, ..Training::default() };
    let model = train(
        Structure::PAPER,
        &data(&estimation).unwrap(),
        &data(&validation).unwrap(),
        &training,
    )
    .unwrap()
    .network;
    let run = testing::closed_loop(5000, 4, 4000, 0.05);
    let data = data(&run).unwrap();
    let error_model = Arx::fit(&data.span(500..3500), PAPER_ORDERS).unwrap().model;
    let bands = ErrorBands::new(error_model.run(), 6.0, Confidence::new(0.05).unwrap());
    let mut detector = Detector::new(model.run(), bands, 50, 500).unwrap();
    let mut group = c.benchmark_group("detector, 5000 samples");
    group.throughput(Throughput::Elements(5000));
    group.bench_function("network, ARX(20,20) bands, decision", |b| {
        b.iter(|| {
            detector.reset();
            let mut declared = 0;
            for (u, y) in run.control.iter().zip(&run.speed) {
                let verdict = detector.step(black_box(&[*u]), *y).unwrap();
                declared += u32::from(verdict.declared);
            }
            declared
        });
    });
    group.bench_function("ARX(20,20) free run alone", |b| {
        let mut run = Arc::clone(&error_model).run();
        assert_eq!(run.outputs(), 1);
        b.iter(|| free_run(&mut run, black_box(data.inputs())));
    });
    group.finish();
}

fn gmdh(c: &mut Criterion) {
    let runs = [testing::multisine(1000, 1), testing::multisine(1000, 2)];
    let [estimation, validation] = [data(&runs[0]).unwrap(), data(&runs[1]).unwrap()];
    let options = GmdhOptions::default();
    let synthesise = || {
        Gmdh::synthesise(
            std::slice::from_ref(&estimation),
            std::slice::from_ref(&validation),
            &options,
        )
        .unwrap()
        .0
    };
    let network = synthesise();
    let design = || {
        RobustGmdh::design(
            &network,
            std::slice::from_ref(&validation),
            &[],
            &BoundOptions::default(),
        )
        .unwrap()
    };
    let robust = design();
    let mut bands = robust.bands().unwrap();
    let control = &runs[0].control;
    println!(
        "{} neurons, {} vertices, {} facets",
        network.neurons.len(),
        bands.vertices(),
        robust.bounds[0].set.parts[0].facets.len()
    );
    let mut group = c.benchmark_group("GMDH");
    group.sample_size(10);
    group.bench_function("synthesis, 1000 samples", |b| b.iter(synthesise));
    group.bench_function("bounds, 500 samples", |b| b.iter(design));
    bands.band(&[control[0]]);
    let values = bands.regressor().values.to_vec();
    let set = &robust.bounds[0].set;
    // Short enough for as many samples as usual.
    group.sample_size(100);
    group.bench_function("interval of 6 parameters by programs", |b| {
        let regressor = drivescope_diagnoser::Regressor { values: &values, errors: &[] };
        b.iter(|| set.interval_by_programs(black_box(regressor)));
    });
    group.throughput(Throughput::Elements(1000));
    group.bench_function("adaptive threshold, 1000 samples", |b| {
        b.iter(|| {
            bands.reset();
            control.iter().map(|u| bands.band(black_box(&[*u])).upper).sum::<f64>()
        });
    });
    group.finish();
}

fn classifier(c: &mut Criterion) {
    let draws = testing::noise(2 * 1200, 5);
    let samples = |fault: usize| {
        let own = draws[200 * fault..][..200].chunks_exact(2);
        own.map(move |e| vec![4.0 * fault as f64 + e[0], (fault * fault % 7) as f64 * 4.0 + e[1]])
    };
    let fault = |fault| FaultSymptoms { fault: String::new(), samples: samples(fault).collect() };
    let symptoms = Symptoms::new((0..12).map(fault).collect()).unwrap();
    let limits = Limits { steps: 200, relative_decrease: 0.0 };
    let options = IsolatorOptions { limits, starts: 1, ..IsolatorOptions::default() };
    let mut group = c.benchmark_group("classifier");
    group.sample_size(10);
    group.bench_function("200 steps of one start", |b| {
        let partition = Partition::paper();
        b.iter(|| Isolator::train(&symptoms, &symptoms, &partition, &options).unwrap());
    });
    group.finish();
}

criterion_group!(benches, network, training, error_at_equal_time, arx, detector, gmdh, classifier);
criterion_main!(benches);
