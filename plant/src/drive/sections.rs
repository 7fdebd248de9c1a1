//! The sections of the drive file with their numbers, each declared once: key, unit, range, typical
//! magnitude, role and meaning. Reading, checking, writing, the JSON Schema, the list of parameters
//! and the variables of FMUs derive from here.

use drivescope_units::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::field::{Field, NOT_NEGATIVE, Number, POSITIVE, section};
use super::{Drive, Input};
use crate::parameters::Role;

section! {
    /// Motor parameters, SI; R, L and K_e are absent where the drive is force-driven.
    MotorData = motor, |d| Some(&d.motor), |d| Some(&mut d.motor);
    {
        /// What u is.
        #[serde(default)]
        pub input: Input,
    }
    r: Option<f64> = "R" ["ohm"] POSITIVE, 1.0, Physics, "armature resistance";
    l: Option<f64> = "L" ["H"] POSITIVE, 1e-3, Physics, "armature inductance";
    k_e: Option<f64> = "K_e" ["V s/rad"] POSITIVE, 0.05, Physics, "voltage constant";
    k_m: f64 = "K_m" ["N m/A"] POSITIVE, 0.05, Physics,
        "torque constant (force-driven: torque or force a unit of u)";
    j: f64 = "J" ["kg m^2"] POSITIVE, 1e-4, Physics, "moment of inertia (linear: mass)";
    b_m: f64 = "B_m" ["N m s/rad"] NOT_NEGATIVE, 1e-5, Physics, "viscous friction";
    {
        /// Whether a fit keeps K_m = K_e.
        #[serde(rename = "tie_K", default, skip_serializing_if = "is_false")]
        pub tie_k: bool,
    }
    rated_torque: Option<f64> = "rated_torque" ["N m"] POSITIVE, 0.1, Rating,
        "rated torque: what a load fault is a fraction of";
}

section! {
    /// PI speed control (force-driven linear axes too: error in rad/s or m/s).
    ControllerData = controller, |d| d.controller.as_ref(), |d| d.controller.as_mut();
    {}
    k_p: f64 = "K_p" ["V s/rad"] NOT_NEGATIVE, 0.05, Control, "proportional gain";
    k_i: f64 = "K_i" ["V/rad"] NOT_NEGATIVE, 0.5, Control, "integral gain";
    period: Option<f64> = "period" ["s"] POSITIVE, 0.005, Control,
        "sampling time; without it the controller is continuous";
    limit: Option<f64> = "limit" ["V"] POSITIVE, 10.0, Control,
        "the control signal C_m is kept within -limit and +limit";
}

section! {
    /// The power amplifier from the control signal C_m to u.
    AmplifierData = amplifier, |d| d.amplifier.as_ref(), |d| d.amplifier.as_mut();
    {}
    gain: f64 = "gain" ["1"] POSITIVE, 1.0, Control, "gain from the control signal C_m to u";
    limit: Option<f64> = "limit" ["V"] POSITIVE, 24.0, Control,
        "u is kept within -limit and +limit";
}

section! {
    /// The rig's second motor as a generator: a load torque K_m2 I_g that a current sets.
    GeneratorData = generator, |d| d.generator.as_ref(), |d| d.generator.as_mut();
    {}
    k_m: f64 = "K_m" ["N m/A"] POSITIVE, 0.05, Control, "torque constant of the second motor";
    gain: f64 = "gain" ["A/V"] POSITIVE, 0.2, Control,
        "gain from the control signal C_g to the current I_g";
    limit: Option<f64> = "limit" ["A"] POSITIVE, 2.0, Control,
        "the current I_g is kept within -limit and +limit";
}

section! {
    /// Resolution of the sensors; 0 for none.
    #[derive(Default)]
    SensorData = sensors, |d| Some(&d.sensors), |d| Some(&mut d.sensors);
    {}
    #[serde(default, skip_serializing_if = "is_zero")]
    tacho_quantum: f64 = "tacho_quantum" ["rad/s"] NOT_NEGATIVE, 0.1, Sensing,
        "step of the tachometer";
    #[serde(default, skip_serializing_if = "is_zero")]
    current_quantum: f64 = "current_quantum" ["A"] NOT_NEGATIVE, 0.01, Sensing,
        "step of the current sensor";
    {
        /// Unit of the tachometer signal T; the SI unit of the motion if absent.
        #[serde(default, skip_serializing_if = "TachoUnit::is_si")]
        #[schemars(with = "Option<TachoName>")]
        pub tacho_unit: TachoUnit,
    }
}

section! {
    /// Known standard deviations of the noise; 0 for none. A linear drive calls its first and third
    /// number `v` and `x`, and may keep to these.
    #[derive(Default)]
    NoiseData = noise, |d| Some(&d.noise), |d| Some(&mut d.noise);
    {}
    #[serde(default, alias = "v")]
    omega: f64 = "omega" ["rad/s"] NOT_NEGATIVE, 0.1, Sensing,
        "standard deviation of the tachometer's noise";
    #[serde(default)]
    i: f64 = "i" ["A"] NOT_NEGATIVE, 0.01, Sensing,
        "standard deviation of the current sensor's noise";
    #[serde(default, alias = "x")]
    theta: f64 = "theta" ["rad"] NOT_NEGATIVE, 0.001, Sensing,
        "standard deviation of the position sensor's noise";
    #[serde(default)]
    reference: f64 = "reference" ["rad/s"] NOT_NEGATIVE, 1.0, Sensing,
        "standard deviation of the reference's noise";
    #[serde(default)]
    torque: f64 = "torque" ["N m"] NOT_NEGATIVE, 0.001, Sensing,
        "standard deviation of the load torque (Ornstein-Uhlenbeck process)";
    #[serde(default)]
    torque_time: f64 = "torque_time" ["s"] NOT_NEGATIVE, 0.05, Sensing,
        "correlation time of the load torque";
}

/// Every number of a drive besides those of its effects, in the order in which they are shown.
pub(crate) fn fields() -> impl Iterator<Item = &'static Field> {
    [
        MotorData::FIELDS,
        ControllerData::FIELDS,
        AmplifierData::FIELDS,
        GeneratorData::FIELDS,
        SensorData::FIELDS,
        NoiseData::FIELDS,
    ]
    .into_iter()
    .flatten()
}

/// Zero means that there is none: then the key is left out.
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn is_false(value: &bool) -> bool {
    !value
}

/// The unit in which the tachometer signal T is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(from = "TachoName", into = "TachoName")]
pub enum TachoUnit {
    /// The SI unit of the motion: rad/s or m/s.
    #[default]
    Si,
    /// Revolutions a minute (rotary drives only).
    Rpm,
}

impl TachoUnit {
    /// T of 1 rad/s (1 m/s).
    pub fn per_si(self) -> f64 {
        match self {
            Self::Si => 1.0,
            Self::Rpm => Unit::RPM.from_si(1.0),
        }
    }

    fn is_si(&self) -> bool {
        *self == Self::Si
    }
}

/// Unit of the tachometer signal T as it is written.
#[derive(Debug, Clone, Copy, Deserialize, Serialize, JsonSchema)]
enum TachoName {
    #[serde(rename = "rad/s")]
    Rotary,
    #[serde(rename = "m/s")]
    Linear,
    #[serde(rename = "rpm")]
    Rpm,
}

impl From<TachoName> for TachoUnit {
    fn from(name: TachoName) -> Self {
        match name {
            TachoName::Rotary | TachoName::Linear => Self::Si,
            TachoName::Rpm => Self::Rpm,
        }
    }
}

impl From<TachoUnit> for TachoName {
    fn from(unit: TachoUnit) -> Self {
        match unit {
            TachoUnit::Si => Self::Rotary,
            TachoUnit::Rpm => Self::Rpm,
        }
    }
}
