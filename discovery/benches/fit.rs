//! A fit of seven parameters to 8 s at 1 kHz on one core; the bar is 0.3 s.

#[path = "../src/testing.rs"]
mod testing;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use drivescope_discovery::{Evidence, Measured, Observer, Options, Setting, fit, noise};
use drivescope_plant::drive::NoiseData;
use testing::{bench, dr300, noisy};

fn fits(criterion: &mut Criterion) {
    let mut truth = dr300();
    truth.motor.k_m = 0.0599;
    truth.noise = NoiseData::default();
    // R, L, K_e, J, B_m, T_c, T_b.
    truth.fixed = vec!["stribeck.omega_s".to_owned()];
    let recording = noisy(bench(&truth, 8.0, 0.001), [0.01, 0.3], 5);
    let mut base = truth.clone();
    for (parameter, factor) in truth.fitted().iter().zip([1.2, 0.8, 0.85, 0.9, 1.3, 0.8, 1.2]) {
        base.set(&parameter.name, parameter.value * factor).expect("possible");
    }
    assert_eq!(base.fitted().len(), 7);
    criterion.bench_function("fit of 7 parameters, 8 s at 1 kHz", |bencher| {
        bencher.iter(|| {
            let measured = Measured::new(&base, &recording).expect("usable");
            let sds = noise(&base, &measured, &[]).iter().map(|noise| noise.sd).collect();
            let evidence = Evidence { recordings: vec![measured], noise: vec![sds] };
            let observer = Observer::choose(&base, &evidence.recordings, &evidence.noise);
            let setting = Setting::new(&base, observer);
            black_box(fit(&base, &evidence, &setting, &Options::default()).expect("it converges"))
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = fits
}
criterion_main!(benches);
