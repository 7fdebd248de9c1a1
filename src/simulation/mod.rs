//! Runs of a drive for `simulate`: a closed or open loop driven by typed signals ([`typed`]), or
//! the model driven by a recording ([`replay`]).
//!
//! Both are runs of [`drivescope_plant::unit::Unit`], the same code that an exported FMU runs.

pub(crate) mod fault;
pub(crate) mod replay;
pub(crate) mod start;
pub(crate) mod typed;

use drivescope_plant::drive::{Drive, Input, NoiseData, TachoUnit};
use drivescope_plant::unit::Unit;
use drivescope_plant::units::{for_motion, name_for_motion};
use drivescope_recording::Signal;

/// Samples between two looks at whether the user wants the run to end.
pub(crate) const SAMPLES_A_LOOK: usize = 4096;

/// The drive with ideal sensors: no noise, no quantisation, no disturbance.
pub(crate) fn without_noise(drive: &Drive) -> Drive {
    let mut ideal = drive.clone();
    ideal.noise = NoiseData::default();
    ideal.sensors.tacho_quantum = 0.0;
    ideal.sensors.current_quantum = 0.0;
    ideal
}

/// A unit's variables by name. The names are the unit's own, so each exists.
pub(crate) fn place(unit: &Unit, name: &str) -> usize {
    unit.reference(name).unwrap_or_else(|| panic!("a unit has the variable `{name}`"))
}

/// Name and unit of the drive's speed.
pub(crate) fn speed(drive: &Drive) -> (&'static str, String) {
    (name_for_motion(drive.motion, "omega"), for_motion(drive.motion, "rad/s"))
}

/// Name and unit of the drive's position.
pub(crate) fn position(drive: &Drive) -> (&'static str, String) {
    (name_for_motion(drive.motion, "theta"), for_motion(drive.motion, "rad"))
}

/// Name of the state that holds the speed, and of the one that holds the position.
pub(crate) fn shaft_states(drive: &Drive) -> [String; 2] {
    [speed(drive).0, position(drive).0].map(|name| format!("shaft.{name}"))
}

/// Unit of the tachometer signal.
pub(crate) fn tacho_unit(drive: &Drive) -> String {
    match drive.sensors.tacho_unit {
        TachoUnit::Rpm => "rpm".to_owned(),
        TachoUnit::Si => speed(drive).1,
    }
}

/// Whether there is an armature current: a force-driven drive has none in the model.
pub(crate) fn has_current(drive: &Drive) -> bool {
    drive.motor.input == Input::Voltage
}

/// An empty column for that many samples.
pub(crate) fn column(name: &str, unit: impl Into<String>, samples: usize) -> Signal {
    Signal { name: name.to_owned(), unit: unit.into(), values: Vec::with_capacity(samples) }
}
