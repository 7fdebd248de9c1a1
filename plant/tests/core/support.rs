//! The reference drive and the scenarios that several tests and the benchmarks share.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use drivescope_numerics::Real;
use drivescope_plant::effects::custom::Law;
use drivescope_plant::effects::registry::Kind;
use drivescope_plant::integrate::{Integrator, State};
use drivescope_plant::model::{Applied, CURRENT, Model, Motor, POSITION, Part, SPEED};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// Sampling time of the experiment, s.
pub(crate) const PERIOD: f64 = 0.005;
/// 2000 rpm in rad/s.
pub(crate) const SET_POINT: f64 = 2000.0 * PI / 30.0;
/// Greatest speed that the scenarios reach, rad/s (no-load speed at 24 V: 400 rad/s).
pub(crate) const TOP_SPEED: f64 = 400.0;

/// The motor of the AMIRA DR300.
pub(crate) fn dr300_motor<R: Real>() -> Motor<R> {
    Motor {
        r: R::constant(3.13),
        l: R::constant(5.0e-3),
        k_e: R::constant(0.0599),
        k_m: R::constant(0.06),
        j: R::constant(8.2e-5),
        b_m: R::constant(6.0e-5),
        friction: R::one(),
    }
}

/// A part with those parameter values.
pub(crate) fn part<R: Real>(kind: Kind, values: &[f64]) -> Part<R> {
    Part { kind, parameters: values.iter().map(|v| R::constant(*v)).collect() }
}

/// The friction of the DR300: T_c, then T_b and omega_s.
pub(crate) fn dr300_friction<R: Real>() -> Vec<Part<R>> {
    vec![part(Kind::Coulomb, &[0.016]), part(Kind::Stribeck, &[0.008, 5.0])]
}

/// The DR300's motor with those effects and no typed law.
pub(crate) fn drive<R: Real>(parts: &[Part<R>]) -> Model<R, 1> {
    Model::new(dr300_motor(), false, parts, Arc::<[Law]>::from([]))
}

/// The AMIRA DR300: motor, Coulomb and Stribeck friction.
pub(crate) fn dr300<R: Real>() -> Model<R, 1> {
    drive(&dr300_friction())
}

/// Samples of white noise of standard deviation 1.
pub(crate) fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut generator = Pcg64Mcg::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).expect("a positive deviation");
    move || normal.sample(&mut generator)
}

/// Current, speed and position at every sample.
pub(crate) type Run = Vec<[f64; 3]>;

/// The inputs of an open-loop scenario: u and load, sample by sample.
pub(crate) struct OpenLoop {
    pub(crate) name: &'static str,
    pub(crate) inputs: Vec<[f64; 2]>,
}

impl OpenLoop {
    fn new(name: &'static str, seconds: f64, mut at: impl FnMut(f64) -> [f64; 2]) -> Self {
        let samples = (seconds / PERIOD).round() as usize;
        Self { name, inputs: (0..samples).map(|k| at(k as f64 * PERIOD)).collect() }
    }
}

/// Runs that stick and slip: reversals, load against a stuck shaft, creeping at break-away.
pub(crate) fn stick_slip() -> Vec<OpenLoop> {
    let mut n = noise(7);
    let mut m = noise(8);
    vec![
        OpenLoop::new("slow sine", 10.0, |t| [3.0 * (TAU * 0.5 * t).sin(), 0.0]),
        OpenLoop::new("fast noisy sine", 5.0, |t| [4.0 * (TAU * 5.0 * t).sin() + 0.5 * n(), 0.0]),
        OpenLoop::new("load breaks away", 10.0, |t| [0.2, 0.05 * (TAU * 0.9 * t).sin()]),
        OpenLoop::new("creep at break-away", 10.0, |t| [1.1 + 0.15 * m() + 0.005 * t, 0.0]),
        OpenLoop::new("full voltage steps", 6.0, |t| {
            [if (t * 2.5).fract() < 0.5 { 24.0 } else { -24.0 }, 0.0]
        }),
    ]
}

/// The PI controller of the DR300 with amplifier, in rad/s and V, integral held at the limit.
struct Pi {
    integral: f64,
}

impl Pi {
    fn voltage(&mut self, error: f64) -> f64 {
        let wanted = 0.0382 * error + self.integral;
        let control = if wanted > 10.0 { 10.0 } else { wanted };
        let control = if control < -10.0 { -10.0 } else { control };
        if control == wanted {
            self.integral += 0.477 * PERIOD * error;
        }
        2.4 * control
    }
}

/// Speed control at 2000 rpm from rest with reference and load noise: `advance` takes u and
/// load over a sample and returns the state there.
pub(crate) fn closed_loop(samples: usize, mut advance: impl FnMut(f64, f64) -> [f64; 3]) -> Run {
    let (mut reference, mut load) = (noise(1), noise(2));
    let mut pi = Pi { integral: 0.0 };
    let mut omega = 0.0;
    (0..samples)
        .map(|_| {
            let error = SET_POINT + 2.094 * reference() - omega;
            let state = advance(pi.voltage(error), 1e-3 * load());
            omega = state[1];
            state
        })
        .collect()
}

/// Our integrator as a function from inputs over a sample to states, from rest.
pub(crate) fn ours(model: Model<f64, 1>) -> impl FnMut(f64, f64) -> [f64; 3] {
    ours_over(model, PERIOD)
}

/// The same over intervals of `h` seconds.
pub(crate) fn ours_over(model: Model<f64, 1>, h: f64) -> impl FnMut(f64, f64) -> [f64; 3] {
    let mut state = State::at_rest(&model);
    let mut integrator = Integrator::new(model, TOP_SPEED);
    let mut k = 0;
    move |u, load| {
        let applied = Applied { u: [u], load: [load], time: f64::from(k) * h };
        k += 1;
        integrator.advance(&mut state, &applied, h);
        [state.x[CURRENT][0], state.x[SPEED][0], state.x[POSITION][0]]
    }
}

/// Greatest difference between two runs, each variable relative to its greatest magnitude.
pub(crate) fn relative_difference(a: &Run, b: &Run) -> [f64; 3] {
    std::array::from_fn(|j| {
        let size = b.iter().map(|s| s[j].abs()).fold(0.0, f64::max);
        let apart = a.iter().zip(b).map(|(s, t)| (s[j] - t[j]).abs()).fold(0.0, f64::max);
        apart / size
    })
}
