//! The order of convergence: four, with own states, stiff ones too, and through events; where a step covers
//! many sub-steps it is higher.

use std::f64::consts::TAU;

use drivescope_plant::effects::registry::Kind;
use drivescope_plant::integrate::{Integrator, State};
use drivescope_plant::model::{Applied, Model, Part, SPEED};

use crate::support::{dr300, dr300_friction, drive, part};

const H: f64 = 0.005;
const SAMPLES: usize = 200;

/// Current and speed at every sample with `n` sub-steps a sample, from that speed.
fn run(model: &Model<f64, 1>, from: f64, u: impl Fn(f64) -> f64, n: usize) -> Vec<Vec<f64>> {
    let mut state = State::at_rest(model);
    state.set_speed(model, 0, from);
    let mut integrator = Integrator::paced(model.clone(), H / n as f64);
    let samples = (0..SAMPLES).map(|k| {
        let time = k as f64 * H;
        let applied = Applied { u: [u(time)], load: [0.0], time };
        integrator.advance(&mut state, &applied, H);
        state.x.iter().map(|x| x[0]).collect()
    });
    samples.collect()
}

/// Order from the errors with n and 2 n sub-steps against 16 n: between each pair of runs the
/// mean over the samples, which is steadier than the greatest where events move through steps.
fn order(model: &Model<f64, 1>, from: f64, u: impl Fn(f64) -> f64, n: usize) -> f64 {
    let exact = run(model, from, &u, 16 * n);
    let error = |n: usize| {
        let found = run(model, from, &u, n);
        let apart = found.iter().zip(&exact).map(|(x, y)| (x[SPEED] - y[SPEED]).abs());
        apart.sum::<f64>()
    };
    let (coarse, fine) = (error(n), error(2 * n));
    println!("errors {coarse:.2e}, {fine:.2e}");
    (coarse / fine).log2()
}

fn is_four(order: f64) {
    println!("order {order:.2}");
    assert!((3.7..4.6).contains(&order), "order {order}");
}

/// The order where the shaft turns one way.
fn order_in_motion(parts: &[Part<f64>]) -> f64 {
    order(&drive(parts), 60.0, |t| 6.0 + 3.0 * (TAU * 3.0 * t).sin(), 32)
}

/// Laws that are smooth.
fn smooth() -> Vec<Part<f64>> {
    vec![
        part(Kind::QuadraticDrag, &[3e-7]),
        part(Kind::Cogging, &[4.0, 0.002, 0.003]),
        part(Kind::Saturation, &[0.05]),
    ]
}

#[test]
fn the_smooth_field_converges_with_order_four() {
    let mut parts = smooth();
    parts.push(part(Kind::SpeedSensorLag, &[0.02]));
    is_four(order_in_motion(&parts));
}

/// 32 sub-steps at once, then 16: a quarter of the bits of the first are enough to see order six.
#[test]
fn steps_over_many_sub_steps_converge_faster() {
    let order = order_in_motion(&smooth());
    assert!(order > 6.0, "order {order}");
}

#[test]
fn a_stiff_own_state_keeps_order_four() {
    let mut parts = dr300_friction();
    parts.push(part(Kind::Presliding, &[10.0]));
    // At 100 rad/s its deflection decays with 10 x 100 / 0.016 = 62500 / s: 8 to a step of
    // 0.13 ms. It starts from rest, where it is not stiff: a deflection that does not belong to
    // its speed would decay within a step.
    is_four(order(&drive(&parts), 0.0, |t| 6.0 + 3.0 * (TAU * 3.0 * t).sin(), 40));
}

#[test]
fn reversals_of_a_stiff_own_state_keep_order_four() {
    let mut parts = dr300_friction();
    parts.push(part(Kind::Presliding, &[10.0]));
    is_four(order(&drive(&parts), 0.0, |t| 3.0 * (TAU * 3.0 * t).sin(), 64));
}

#[test]
fn events_of_stick_slip_keep_order_four() {
    is_four(order(&dr300(), 0.0, |t| 3.0 * (TAU * 3.0 * t).sin(), 16));
}
