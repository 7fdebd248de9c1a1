//! What `study` and the benchmarks of the twelve faults ask alike.

use clap::{Args, ValueEnum};
use drivescope_scenarios::results::TorqueReading;

/// The drive that has the faults, and what they are.
#[derive(Debug, Args)]
pub(super) struct TwelveFaults {
    /// Drive file, or the name of a built-in drive.
    #[arg(long, value_name = "FILE", default_value = "dr300")]
    pub(super) drive: String,
    /// What a motor torque that changes by a share means.
    #[arg(long, value_enum, default_value_t = Reading::Flux)]
    pub(super) torque: Reading,
}

/// The same, where bands detect them.
#[derive(Debug, Args)]
pub(super) struct TwelveDetected {
    #[command(flatten)]
    pub(super) faults: TwelveFaults,
    /// Confidence level of the bands: share of healthy samples outside them.
    #[arg(long, default_value_t = 0.05)]
    pub(super) beta: f64,
}

/// Readings of the torque fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(super) enum Reading {
    /// The excitation flux changes: K_m and K_e.
    Flux,
    /// K_m alone changes.
    TorqueConstant,
    /// The gain of the amplifier changes.
    Actuator,
    /// A load of that share of the rated torque.
    Load,
}

impl From<Reading> for TorqueReading {
    fn from(torque: Reading) -> Self {
        match torque {
            Reading::Flux => Self::Flux,
            Reading::TorqueConstant => Self::TorqueConstant,
            Reading::Actuator => Self::Actuator,
            Reading::Load => Self::Load,
        }
    }
}
