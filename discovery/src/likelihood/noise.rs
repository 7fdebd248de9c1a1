//! What is random in a recording: two disturbances, each an Ornstein-Uhlenbeck process, a part of the
//! load that oscillates, and the noise of the sensors.

use std::f64::consts::TAU;

use super::rows::{LANES, Rows, Upper, add};
use super::state::{CYCLE, LOAD, SENSORS, VOLTAGE, Vector};

/// A load that oscillates at a frequency with an amplitude and a phase that wander (the stochastic
/// cycle of Harvey, Forecasting, Structural Time Series Models and the Kalman Filter, 1989, ch. 2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cycle {
    /// Standard deviation over the inertia, rad/s^2 (m/s^2).
    pub(crate) sd: f64,
    /// Frequency, Hz.
    pub(crate) hz: f64,
    /// Time after which it forgets its amplitude and phase, s.
    pub(crate) s: f64,
}

/// Longest time of a cycle, s: what oscillates longer is a line of any recording.
const LONGEST_S: f64 = 10.0;
/// Periods that it remembers at least: what forgets sooner does not oscillate.
const PERIODS: f64 = 2.0;

impl Cycle {
    /// With one of its numbers, in the order of the fields, moved by a factor; the frequency by what
    /// its time tells of it.
    pub(super) fn moved(self, number: usize, factor: f64) -> Self {
        let moved = match number {
            0 => Self { sd: self.sd * factor, ..self },
            1 => Self { hz: self.hz * (factor.ln() / (TAU * self.hz * self.s)).exp(), ..self },
            _ => Self { s: self.s * factor, ..self },
        };
        let shortest_s = PERIODS / moved.hz;
        Self { s: moved.s.clamp(shortest_s, shortest_s.max(LONGEST_S)), ..moved }
    }
}

/// What is random in a recording: two disturbances and the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation of the load over the inertia, rad/s^2 (m/s^2), and its correlation time, s.
    pub(crate) load_sd: f64,
    pub(crate) load_s: f64,
    /// Standard deviation of the voltage over the inductance, A/s, and its correlation time, s.
    pub(crate) voltage_sd: f64,
    pub(crate) voltage_s: f64,
    /// What oscillates of the load.
    pub(crate) cycle: Option<Cycle>,
    /// Standard deviation of each sensor's noise, in its unit.
    pub(crate) sensors: [f64; SENSORS],
}

/// What the disturbances do over a sample by themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wandering {
    /// Share that is left of the load and of the voltage.
    left: [f64; 2],
    /// What is left of the cycle in phase, and what it hands to its quadrature.
    rotation: Option<[f64; 2]>,
    /// Variances that a sample adds to the load, the voltage and the cycle.
    added: [f64; 3],
}

impl Noise {
    /// Over a sample.
    pub(super) fn wandering(&self, period_s: f64) -> Wandering {
        let left = [self.load_s, self.voltage_s].map(|time| (-period_s / time).exp());
        let added = |sd: f64, left: f64| sd * sd * (1.0 - left * left);
        let kept = self.cycle.map_or(0.0, |it| (-period_s / it.s).exp());
        let rotation = self.cycle.map(|it| (TAU * it.hz * period_s).sin_cos());
        Wandering {
            left,
            rotation: rotation.map(|(sin, cos)| [kept * cos, kept * sin]),
            added: [
                added(self.load_sd, left[0]),
                added(self.voltage_sd, left[1]),
                self.cycle.map_or(0.0, |it| added(it.sd, kept)),
            ],
        }
    }
}

impl Wandering {
    /// Without a random voltage.
    pub(super) fn of_load(self) -> Self {
        let ([load, _], [added, _, cycle]) = (self.left, self.added);
        Self { left: [load, 0.0], added: [added, 0.0, cycle], ..self }
    }

    /// The state as the plant sees it: with the whole load.
    pub(super) fn whole(&self, state: &Vector) -> Vector {
        let mut whole = *state;
        if self.rotation.is_some() {
            whole[LOAD] += state[CYCLE];
        }
        whole
    }

    /// Writes the disturbances one sample later.
    pub(super) fn carry(&self, from: &Vector, to: &mut Vector) {
        to[LOAD] = self.left[0] * from[LOAD];
        to[VOLTAGE] = self.left[1] * from[VOLTAGE];
        if let Some([cos, sin]) = self.rotation {
            to[CYCLE] = cos * from[CYCLE] + sin * from[CYCLE + 1];
            to[CYCLE + 1] = cos * from[CYCLE + 1] - sin * from[CYCLE];
        }
    }

    /// Columns of the state one sample later, with what is added to the states before the disturbances.
    #[inline(always)]
    pub(super) fn advance(&self, transition: &Upper, columns: &mut Rows, added: &Rows) {
        let mut load = columns[LOAD];
        if let Some([cos, sin]) = self.rotation {
            let [phase, quadrature] = [columns[CYCLE], columns[CYCLE + 1]];
            add(&mut load, 1.0, &phase);
            transition.advance(columns, &load, added);
            for lane in 0..LANES {
                columns[CYCLE][lane] = cos * phase[lane] + sin * quadrature[lane];
                columns[CYCLE + 1][lane] = cos * quadrature[lane] - sin * phase[lane];
            }
        } else {
            transition.advance(columns, &load, added);
        }
        for (state, left) in [LOAD, VOLTAGE].into_iter().zip(self.left) {
            for value in &mut columns[state] {
                *value *= left;
            }
        }
    }

    /// Adds what a sample adds to a covariance.
    pub(super) fn add_to(&self, covariance: &mut Rows) {
        let [load, voltage, cycle] = self.added;
        for (state, added) in [(LOAD, load), (VOLTAGE, voltage), (CYCLE, cycle), (CYCLE + 1, cycle)]
        {
            covariance[state][state] += added;
        }
    }
}
