//! Time of a sample and of a sub-step: scalar, in lanes, with derivatives, through stick-slip;
//! and the closed loop against Dopri5 of `ode_solvers`.
//!
//! Bars: lanes of 32 with four effects at least 4 times the scalar throughput; the closed loop
//! at least 50 times as fast as Dopri5 at 1e-6, its error no larger. The ratios are printed at
//! the end, each from measurements taken by turns in one run.

#[path = "../tests/core/oracle.rs"]
mod oracle;
#[path = "../tests/core/support.rs"]
mod support;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group};
use drivescope_numerics::{Dual, Real};
use drivescope_plant::effects::registry::{Kind, REGISTRY};
use drivescope_plant::integrate::{Block, Integrator, State};
use drivescope_plant::model::{Applied, Model, Part};

use support::{PERIOD, closed_loop, dr300, dr300_friction, drive, ours, part};

/// Sub-steps of a sample in the benchmarks of a sub-step.
const SUBSTEPS: usize = 20;

/// Coulomb, Stribeck, saturation and that one.
fn four_with<R: Real>(other: Part<R>) -> Vec<Part<R>> {
    let mut parts = dr300_friction();
    parts.push(other);
    parts.push(part(Kind::Saturation, &[0.02]));
    parts
}

/// With a sensor that lags: its state asks for sub-steps.
fn four<R: Real>() -> Vec<Part<R>> {
    four_with(part(Kind::SpeedSensorLag, &[0.02]))
}

/// Every effect of the library at its nominal values.
fn all<R: Real>() -> Vec<Part<R>> {
    let nominal = |entry: &drivescope_plant::effects::registry::Entry| {
        let values: Vec<f64> = entry.parameters.iter().map(|p| p.nominal).collect();
        part(entry.kind, &values)
    };
    REGISTRY.iter().map(nominal).collect()
}

/// Runs over `samples` samples at speed; ready to be called again and again.
fn scalar<R: Real>(model: Model<R, 1>) -> impl FnMut(usize) {
    let mut state = State::at_rest(&model);
    state.set_speed(&model, 0, R::constant(100.0));
    let mut integrator = Integrator::paced(model, PERIOD / SUBSTEPS as f64);
    move |samples| {
        for _ in 0..samples {
            let applied = Applied { u: [R::constant(12.0)], load: [R::zero()], time: 0.0 };
            integrator.advance(&mut state, &black_box(applied), R::constant(PERIOD));
        }
        black_box(&state);
    }
}

/// The same in a block of `N` drives.
fn lanes<const N: usize>(model: &Model<f64, 1>) -> impl FnMut(usize) + use<N> {
    let model = Model::side_by_side([model; N]);
    let mut state = State::at_rest(&model);
    for l in 0..N {
        state.set_speed(&model, l, 100.0 + l as f64);
    }
    let mut block = Block::paced(model, PERIOD / SUBSTEPS as f64);
    move |samples| {
        for _ in 0..samples {
            let applied = Applied { u: [12.0; N], load: [0.0; N], time: 0.0 };
            block.advance(&mut state, &black_box(applied), PERIOD);
        }
        black_box(&state);
    }
}

/// Stick-slip over a slow sine.
fn stick_slip() -> impl FnMut(usize) {
    let mut scenarios = support::stick_slip().into_iter();
    let scenario = scenarios.find(|s| s.name == "slow sine").expect("it is one of them");
    let mut advance = ours(dr300());
    let mut k = 0;
    move |samples| {
        for _ in 0..samples {
            let [u, load] = scenario.inputs[k % scenario.inputs.len()];
            black_box(advance(u, load));
            k += 1;
        }
    }
}

fn stepping(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("exact step, per sample");
    exact(&mut group);
    group.bench_function("four smooth effects in one step, scalar", |b| {
        let mut run = scalar(drive::<f64>(&four_with(part(Kind::QuadraticDrag, &[1e-7]))));
        b.iter(|| run(1));
    });
    group.finish();
    let mut group = criterion.benchmark_group("sub-step, per drive");
    let mut time = |name: &str, drives: usize, mut run: Box<dyn FnMut(usize)>| {
        group.throughput(Throughput::Elements((drives * SUBSTEPS) as u64));
        group.bench_function(name, |b| b.iter(|| run(1)));
    };
    time("four effects, scalar", 1, Box::new(scalar(drive::<f64>(&four()))));
    time("four effects, 32 lanes", 32, Box::new(lanes::<32>(&drive(&four()))));
    time("four effects, Dual<8>", 1, Box::new(scalar(drive::<Dual<8>>(&four()))));
    time("all effects, scalar", 1, Box::new(scalar(drive::<f64>(&all()))));
    time("all effects, 32 lanes", 32, Box::new(lanes::<32>(&drive(&all()))));
    time("all effects, Dual<8>", 1, Box::new(scalar(drive::<Dual<8>>(&all()))));
    group.finish();
}

fn exact(group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>) {
    let mut time = |name: &str, drives: usize, mut run: Box<dyn FnMut(usize)>| {
        group.throughput(Throughput::Elements(drives as u64));
        group.bench_function(name, |b| b.iter(|| run(1)));
    };
    time("scalar", 1, Box::new(scalar(dr300::<f64>())));
    time("32 lanes", 32, Box::new(lanes::<32>(&dr300())));
    time("Dual<8>", 1, Box::new(scalar(dr300::<Dual<8>>())));
    time("stick-slip run, scalar", 1, Box::new(stick_slip()));
}

/// Shortest time of one call, `a` and `b` by turns: other work on the machine only adds.
fn by_turns(turns: usize, mut a: impl FnMut(), mut b: impl FnMut()) -> [Duration; 2] {
    let mut least = [Duration::MAX; 2];
    for _ in 0..turns {
        for (least, run) in least.iter_mut().zip([&mut a as &mut dyn FnMut(), &mut b]) {
            let start = Instant::now();
            run();
            *least = (*least).min(start.elapsed());
        }
    }
    least
}

fn ratios() {
    const RUNS: usize = 2000;
    let (mut one, mut many) = (scalar(drive::<f64>(&four())), lanes::<32>(&drive(&four())));
    let [alone, block] = by_turns(15, || one(RUNS), || many(RUNS / 32));
    let gain = alone.as_secs_f64() / block.as_secs_f64() * (RUNS / 32 * 32) as f64 / RUNS as f64;
    println!("32 lanes with four effects: {gain:.1} times the scalar throughput (bar: 4)");

    const SAMPLES: usize = 5000;
    let dopri5 = || oracle::run_by(oracle::Solver::Plain, oracle::DR300, PERIOD);
    let [own, other] = by_turns(
        15,
        || drop(black_box(closed_loop(SAMPLES, ours(dr300())))),
        || drop(black_box(closed_loop(SAMPLES, dopri5()))),
    );
    let [loop_alone, _] = by_turns(
        15,
        || drop(black_box(closed_loop(SAMPLES, |u, load| [u, 200.0 + load, 0.0]))),
        || (),
    );
    let expected = closed_loop(SAMPLES, oracle::reference(oracle::DR300, PERIOD));
    let error = |run| {
        let apart = support::relative_difference(&run, &expected);
        apart.into_iter().fold(0.0, f64::max)
    };
    let (own_error, other_error) =
        (error(closed_loop(SAMPLES, ours(dr300()))), error(closed_loop(SAMPLES, dopri5())));
    let ratio = (other - loop_alone).as_secs_f64() / (own - loop_alone).as_secs_f64();
    println!("closed loop of {SAMPLES} samples, from rest (noise and controller: {loop_alone:?}):");
    println!("  ours {own:?}, error {own_error:.1e}; Dopri5 {other:?}, error {other_error:.1e}");
    println!("  {ratio:.0} times as fast (bar: 50)");
}

criterion_group!(benches, stepping);

fn main() {
    benches();
    ratios();
}
