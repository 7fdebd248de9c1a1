//! What hides: effects of the library, sized for a machine.

use rand::RngExt as _;
use rand_pcg::Pcg64;

use super::machine::Machine;

/// What can be hidden: the kind, and its coefficients for a machine.
pub(super) type Hide = (&'static str, fn(&Machine, &mut Pcg64) -> Vec<(&'static str, f64)>);

pub(super) const HIDDEN: [Hide; 15] = [
    ("constant_load", |m, r| vec![("T_0", sign(r) * 0.05 * m.torque())]),
    ("asymmetric_friction", |m, r| {
        let side = sign(r);
        vec![("dT_c", side * 0.3 * m.t_c), ("dB_m", side * 0.15 * m.t_c / (0.5 * m.top()))]
    }),
    ("stribeck", |m, r| {
        vec![("T_b", 0.5 * m.t_c), ("omega_s", r.random_range(0.02..0.05) * m.top())]
    }),
    ("quadratic_drag", |m, _| vec![("c", 0.15 * m.torque() / (0.5 * m.top()).powi(2))]),
    ("load_friction", |_, r| vec![("c", r.random_range(0.1..0.15))]),
    ("friction_drift", |m, r| {
        vec![("T_d", sign(r) * 0.4 * m.t_c), ("B_d", 0.0), ("tau", r.random_range(4.0..8.0))]
    }),
    ("cogging", |m, r| {
        let (a, b) = at_any_phase(r, 0.08 * m.torque());
        vec![("N", [2.0, 3.0, 4.0, 6.0, 8.0, 12.0][r.random_range(0..6)]), ("a", a), ("b", b)]
    }),
    ("unbalance", |m, r| {
        let (a, b) = at_any_phase(r, 0.08 * m.torque());
        vec![("a", a), ("b", b)]
    }),
    ("torque_ripple", |_, r| {
        let (a, b) = at_any_phase(r, 0.05);
        vec![("N", [2.0, 3.0, 4.0, 6.0, 8.0][r.random_range(0..5)]), ("a", a), ("b", b)]
    }),
    ("saturation", |m, _| vec![("c", 0.15 / (0.2 * m.volts / m.r).powi(2))]),
    ("brush_drop", |m, r| {
        vec![("V_b", 0.03 * m.volts), ("i_b", r.random_range(0.05..0.15) * m.amps)]
    }),
    ("winding_heating", |m, r| {
        let heat = m.r * (0.15 * m.volts / m.r).powi(2) * 8.0;
        let (rise, slow) = (0.4 / 0.0039, r.random_range(6.0..12.0));
        vec![("alpha", 0.0039), ("C_th", heat / rise), ("R_th", slow * rise / heat)]
    }),
    ("speed_sensor_lag", |_, r| vec![("tau", r.random_range(0.006..0.012))]),
    ("tacho_eccentricity", |_, r| {
        let (a, b) = at_any_phase(r, 0.02);
        vec![("a", a), ("b", b)]
    }),
    ("current_offset", |m, r| vec![("i_0", sign(r) * 0.08 * m.amps)]),
];

/// Pairs that differ in what they fail over.
pub(super) const PAIRS: [[&str; 2]; 6] = [
    ["cogging", "quadratic_drag"],
    ["constant_load", "torque_ripple"],
    ["saturation", "unbalance"],
    ["brush_drop", "cogging"],
    ["asymmetric_friction", "speed_sensor_lag"],
    ["load_friction", "current_offset"],
];

/// One or the other, equally likely.
pub(super) fn sign(random: &mut Pcg64) -> f64 {
    if random.random_bool(0.5) { 1.0 } else { -1.0 }
}

/// An amplitude in a random phase.
fn at_any_phase(random: &mut Pcg64, amplitude: f64) -> (f64, f64) {
    let (sin, cos) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
    (amplitude * cos, amplitude * sin)
}
