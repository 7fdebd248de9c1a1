//! Laws that no library has, sized for a machine: what a formula must be found for.

use drivescope_plant::drive::{EffectData, LawData};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::file::CUSTOM;
use rand::RngExt as _;
use rand_pcg::Pcg64;

use super::hidden::sign;
use super::machine::Machine;

/// A law: name, what it gives, its text, and its parameters for a machine.
pub(super) type Law =
    (&'static str, Target, &'static str, fn(&Machine, &mut Pcg64) -> Vec<(&'static str, f64)>);

/// A speed that a bench run often has.
fn speed(machine: &Machine) -> f64 {
    0.3 * machine.top()
}

/// A current that it seldom exceeds.
fn current(machine: &Machine) -> f64 {
    0.4 * machine.volts / machine.r
}

/// A coefficient that makes a law of that value a share of the torque of the machine.
fn torque(machine: &Machine, value: f64) -> f64 {
    -0.1 * machine.torque() / value
}

/// The same of its voltage.
fn voltage(machine: &Machine, value: f64) -> f64 {
    -0.05 * machine.volts / value
}

/// A coefficient that makes a law of that value a share of the torque of that current, which then
/// stays the greater one.
fn torque_of_current(machine: &Machine, value: f64) -> f64 {
    -0.2 * machine.torque() / machine.amps * current(machine) / value
}

pub(super) const LAWS: [Law; 16] = [
    ("drag of power 1.5", Target::Torque, "c * omega * abs(omega)^0.5", |m, _| {
        vec![("c", 3.0 * torque(m, speed(m).powf(1.5)))]
    }),
    ("cubic drag", Target::Torque, "c * omega^3", |m, _| vec![("c", torque(m, speed(m).powi(3)))]),
    ("drag that current eases", Target::Torque, "c * i * omega", |m, r| {
        vec![("c", sign(r) * torque_of_current(m, speed(m) * current(m)))]
    }),
    ("drag that current raises", Target::Torque, "c * abs(i) * omega", |m, _| {
        vec![("c", torque_of_current(m, speed(m) * current(m)))]
    }),
    ("friction by the square of the current", Target::Torque, "c * sign(omega) * i^2", |m, _| {
        vec![("c", torque_of_current(m, current(m).powi(2)))]
    }),
    (
        "friction that fades with speed",
        Target::Torque,
        "c * exp(-(omega / w)^2) * tanh(omega / s)",
        |m, r| {
            let w = r.random_range(0.15..0.3) * m.top();
            vec![("c", torque(m, 1.0)), ("w", w), ("s", 0.1 * w)]
        },
    ),
    ("drag that turns with the shaft", Target::Torque, "c * sin(n * theta) * omega", |m, r| {
        let n = f64::from(r.random_range(1..6_u8));
        vec![("c", 1.5 * torque(m, speed(m))), ("n", n)]
    }),
    (
        "friction that turns with the shaft",
        Target::Torque,
        "c * (1 + a * sin(theta)) * sign(omega)",
        |m, _| vec![("c", torque(m, 1.0)), ("a", 0.8)],
    ),
    ("torque by the cube of the current", Target::Torque, "c * i^3", |m, _| {
        vec![("c", -torque_of_current(m, current(m).powi(3)))]
    }),
    ("drag that decays", Target::Torque, "c * omega * exp(-abs(omega) / a)", |m, r| {
        let a = r.random_range(0.08..0.15) * m.top();
        vec![("c", 3.0 * torque(m, a)), ("a", a)]
    }),
    ("pull by the square of the speed", Target::Torque, "c * omega^2", |m, r| {
        vec![("c", sign(r) * torque(m, speed(m).powi(2)))]
    }),
    ("voltage by the root of the current", Target::Voltage, "c * sign(i) * abs(i)^0.5", |m, _| {
        vec![("c", 2.0 * voltage(m, current(m).sqrt()))]
    }),
    ("voltage by current and speed", Target::Voltage, "c * i * omega", |m, r| {
        vec![("c", sign(r) * voltage(m, current(m) * speed(m)))]
    }),
    ("voltage by the cube of the current", Target::Voltage, "c * i^3", |m, _| {
        vec![("c", voltage(m, current(m).powi(3)))]
    }),
    ("voltage by the square of the speed", Target::Voltage, "c * omega^2", |m, r| {
        vec![("c", 0.4 * sign(r) * voltage(m, speed(m).powi(2)))]
    }),
    ("resistance that turns with the shaft", Target::Voltage, "c * i * sin(n * theta)", |m, r| {
        let n = f64::from(r.random_range(1..6_u8));
        vec![("c", 2.0 * voltage(m, current(m))), ("n", n)]
    }),
];

/// A law as an effect of the machine.
pub(super) fn effect(law: &Law, machine: &Machine, random: &mut Pcg64) -> EffectData {
    let (name, target, text, parameters) = law;
    let parameters = parameters(machine, random).into_iter();
    EffectData {
        kind: CUSTOM.to_owned(),
        id: (*name).to_owned(),
        parameters: parameters.map(|(name, value)| (name.to_owned(), value)).collect(),
        law: Some(LawData::Typed { target: *target, text: (*text).to_owned() }),
    }
}
