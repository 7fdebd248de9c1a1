//! What is random in a recording: two disturbances, each an Ornstein-Uhlenbeck process, and the noise
//! of the sensors.

use super::filter::SENSORS;

/// What is random in a recording: two disturbances and the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation of the load over the inertia, rad/s^2 (m/s^2), and its correlation time, s.
    pub(crate) load_sd: f64,
    pub(crate) load_s: f64,
    /// Standard deviation of the voltage over the inductance, A/s, and its correlation time, s.
    pub(crate) voltage_sd: f64,
    pub(crate) voltage_s: f64,
    /// Standard deviation of each sensor's noise, in its unit.
    pub(crate) sensors: [f64; SENSORS],
}

impl Noise {
    /// Share of each disturbance that is left after a sample.
    pub(crate) fn left(&self, period_s: f64) -> [f64; 2] {
        [self.load_s, self.voltage_s].map(|time| (-period_s / time).exp())
    }

    /// Variances that a sample adds to the disturbances.
    pub(crate) fn added(&self, period_s: f64) -> [f64; 2] {
        let [load, voltage] = self.left(period_s);
        [
            self.load_sd * self.load_sd * (1.0 - load * load),
            self.voltage_sd * self.voltage_sd * (1.0 - voltage * voltage),
        ]
    }
}
