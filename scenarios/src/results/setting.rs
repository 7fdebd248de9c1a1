//! What was studied: the drive and its noise, the faults and when they act.

use serde::{Deserialize, Serialize};

/// A drive in a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveSummary {
    pub name: String,
    /// Hexadecimal digest of its file.
    pub digest: String,
    /// Set point of the experiment in the unit of T.
    pub set_point: f64,
    /// Unit of T.
    pub tacho_unit: String,
    /// Sampling time, s.
    pub period_s: f64,
}

/// Standard deviations, SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NoiseSummary {
    /// Reference, rad/s (m/s).
    pub reference: f64,
    /// Tachometer, rad/s (m/s).
    pub omega: f64,
    /// Current, A.
    pub i: f64,
    /// Disturbance torque, N m (N).
    pub torque: f64,
    /// Its correlation time, s.
    pub torque_time: f64,
}

/// The samples over which a fault acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultSpan {
    /// The first.
    pub from: usize,
    /// The first after it.
    pub to: usize,
}

/// What "motor torque increased by a share" means (the paper does not say).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueReading {
    /// Excitation flux: K_m and K_e change.
    Flux,
    /// K_m alone changes.
    TorqueConstant,
    /// The amplifier's gain changes.
    Actuator,
    /// A load of that share of the rated torque.
    Load,
}

impl TorqueReading {
    /// Every reading, the default first.
    pub const ALL: [Self; 4] = [Self::Flux, Self::TorqueConstant, Self::Actuator, Self::Load];

    /// The fault mechanism of the plant.
    pub fn mechanism(self) -> &'static str {
        match self {
            Self::Flux => "flux",
            Self::TorqueConstant => "torque_constant",
            Self::Actuator => "actuator",
            Self::Load => "load",
        }
    }
}

/// A fault by what it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultName {
    /// Mechanism.
    pub kind: String,
    /// Size, a fraction.
    pub size: f64,
    /// The paper's label.
    pub label: String,
}
