//! A recording filtered with a drive.

use std::sync::Arc;

use drivescope_plant::model::SPEED;

use super::noise::Wandering;
use super::rows::Upper;
use super::state::{SENSORS, Vector};

/// Derivatives over a sample; most samples share them with the one before.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Step {
    /// Of the propagated state by the filtered one, but for the disturbances' own decay.
    pub(crate) transition: Upper,
    /// Of the propagated state by the rates of the states over the sample, s.
    pub(crate) input: Upper,
    /// Of what the sensors show by the predicted state.
    pub(crate) sense: [Vector; SENSORS],
}

/// A sample of a filtered recording; one that was not measured has no gain.
#[derive(Debug, Clone)]
pub(crate) struct Tick {
    /// Number of the sample.
    pub(crate) sample: usize,
    /// Whether a piece begins with it.
    pub(crate) begins: bool,
    /// The state before and after the sensors were read.
    pub(crate) predicted: Vector,
    pub(crate) filtered: Vector,
    /// The state one sample later, before anything is known of it.
    pub(crate) propagated: Vector,
    /// The mean over the sample.
    pub(crate) mean: Vector,
    /// Number of its derivatives among those of the track.
    pub(super) step: usize,
    /// What the sensors should have shown.
    pub(crate) shown: [f64; SENSORS],
    /// Gains of the sensors, taken one after the other.
    pub(crate) gain: [Vector; SENSORS],
    /// Inverse standard deviation of each innovation; 0 where nothing was measured.
    pub(crate) inverse_sd: [f64; SENSORS],
    /// Each innovation in units of its standard deviation.
    pub(crate) innovation: [f64; SENSORS],
}

impl Tick {
    /// Acceleration over the sample that the model predicts, rad/s^2 (m/s^2).
    pub(crate) fn acceleration(&self, period_s: f64) -> f64 {
        (self.propagated[SPEED] - self.filtered[SPEED]) / period_s
    }
}

/// A recording filtered with a drive.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    pub(crate) ticks: Vec<Tick>,
    /// Derivatives over the samples.
    pub(super) steps: Arc<Vec<Step>>,
    /// What a torque does to the state over a sample in which the shaft slips, over what it does to
    /// the speed.
    pub(super) slipping: Vector,
    /// What the disturbances do by themselves.
    pub(super) wandering: Wandering,
    /// Logarithm of the likelihood, without its constant.
    pub(crate) log_likelihood: f64,
}

impl Track {
    /// The derivatives over a sample.
    pub(super) fn step(&self, tick: &Tick) -> &Step {
        &self.steps[tick.step]
    }

    /// A value of every tick in the place of its sample, of so many; 0 where there is none.
    pub(super) fn by_sample(&self, samples: usize, value: impl Fn(&Tick) -> f64) -> Vec<f64> {
        let mut values = vec![0.0; samples];
        for tick in &self.ticks {
            values[tick.sample] = value(tick);
        }
        values
    }
}
