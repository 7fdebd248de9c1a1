//! A step of the exported FMU through the importer against a native step of the same drive: the
//! bar is the native step and 150 ns. Each step sets five inputs and reads six outputs.

use std::process::Command;

use criterion::{Criterion, criterion_group, criterion_main};
use drivescope_fmu::import::{Fmu, InstanceOptions};
use drivescope_plant::fault::{FaultLanes, Faults};
use drivescope_plant::integrate::Integrator;
use drivescope_plant::sampled::{InputLanes, Inputs, Sampled, speed_bound};
use drivescope_scenarios::drives::built_in;
use drivescope_scenarios::native::RECORDED;

const PERIOD_S: f64 = 0.005;
const SET_POINT: f64 = 209.0;
const INPUTS: [&str; 5] = ["reference", "noise_reference", "noise_T", "noise_I_m", "noise_T_l"];

/// Noise enough that no sample equals the last: the inputs of sample k.
fn inputs(k: u64) -> [f64; 5] {
    let wobble = (k % 17) as f64 - 8.0;
    [SET_POINT, 0.1 * wobble, 0.3 * wobble, 1e-3 * wobble, 1e-4 * wobble]
}

fn native(criterion: &mut Criterion) {
    let drive = built_in("dr300").expect("it is built in").expect("it is right");
    let integrator = Integrator::new(drive.model(), speed_bound(&drive));
    let mut sampled = Sampled::new(&drive, integrator, true);
    let faults = FaultLanes::splat(Faults::NONE);
    let mut k = 0;
    criterion.bench_function("native step", |b| {
        b.iter(|| {
            let [reference, noise_reference, noise_t, noise_i_m, load] = inputs(k);
            let now =
                Inputs { reference, load, noise_reference, noise_t, noise_i_m, ..Inputs::NONE };
            let time = k as f64 * PERIOD_S;
            sampled.sample(time, &InputLanes::splat(now), &faults);
            sampled.advance(time, PERIOD_S);
            k += 1;
            (sampled.signals().lane(0), sampled.outputs(time + PERIOD_S))
        });
    });
}

fn through_the_importer(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for fmi in ["2", "3"] {
        let path = folder.path().join("drive.fmu");
        let mut export = Command::new(env!("CARGO_BIN_EXE_drivescope"));
        export.args(["export", "dr300", "--quiet", "--fmi", fmi, "-o"]).arg(&path);
        assert!(export.output().expect("the program starts").status.success());
        let fmu = Fmu::open(&path).expect("it is an FMU");
        let mut drive = fmu.co_simulation(&InstanceOptions::default()).expect("an instance");
        let reference = |name: &str| fmu.variable(name).expect("it has the variable").reference;
        let (set, get) = (INPUTS.map(reference), RECORDED.map(reference));
        drive.initialize(0.0, None, None).expect("it starts");
        let mut shown = [0.0; RECORDED.len()];
        let mut k = 0;
        criterion.bench_function(&format!("FMI {fmi}.0 step: set 5, step, get 6"), |b| {
            b.iter(|| {
                drive.set(&set, &inputs(k)).expect("inputs can be set");
                drive.step(k as f64 * PERIOD_S, PERIOD_S).expect("it steps");
                drive.get(&get, &mut shown).expect("outputs can be read");
                k += 1;
                shown
            });
        });
    }
}

criterion_group!(benches, native, through_the_importer);
criterion_main!(benches);
