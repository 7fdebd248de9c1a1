//! A bench run: the voltage, and what the sensors show.

use drivescope_plant::drive::Drive;
use drivescope_plant::unit::Unit;
use drivescope_recording::{Recording, Signal};
use rand::RngExt as _;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::hidden::sign;
use crate::benchmark::discovery::{Noise, Record};

const SAMPLES: usize = 8000;
const PERIOD_S: f64 = 1e-3;

/// Noise of speed and current, share of their largest values: the generators' levels.
const fn shares_of_noise(noise: Noise) -> [f64; 2] {
    match noise {
        Noise::Small => [0.001, 0.0015],
        Noise::Medium => [0.003, 0.005],
        Noise::Large => [0.01, 0.015],
    }
}

/// A bench run: slow passages through zero, steps, a multisine, in random order.
fn voltage(volts: f64, random: &mut Pcg64) -> Vec<f64> {
    let quarter = SAMPLES / 4;
    let mut parts: Vec<Vec<f64>> = Vec::new();
    for _ in 0..2 {
        let (height, turns) = (random.random_range(0.25..0.45), random.random_range(0.8..1.6));
        let phase = random.random_range(0.0..1.0);
        let wave = |k: usize| {
            let x = (turns * k as f64 / quarter as f64 + phase).rem_euclid(1.0);
            height * (4.0 * (x - 0.5_f64).abs() - 1.0)
        };
        parts.push((0..quarter).map(wave).collect());
    }
    let mut steps = Vec::new();
    let mut side = sign(random);
    while steps.len() < quarter {
        let level = side * random.random_range(0.15..0.6);
        let dwell = random.random_range(150..400);
        steps.extend(std::iter::repeat_n(level, dwell));
        side = -side;
    }
    steps.truncate(quarter);
    parts.push(steps);
    let tones: Vec<(f64, f64)> = (0..10)
        .map(|k| {
            let hz = 0.7 * (40.0_f64 / 0.7).powf(f64::from(k) / 9.0);
            (hz, random.random_range(0.0..std::f64::consts::TAU))
        })
        .collect();
    let height = random.random_range(0.06..0.1);
    let sines = |k: usize| {
        let t = k as f64 * PERIOD_S;
        let of = |(hz, phase): &(f64, f64)| (std::f64::consts::TAU * hz * t + phase).sin();
        height * tones.iter().map(of).sum::<f64>()
    };
    parts.push((0..quarter).map(sines).collect());
    for k in (1..parts.len()).rev() {
        parts.swap(k, random.random_range(0..=k));
    }
    parts.concat().into_iter().map(|share| share.clamp(-1.0, 1.0) * volts).collect()
}

/// A coloured load torque: standard deviation, N m, and time constant, s.
pub(super) struct Load {
    pub(super) sd: f64,
    pub(super) time: f64,
}

/// What the sensors of a machine show in one run.
pub(super) fn record(
    name: &str,
    truth: &Drive,
    volts: f64,
    load: Option<&Load>,
    noise: Noise,
    random: &mut Pcg64,
) -> Record {
    let u = voltage(volts, random);
    let mut unit = Unit::new(truth.clone(), true);
    let place = |name: &str| unit.reference(name).expect("a unit has it");
    let (at_u, at_load, shown) = (place("u"), place("T_l"), ["omega", "i"].map(place));
    let mut columns: [Vec<f64>; 2] = Default::default();
    let mut torque = 0.0;
    unit.initialize(0.0);
    for (k, u) in u.iter().enumerate() {
        if let Some(Load { sd, time }) = load {
            let keep = (-PERIOD_S / time).exp();
            let draw: f64 = StandardNormal.sample(random);
            torque = keep * torque + sd * (1.0 - keep * keep).sqrt() * draw;
        }
        unit.set_time(k as f64 * PERIOD_S);
        unit.set(at_u, *u).expect("finite");
        unit.set(at_load, torque).expect("finite");
        for (column, place) in columns.iter_mut().zip(shown) {
            column.push(unit.get(place).expect("finite"));
        }
        unit.step(PERIOD_S).expect("finite");
    }
    let signal = |name: &str, unit: &str, values| Signal {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    let mut signals = vec![signal("u", "V", u)];
    let mut sds = Vec::new();
    let of_signals = columns.into_iter().zip([("omega", "rad/s"), ("i", "A")]);
    for ((mut values, (name, unit)), share) in of_signals.zip(shares_of_noise(noise)) {
        let sd = share * values.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        for value in &mut values {
            let draw: f64 = StandardNormal.sample(random);
            *value += sd * draw;
        }
        signals.push(signal(name, unit, values));
        sds.push((name.to_owned(), sd));
    }
    let recording = Recording::new(name.to_owned(), 0.0, PERIOD_S, signals);
    Record { recording, noise: sds }
}
