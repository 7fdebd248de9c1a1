//! The twelve faulty runs natively on one core: bar 1 ms for all of them.

use criterion::{Criterion, criterion_group, criterion_main};
use drivescope_plant::noise::NoiseStream;
use drivescope_recording::Recording;
use drivescope_scenarios::drives::built_in;
use drivescope_scenarios::experiment::{Experiment, Stream};
use drivescope_scenarios::faults::twelve;
use drivescope_scenarios::native::{ClosedLoops, closed_loop};
use drivescope_scenarios::results::TorqueReading;
use drivescope_scenarios::study::SAMPLES;

fn twelve_runs(criterion: &mut Criterion) {
    let drive = built_in("dr300").expect("it is built in").expect("it is right");
    let experiment = Experiment::new(drive, 1).expect("it is controlled");
    let inputs: Vec<Recording> = twelve(TorqueReading::Flux)
        .iter()
        .zip(0..)
        .map(|(fault, k)| experiment.closed_loop(SAMPLES, Stream::Faulty(k), Some(fault)))
        .collect();
    let drive = &experiment.drive;
    criterion.bench_function("twelve runs of 5000 samples in 16 lanes", |b| {
        let mut loops = ClosedLoops::new(drive);
        b.iter(|| loops.run(&inputs).len());
    });
    criterion.bench_function("the same in fresh memory", |b| {
        b.iter(|| ClosedLoops::new(drive).run(&inputs).len());
    });
    criterion.bench_function("one run of 5000 samples", |b| {
        b.iter(|| closed_loop(drive, &inputs[0]));
    });
    criterion.bench_function("noise of one run", |b| {
        b.iter(|| {
            NoiseStream::new(&drive.noise, 0.005, 1, 1).take(SAMPLES).map(|n| n.i).sum::<f64>()
        });
    });
}

criterion_group!(benches, twelve_runs);
criterion_main!(benches);
