//! The state in which a piece of a recording begins.

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::model::{CURRENT, SPEED};

use super::noise::Noise;
use super::state::{CYCLE, LOAD, SENSORS, VOLTAGE, Vector};
use crate::measured::{Measured, Output};
use crate::rms::rms;

/// The state in which a piece begins, as its first samples show it, and how little is known of each
/// of its numbers: variances.
pub(super) fn beginning(
    drive: &Drive,
    measured: &Measured,
    first: usize,
    noise: &Noise,
) -> (Vector, Vector) {
    let (mut mean, mut variance) = (Vector::zeros(), Vector::zeros());
    for channel in measured.outputs.iter().filter(|it| (it.output as usize) < SENSORS) {
        let place = channel.output as usize;
        let value = channel.values[first];
        mean[place] = if value.is_finite() { value } else { 0.0 };
        variance[place] = 0.1 * rms(channel.values.iter().copied()).powi(2);
    }
    if let (Some(x), None) = (measured.output(Output::Position), measured.output(Output::Speed)) {
        // A line through the first samples; the speed is known no better than it may be.
        let ahead = 10.min(x.values.len() - 1 - first);
        let slope =
            (x.values[first + ahead] - x.values[first]) / (ahead.max(1) as f64 * measured.period_s);
        mean[SPEED] = if slope.is_finite() { slope } else { 0.0 };
        let steps = x.values.windows(11).map(|w| (w[10] - w[0]) / (10.0 * measured.period_s));
        variance[SPEED] = 0.1 * rms(steps).powi(2);
    }
    if measured.output(Output::Current).is_none() && drive.motor.input == Input::Voltage {
        let resistance = drive.motor.r.unwrap_or(1.0);
        variance[CURRENT] = 0.1 * (rms(measured.u.iter().copied()) / resistance).powi(2);
    }
    if measured.output(Output::Speed).is_none() && measured.output(Output::Position).is_none() {
        let k = drive.motor.k_e.unwrap_or(1.0);
        variance[SPEED] = 0.1 * (rms(measured.u.iter().copied()) / k).powi(2);
    }
    variance[LOAD] = noise.load_sd.powi(2);
    variance[VOLTAGE] = noise.voltage_sd.powi(2);
    if let Some(cycle) = noise.cycle {
        variance[CYCLE] = cycle.sd.powi(2);
        variance[CYCLE + 1] = cycle.sd.powi(2);
    }
    (mean, variance)
}
