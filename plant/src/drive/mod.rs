//! A drive as its file describes it: plain values in SI units, already checked.

mod field;
mod sections;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use sections::{
    AmplifierData, ControllerData, GeneratorData, MotorData, NoiseData, SensorData, TachoUnit,
};

pub(crate) use field::{ANY, Field};
pub(crate) use sections::fields;

use crate::effects::custom::Target;
use crate::effects::learned::{Curve, Factor, KnotError, Over};

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// The armature voltage.
    #[default]
    Voltage,
    /// A command that a fast current loop turns into the force (torque) K_m u.
    Force,
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
        /// What multiplies it.
        times: Option<Factor>,
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
