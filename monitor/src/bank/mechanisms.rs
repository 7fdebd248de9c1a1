//! The mechanisms of a bank: those of the plant that shift what is measured.

use drivescope_diagnoser::bank::{MECHANISMS as MOST, Mechanism, SENSORS};
use drivescope_plant::drive::{AmplifierData, Drive};
use drivescope_plant::fault::{Faults, MECHANISMS, sensed};
use drivescope_plant::model::Motor;
use drivescope_plant::sampled::{amplified, input_limit, rated_torque, speed_bound};

/// A small size, for derivatives.
pub(super) const SMALL: f64 = 1e-3;
/// Greatest and least size of a gain, and of what may grow to a multiple.
const GAIN: (f64, f64) = (0.5, -0.5);
const MULTIPLE: (f64, f64) = (3.0, -0.9);
/// Mechanisms of the second kind: what resists a motion or a current has no upper end.
const MULTIPLES: [&str; 4] = ["load", "resistance", "friction", "inertia"];
/// How much less usual, in nats, an offset that appears is than a gain that changes: seven times.
/// The supply acts as the amplifier's gain does but for its limit, which few runs reach.
const RARER: f64 = 2.0;
const RARE: [&str; 3] = ["tacho_bias", "current_bias", "supply"];
/// Greatest bias, as a share of the sensor's range.
const BIAS: f64 = 0.5;

/// Where the faults of a drive enter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ports {
    pub(super) motor: Motor<f64>,
    pub(super) amplifier: Option<AmplifierData>,
    pub(super) rated_torque: f64,
}

impl Ports {
    pub(super) fn new(drive: &Drive) -> Self {
        Self {
            motor: drive.model().motors.lane(0),
            amplifier: drive.amplifier,
            rated_torque: rated_torque(drive).unwrap_or(0.0),
        }
    }

    /// The voltage that acts under a control effort.
    pub(super) fn voltage(&self, faults: &Faults<f64>, control: f64) -> f64 {
        amplified(self.amplifier, [faults.actuator, faults.supply], control)
    }

    /// Load torque that the faults add.
    pub(super) fn load(&self, faults: &Faults<f64>) -> f64 {
        self.rated_torque * faults.load
    }
}

/// What the sensors show of speed, current and voltage.
pub(super) fn shown(faults: &Faults<f64>, [omega, i, u]: [f64; SENSORS]) -> [f64; SENSORS] {
    let omega = sensed(omega, faults.tacho, faults.tacho_bias);
    [omega, sensed(i, faults.current_sensor, faults.current_bias), u]
}

/// Faults with one more.
pub(super) fn plus(mut faults: Faults<f64>, number: usize, size: f64) -> Faults<f64> {
    if let Some(own) = faults.size_mut(number) {
        *own += size;
    }
    faults
}

/// A mechanism in a bank.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    /// Its number among those of the plant.
    pub(super) number: usize,
    pub(super) about: Mechanism,
    /// Whether it acts on the sensors alone, and not on the state.
    pub(super) on_sensors: bool,
}

/// The mechanisms of a drive that a bank can hold, but for those that are left out.
pub(super) fn entries(drive: &Drive, left_out: &[&str]) -> Vec<Entry> {
    let ports = Ports::new(drive);
    let none = Faults::NONE;
    let all = MECHANISMS.iter().enumerate().filter(|(_, it)| !left_out.contains(&it.id));
    let entry = |(number, mechanism): (usize, &drivescope_plant::fault::Mechanism)| {
        let small = plus(none, number, SMALL);
        let on_sensors = shown(&small, [1.0; SENSORS]) != [1.0; SENSORS];
        let on_state = small.in_motor(&ports.motor) != ports.motor
            || ports.load(&small) != 0.0
            || ports.voltage(&small, 1.0) != ports.voltage(&none, 1.0);
        if !on_sensors && !on_state {
            return None;
        }
        let (most, least) = match mechanism.unit {
            "1" if MULTIPLES.contains(&mechanism.id) => MULTIPLE,
            "1" => GAIN,
            "A" => both(BIAS * greatest_current(drive)),
            _ => both(BIAS * speed_bound(drive)),
        };
        let (id, unit) = (mechanism.id.to_owned(), mechanism.unit.to_owned());
        let rarer = if RARE.contains(&mechanism.id) { RARER } else { 0.0 };
        let about = Mechanism { id, unit, most, least, rarer };
        Some(Entry { number, about, on_sensors })
    };
    all.filter_map(entry).take(MOST).collect()
}

fn both(most: f64) -> (f64, f64) {
    (most, -most)
}

/// Greatest current to expect, A: at standstill under full voltage.
pub(super) fn greatest_current(drive: &Drive) -> f64 {
    /// Where neither a limit nor a resistance is known.
    const USUAL: f64 = 10.0;
    match (input_limit(drive), drive.motor.r) {
        (Some(limit), Some(r)) => limit / r,
        (Some(limit), None) => limit,
        _ => USUAL,
    }
}
