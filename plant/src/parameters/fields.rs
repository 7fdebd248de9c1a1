//! Every number of a drive besides those of its effects: key, unit, range, meaning, place.

use super::Role;
use crate::drive::{Drive, Motion};
use crate::units::name_for_motion;

/// Any finite number.
pub(super) const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Above zero.
const POSITIVE: (f64, f64) = (f64::MIN_POSITIVE, f64::INFINITY);
/// Zero or more.
const NOT_NEGATIVE: (f64, f64) = (0.0, f64::INFINITY);

/// A number of the drive: where it stands in the file, what it may be, where it lies in memory.
pub(crate) struct Field {
    /// Table of the drive file.
    pub(crate) section: &'static str,
    /// Key in that table, for a rotary drive.
    pub(crate) key: &'static str,
    /// Unit for a rotary drive.
    pub(crate) unit: &'static str,
    /// Least and greatest value that is possible.
    pub(crate) range: (f64, f64),
    /// Typical magnitude.
    pub(super) nominal: f64,
    /// What it is for.
    pub(super) role: Role,
    /// One line for a person.
    pub(crate) description: &'static str,
    /// Its value, if the drive has it.
    pub(super) get: fn(&Drive) -> Option<f64>,
    /// Its place, if the drive has it.
    pub(super) slot: fn(&mut Drive) -> Option<&mut f64>,
}

impl Field {
    /// The key for that motion: the noise of the speed is `omega` or `v`.
    pub(crate) fn key(&self, motion: Motion) -> &'static str {
        // Elsewhere the same letters mean other things.
        if self.section == "noise" { name_for_motion(motion, self.key) } else { self.key }
    }

    /// The name outside the file: the motor's symbols stand alone.
    pub(crate) fn name(&self, motion: Motion) -> String {
        let key = self.key(motion);
        if self.section == "motor" { key.to_owned() } else { format!("{}.{key}", self.section) }
    }
}

macro_rules! fields {
    ($($section:ident $key:literal [$unit:literal] $range:ident, $nominal:literal, $role:ident, $description:literal,
       $get:expr, $slot:expr;)+) => {
        /// The list, in the order in which it is shown.
        pub(crate) const FIELDS: &[Field] = &[$(Field {
            section: stringify!($section), key: $key, unit: $unit, range: $range, nominal: $nominal,
            role: Role::$role, description: $description, get: $get, slot: $slot,
        }),+];
    };
}

fields! {
    motor "R" ["ohm"] POSITIVE, 1.0, Physics, "armature resistance",
        |d| d.motor.r, |d| d.motor.r.as_mut();
    motor "L" ["H"] POSITIVE, 1e-3, Physics, "armature inductance",
        |d| d.motor.l, |d| d.motor.l.as_mut();
    motor "K_e" ["V s/rad"] POSITIVE, 0.05, Physics, "voltage constant",
        |d| d.motor.k_e, |d| d.motor.k_e.as_mut();
    motor "K_m" ["N m/A"] POSITIVE, 0.05, Physics, "torque constant (force-driven: torque or force a unit of u)",
        |d| Some(d.motor.k_m), |d| Some(&mut d.motor.k_m);
    motor "J" ["kg m^2"] POSITIVE, 1e-4, Physics, "moment of inertia (linear: mass)",
        |d| Some(d.motor.j), |d| Some(&mut d.motor.j);
    motor "B_m" ["N m s/rad"] NOT_NEGATIVE, 1e-5, Physics, "viscous friction",
        |d| Some(d.motor.b_m), |d| Some(&mut d.motor.b_m);
    motor "rated_torque" ["N m"] POSITIVE, 0.1, Rating, "rated torque: what a load fault is a fraction of",
        |d| d.motor.rated_torque, |d| d.motor.rated_torque.as_mut();
    controller "K_p" ["V s/rad"] NOT_NEGATIVE, 0.05, Control, "proportional gain",
        |d| Some(d.controller?.k_p), |d| Some(&mut d.controller.as_mut()?.k_p);
    controller "K_i" ["V/rad"] NOT_NEGATIVE, 0.5, Control, "integral gain",
        |d| Some(d.controller?.k_i), |d| Some(&mut d.controller.as_mut()?.k_i);
    controller "period" ["s"] POSITIVE, 0.005, Control, "sampling time; without it the controller is continuous",
        |d| d.controller?.period, |d| d.controller.as_mut()?.period.as_mut();
    controller "limit" ["V"] POSITIVE, 10.0, Control, "the control signal C_m is kept within -limit and +limit",
        |d| d.controller?.limit, |d| d.controller.as_mut()?.limit.as_mut();
    amplifier "gain" ["1"] POSITIVE, 1.0, Control, "gain from the control signal C_m to u",
        |d| Some(d.amplifier?.gain), |d| Some(&mut d.amplifier.as_mut()?.gain);
    amplifier "limit" ["V"] POSITIVE, 24.0, Control, "u is kept within -limit and +limit",
        |d| d.amplifier?.limit, |d| d.amplifier.as_mut()?.limit.as_mut();
    generator "K_m" ["N m/A"] POSITIVE, 0.05, Control, "torque constant of the second motor",
        |d| Some(d.generator?.k_m), |d| Some(&mut d.generator.as_mut()?.k_m);
    generator "gain" ["A/V"] POSITIVE, 0.2, Control, "gain from the control signal C_g to the current I_g",
        |d| Some(d.generator?.gain), |d| Some(&mut d.generator.as_mut()?.gain);
    generator "limit" ["A"] POSITIVE, 2.0, Control, "the current I_g is kept within -limit and +limit",
        |d| d.generator?.limit, |d| d.generator.as_mut()?.limit.as_mut();
    sensors "tacho_quantum" ["rad/s"] NOT_NEGATIVE, 0.1, Sensing, "step of the tachometer",
        |d| Some(d.sensors.tacho_quantum), |d| Some(&mut d.sensors.tacho_quantum);
    sensors "current_quantum" ["A"] NOT_NEGATIVE, 0.01, Sensing, "step of the current sensor",
        |d| Some(d.sensors.current_quantum), |d| Some(&mut d.sensors.current_quantum);
    noise "omega" ["rad/s"] NOT_NEGATIVE, 0.1, Sensing, "standard deviation of the tachometer's noise",
        |d| Some(d.noise.omega), |d| Some(&mut d.noise.omega);
    noise "i" ["A"] NOT_NEGATIVE, 0.01, Sensing, "standard deviation of the current sensor's noise",
        |d| Some(d.noise.i), |d| Some(&mut d.noise.i);
    noise "theta" ["rad"] NOT_NEGATIVE, 0.001, Sensing, "standard deviation of the position sensor's noise",
        |d| Some(d.noise.theta), |d| Some(&mut d.noise.theta);
    noise "reference" ["rad/s"] NOT_NEGATIVE, 1.0, Sensing, "standard deviation of the reference's noise",
        |d| Some(d.noise.reference), |d| Some(&mut d.noise.reference);
    noise "torque" ["N m"] NOT_NEGATIVE, 0.001, Sensing, "standard deviation of the load torque (Ornstein-Uhlenbeck process)",
        |d| Some(d.noise.torque), |d| Some(&mut d.noise.torque);
    noise "torque_time" ["s"] NOT_NEGATIVE, 0.05, Sensing, "correlation time of the load torque",
        |d| Some(d.noise.torque_time), |d| Some(&mut d.noise.torque_time);
}
