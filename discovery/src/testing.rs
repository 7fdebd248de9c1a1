//! Recordings that the tests share, made by the plant itself; integration
//! tests and the benchmark include this file.
#![allow(dead_code, unreachable_pub, reason = "no includer uses all of it")]

use drivescope_plant::drive::Drive;
use drivescope_plant::unit::Unit;
use drivescope_recording::{Recording, Signal};

const DR300: &str = include_str!("../../scenarios/drives/dr300.toml");

/// The built-in drive.
pub fn dr300() -> Drive {
    Drive::parse(DR300, "dr300.toml").expect("a right drive file")
}

/// A bench run from rest without noise: steps of u both ways and a slow wave, so that the shaft
/// sticks, creeps and reverses.
pub fn bench(drive: &Drive, duration_s: f64, period_s: f64) -> Recording {
    let samples = (duration_s / period_s).round() as usize;
    let u = |k: usize| {
        let t = k as f64 * period_s;
        let step = [6.0, -9.0, 3.0, 0.0, -4.0, 12.0, 0.5, -2.0][(t / 0.25) as usize % 8];
        step + 1.5 * (7.0 * t).sin()
    };
    driven(drive, (0..samples).map(u).collect(), period_s)
}

/// The ideal sensors' view of the drive under that u, from rest.
pub fn driven(drive: &Drive, u: Vec<f64>, period_s: f64) -> Recording {
    let load = vec![0.0; u.len()];
    loaded(drive, u, &load, period_s)
}

/// The same under a load torque that is not recorded.
pub fn loaded(drive: &Drive, u: Vec<f64>, load: &[f64], period_s: f64) -> Recording {
    let mut unit = Unit::new(drive.clone(), true);
    let place = |name: &str| unit.reference(name).expect("a unit has it");
    let (at_u, at_load) = (place("u"), place("T_l"));
    let places = ["i", "omega", "theta"].map(place);
    let mut columns: [Vec<f64>; 3] = Default::default();
    unit.initialize(0.0);
    for (k, u) in u.iter().enumerate() {
        unit.set_time(k as f64 * period_s);
        unit.set(at_u, *u).expect("finite");
        unit.set(at_load, load[k]).expect("finite");
        for (column, place) in columns.iter_mut().zip(places) {
            column.push(unit.get(place).expect("finite"));
        }
        unit.step(period_s).expect("finite");
    }
    let signal =
        |name: &str, unit: &str, values| Signal { name: name.into(), unit: unit.into(), values };
    let [i, omega, theta] = columns;
    let signals = vec![
        signal("u", "V", u),
        signal("i", "A", i),
        signal("omega", "rad/s", omega),
        signal("theta", "rad", theta),
    ];
    Recording::new("bench", 0.0, period_s, signals)
}

/// Normal numbers of unit variance.
pub fn gaussian(count: usize, seed: u64) -> Vec<f64> {
    gaussian_at(1.0, seed).take(count).collect()
}

/// A voltage that is never smooth: random levels held for 3 samples each, on a slow wave.
pub fn ripple(samples: usize) -> Vec<f64> {
    let levels = gaussian(samples / 3 + 1, 99);
    (0..samples).map(|k| 8.0 * (0.004 * k as f64).sin() + 2.0 * levels[k / 3]).collect()
}

/// The drive under its own controller, with noise; a reference of steps and a slow wave.
pub fn closed_loop(drive: &Drive, duration_s: f64, seed: u64) -> Recording {
    let mut unit = Unit::new(drive.clone(), false);
    let period_s = drive.controller.and_then(|it| it.period).expect("it samples");
    let samples = (duration_s / period_s).round() as usize;
    let place = |name: &str| unit.reference(name).expect("a unit has it");
    let inputs = ["reference", "noise_T", "noise_I_m"].map(place);
    let shown = ["C_m", "I_m", "T"].map(place);
    let per_si = drive.sensors.tacho_unit.per_si();
    let noise = [gaussian(samples, seed), gaussian(samples, seed + 1000)];
    let mut columns: [Vec<f64>; 3] = Default::default();
    unit.initialize(0.0);
    for k in 0..samples {
        let t = k as f64 * period_s;
        let reference = [100.0, 200.0, -150.0, 50.0][t as usize % 4] + 20.0 * (6.0 * t).sin();
        let values =
            [reference, drive.noise.omega * per_si * noise[0][k], drive.noise.i * noise[1][k]];
        unit.set_time(t);
        for (place, value) in inputs.into_iter().zip(values) {
            unit.set(place, value).expect("finite");
        }
        for (column, place) in columns.iter_mut().zip(shown) {
            column.push(unit.get(place).expect("finite"));
        }
        unit.step(period_s).expect("finite");
    }
    let [c_m, i, t] = columns;
    let gain = drive.amplifier.map_or(1.0, |amplifier| amplifier.gain);
    let u = c_m.iter().map(|c_m| gain * c_m).collect();
    let signal =
        |name: &str, unit: &str, values| Signal { name: name.into(), unit: unit.into(), values };
    let omega = t.iter().map(|t| t / per_si).collect();
    let signals = vec![signal("u", "V", u), signal("i", "A", i), signal("omega", "rad/s", omega)];
    Recording::new("loop", 0.0, period_s, signals)
}

/// The recording with white noise on current and speed.
pub fn noisy(mut recording: Recording, sds: [f64; 2], seed: u64) -> Recording {
    for (j, name) in ["i", "omega"].into_iter().enumerate() {
        let signal = recording.signals.iter_mut().find(|it| it.name == name);
        let values = &mut signal.expect("it is there").values;
        for (value, draw) in values.iter_mut().zip(gaussian_at(sds[j], seed + 7919 * j as u64)) {
            *value += draw;
        }
    }
    recording
}

/// Endless normal numbers of that standard deviation.
fn gaussian_at(sd: f64, seed: u64) -> impl Iterator<Item = f64> {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    std::iter::repeat_with(move || {
        let draw: f64 = StandardNormal.sample(&mut random);
        sd * draw
    })
}

/// A random load: an Ornstein-Uhlenbeck process of that standard deviation and memory.
pub fn random_load(samples: usize, period_s: f64, (sd, time_s): (f64, f64), seed: u64) -> Vec<f64> {
    let keep = (-period_s / time_s).exp();
    let mut load = 0.0;
    let next = |draw: f64| {
        load = keep * load + sd * (1.0 - keep * keep).sqrt() * draw;
        load
    };
    gaussian(samples, seed).into_iter().map(next).collect()
}
