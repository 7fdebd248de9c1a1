//! One discovery of hidden cogging, 8 s at 1 kHz to fit to and as much to judge by; the bar is 1 s
//! on two cores.

#[path = "../src/testing.rs"]
mod testing;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use drivescope_discovery::{Evidence, Measured, Unwatched, discover};
use drivescope_plant::drive::{Drive, EffectData};
use testing::{bench, dr300, driven, noisy, ripple};

const SDS: [f64; 2] = [0.01, 0.3];

fn base() -> Drive {
    let mut drive = dr300();
    drive.motor.k_m = drive.motor.k_e.expect("it has one");
    drive
}

fn evidence(drive: &Drive, recording: drivescope_recording::Recording, seed: u64) -> Evidence {
    let measured = Measured::new(drive, &noisy(recording, SDS, seed)).expect("usable");
    Evidence { recordings: vec![measured], noise: vec![SDS.to_vec()] }
}

fn discoveries(criterion: &mut Criterion) {
    let (mut truth, base) = (base(), base());
    let parameters = [("N", 6.0), ("a", 0.003), ("b", 0.002)].map(|(name, v)| (name.into(), v));
    let (kind, id) = ("cogging".into(), "cogging".into());
    truth.effects.push(EffectData { kind, id, parameters: parameters.into(), law: None });
    let estimation = evidence(&base, bench(&truth, 8.0, 0.001), 1);
    let validation = evidence(&base, driven(&truth, ripple(8000), 0.001), 2);
    criterion.bench_function("a discovery, 8 s at 1 kHz", |bencher| {
        bencher.iter(|| {
            let found = discover(&base, &estimation, &validation, &Unwatched).expect("it fits");
            assert_eq!(found.named, ["cogging"]);
            black_box(found)
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = discoveries
}
criterion_main!(benches);
