//! A drive as its file describes it: plain values in SI units, already checked.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::effects::custom::Target;
use crate::effects::learned::{Curve, KnotError, Over};

/// Whether the drive turns or slides; it decides the units of every label.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// rad, rad/s, N m, kg m^2; variables `theta`, `omega`.
    Rotary,
    /// m, m/s, N, kg; variables `x`, `v`.
    Linear,
}

/// What the signal `u` is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// The armature voltage.
    Voltage,
    /// A command that a fast current loop turns into the force (torque) K_m u.
    Force,
}

/// Motor parameters, SI; R, L and K_e are absent where the drive is force-driven.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorData {
    /// What u is.
    pub input: Input,
    /// Armature resistance R, ohm.
    pub r: Option<f64>,
    /// Armature inductance L, H.
    pub l: Option<f64>,
    /// Voltage constant K_e, V s/rad.
    pub k_e: Option<f64>,
    /// Torque constant K_m, N m/A; force-driven: N m or N a unit of u.
    pub k_m: f64,
    /// Moment of inertia J, kg m^2.
    pub j: f64,
    /// Viscous friction B_m, N m s/rad.
    pub b_m: f64,
    /// Whether a fit keeps K_m = K_e.
    pub tie_k: bool,
    /// Rated torque, N m: what a load fault is a fraction of.
    pub rated_torque: Option<f64>,
}

/// One `[[effect]]` of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectData {
    /// Identifier of the law (`coulomb`, ..., `custom`).
    pub kind: String,
    /// The name under which its parameters appear: the kind, or `id` where several share it.
    pub id: String,
    /// Parameter names and values, in the order of the law.
    pub parameters: Vec<(String, f64)>,
    /// The law, if it stands in the drive file.
    pub law: Option<LawData>,
}

/// A law that the drive file gives.
#[derive(Debug, Clone, PartialEq)]
pub enum LawData {
    /// A typed one.
    Typed {
        /// What it gives.
        target: Target,
        /// Its text.
        text: String,
    },
    /// A curve, by its values at knots: the effect's parameters.
    Learned {
        /// What it gives.
        target: Target,
        /// What it goes over.
        over: Over,
        /// Its knots, SI.
        knots: Vec<f64>,
    },
}

impl LawData {
    /// Name of the value of a learned curve at the knot of that number, from 0.
    pub fn value_name(number: usize) -> String {
        format!("v_{number}")
    }
}

/// PI speed control (force-driven linear axes too: error in rad/s or m/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllerData {
    /// Proportional gain K_p, V s/rad.
    pub k_p: f64,
    /// Integral gain K_i, V/rad.
    pub k_i: f64,
    /// Sampling time, s; without it the controller is continuous.
    pub period: Option<f64>,
    /// Greatest magnitude of the control signal C_m, V.
    pub limit: Option<f64>,
}

/// The power amplifier from the control signal C_m to u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplifierData {
    /// Gain, V/V.
    pub gain: f64,
    /// Greatest magnitude of u, V.
    pub limit: Option<f64>,
}

/// The unit in which the tachometer signal T is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TachoUnit {
    /// The SI unit of the motion: rad/s or m/s.
    Si,
    /// Revolutions a minute (rotary drives only).
    Rpm,
}

impl TachoUnit {
    /// T of 1 rad/s (1 m/s).
    pub fn per_si(self) -> f64 {
        match self {
            Self::Si => 1.0,
            Self::Rpm => 30.0 / PI,
        }
    }
}

/// Resolution of the sensors; 0 for none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorData {
    /// Step of the tachometer, rad/s (m/s).
    pub tacho_quantum: f64,
    /// Step of the current sensor, A.
    pub current_quantum: f64,
    /// Unit of T.
    pub tacho_unit: TachoUnit,
}

/// Known standard deviations of the noise; 0 for none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseData {
    /// Of the tachometer, rad/s (m/s).
    pub omega: f64,
    /// Of the current sensor, A.
    pub i: f64,
    /// Of the position sensor, rad (m).
    pub theta: f64,
    /// Of the reference, rad/s (m/s).
    pub reference: f64,
    /// Of the load torque, N m (N): an Ornstein-Uhlenbeck process.
    pub torque: f64,
    /// Its correlation time, s.
    pub torque_time: f64,
}

/// The rig's second motor as a generator: a load torque K_m2 I_g that a current sets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeneratorData {
    /// Torque constant of the second motor, N m/A.
    pub k_m: f64,
    /// Gain from the control signal C_g to the generator's current I_g, A/V.
    pub gain: f64,
    /// Greatest current, A.
    pub limit: Option<f64>,
}

impl Motion {
    /// The curve over those knots: over the angle of a rotary drive it repeats.
    pub(crate) fn curve(self, over: Over, knots: &[f64]) -> Result<Curve, KnotError> {
        let repeats = over == Over::Position && self == Self::Rotary;
        Curve::new(over, knots, repeats.then_some(2.0 * PI))
    }
}

/// A whole drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// A name for people.
    pub name: String,
    /// Rotary or linear.
    pub motion: Motion,
    /// The motor.
    pub motor: MotorData,
    /// The effects, in the order of the file.
    pub effects: Vec<EffectData>,
    /// PI speed control, if there is any.
    pub controller: Option<ControllerData>,
    /// Power amplifier; without it u = C_m.
    pub amplifier: Option<AmplifierData>,
    /// Sensors.
    pub sensors: SensorData,
    /// Noise.
    pub noise: NoiseData,
    /// Load generator, if there is any.
    pub generator: Option<GeneratorData>,
    /// Parameters that a fit leaves as they are.
    pub fixed: Vec<String>,
    /// Parameters that may differ from recording to recording.
    pub per_recording: Vec<String>,
    /// Where values come from, by parameter name.
    pub origin: BTreeMap<String, String>,
}

impl Drive {
    /// An id that no effect of the drive has: `name`, or `name_2` and so on.
    #[must_use]
    pub fn free_id(&self, name: &str) -> String {
        let taken = |id: &String| self.effects.iter().any(|effect| effect.id == *id);
        let ids = (2..).map(|k| format!("{name}_{k}"));
        std::iter::once(name.to_owned()).chain(ids).find(|id| !taken(id)).unwrap_or_default()
    }
}
