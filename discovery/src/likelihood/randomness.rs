//! How random the load, the voltage and the sensors are: what makes the recordings most probable.

use super::noise::{Cycle, Noise};
use super::state::SENSORS;

/// Correlation time of the random voltage, s.
const VOLTAGE_S: f64 = 0.02;

/// ln of the prior odds of a load that oscillates: a thousand frequencies were to choose from, and its size
/// and memory are known to an octave of ten.
const OSCILLATES: f64 = -12.0;

/// Two disturbances, and factors on what is known of the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Randomness {
    /// Standard deviation of the load over the inertia, rad/s^2 (m/s^2), and its correlation time,
    /// s. So a fit that moves the inertia does not move what is random.
    pub(crate) load_sd: f64,
    pub(crate) load_s: f64,
    /// Standard deviation of the voltage over the inductance, A/s.
    pub(crate) voltage_sd: f64,
    /// What oscillates of the load.
    pub(crate) cycle: Option<Cycle>,
    /// Factor on each sensor's noise.
    pub(crate) sensors: [f64; SENSORS],
}

impl Randomness {
    /// In a recording whose sensors have that noise.
    pub(crate) fn at(&self, noise: &[f64; SENSORS]) -> Noise {
        Noise {
            load_sd: self.load_sd,
            load_s: self.load_s,
            voltage_sd: self.voltage_sd,
            voltage_s: VOLTAGE_S,
            cycle: self.cycle,
            sensors: std::array::from_fn(|sensor| self.sensors[sensor] * noise[sensor]),
        }
    }

    /// ln of its prior odds over a load that does not oscillate.
    pub(super) fn ln_prior(&self) -> f64 {
        if self.cycle.is_some() { OSCILLATES } else { 0.0 }
    }

    /// With a load of another size.
    pub(crate) fn scaled(&self, load: f64) -> Self {
        let cycle = self.cycle.map(|it| Cycle { sd: load * it.sd, ..it });
        Self { load_sd: load * self.load_sd, cycle, ..*self }
    }

    /// With a load that forgets what it was after another time, s, and does the same within a few
    /// samples.
    pub(crate) fn with_time(&self, load_s: f64) -> Self {
        Self { load_s, load_sd: self.load_sd * (load_s / self.load_s).sqrt(), ..*self }
    }
}
