//! What the importer adds to the C functions of an FMU: one communication step with six inputs set
//! and six outputs read. The FMU's own work is next to nothing here, so the whole is an upper bound of what the
//! importer adds.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use drivescope_fmu::cosim::{Experiment, FmuComponent, System};
use drivescope_fmu::import::{Instance, InstanceOptions};
use drivescope_recording::{Recording, Signal};

#[path = "../tests/it/support.rs"]
#[allow(dead_code)]
mod support;

const SIX: [u32; 6] = [1, 2, 3, 5, 6, 8];
const STEP: f64 = 1e-4;

fn instance(fmi: &str) -> Option<Instance> {
    let fmu = support::probe(fmi)?;
    let mut instance = fmu.co_simulation(&InstanceOptions::default()).expect("the probe");
    instance.initialize(0.0, None, None).expect("the probe");
    Some(instance)
}

fn step(c: &mut Criterion) {
    for fmi in ["2", "3"] {
        let Some(mut p) = instance(fmi) else { return };
        let values = [1.0, 0.5, 0.0, 1.0, 0.0, 9.81];
        let mut group = c.benchmark_group(format!("fmi{fmi}"));
        group.bench_function("set 6", |b| b.iter(|| p.set(&SIX, black_box(&values))));
        let mut read = [0.0; 6];
        group.bench_function("get 6", |b| b.iter(|| p.get(&SIX, black_box(&mut read))));
        // The time stands still, so that the step itself costs the FMU next to nothing.
        group.bench_function("step of zero length", |b| b.iter(|| p.step(black_box(0.0), 0.0)));
        group.bench_function("set 6, step, get 6", |b| {
            b.iter(|| -> Result<(), drivescope_fmu::import::Error> {
                p.set(&SIX, black_box(&values))?;
                p.step(black_box(0.0), 0.0)?;
                p.get(&SIX, black_box(&mut read))
            });
        });
        let names = ["u", "T", "x", "h", "v", "g"];
        let all = p.group(&names).expect("six variables");
        group
            .bench_function("write 6 as a group", |b| b.iter(|| p.write(&all, black_box(&values))));
        let mixed = p.group(&["n", "x", "fail", "on", "h", "mode"]).expect("six variables");
        group.bench_function("read 6 of mixed types", |b| {
            b.iter(|| p.read(&mixed, black_box(&mut read)))
        });
        group.finish();
    }
}

fn cosim(c: &mut Criterion) {
    let Some(fmu) = support::probe("3") else { return };
    let values = vec![1.0; 1000];
    let signals = vec![Signal { name: "u".into(), unit: "1".into(), values }];
    let recording = Arc::new(Recording::new("u", 0.0, STEP, signals));
    c.bench_function("cosim: 1000 steps of two coupled FMUs", |b| {
        b.iter(|| {
            let mut system = System::new(Experiment::new(0.0, 1000.0 * STEP, STEP));
            for name in ["a", "b"] {
                let instance = fmu.co_simulation(&InstanceOptions::named(name)).expect("the probe");
                system.add(name, FmuComponent::new(instance)).expect("a name");
            }
            system.input(&recording, "u", "a.u").expect("an input");
            system.connect("a.x", "b.u").expect("a connection");
            system.record_all();
            black_box(system.run().expect("a run"))
        });
    });
}

criterion_group!(benches, step, cosim);
criterion_main!(benches);
