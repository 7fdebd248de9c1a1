//! Delay: u acts tau later than it is recorded or commanded (computing time, a bus, a sample
//! clock that differs from that of the sensors).
//!
//! It stands in no balance: [`crate::sampled::DelayLine`] holds u back and splits the intervals
//! over which it is held, so that a fraction of a sample is exact. Outputs that lag by tau all
//! together are the same thing, but for the time axis.

use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Variable};

/// The delay of u.
pub struct Delay;

impl Effect<1, 0> for Delay {
    const INFO: Info = Info {
        fails_over: &[Variable::Acceleration],
        acts_on: &[ActsOn::Torque, ActsOn::Voltage],
        aliases: &["speed_sensor_lag"],
        excludes: &["delay"],
        nulls: &[("tau", 0.0)],
        delays: true,
        ..Info::new(
            "delay",
            "u(t) -> u(t - tau)",
            "acceleration, in proportion, in every output: the slope of i too",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "tau",
        unit: "s",
        nominal: 5e-4,
        range: (0.0, LONGEST),
        description: "delay of u, any fraction or multiple of the sampling time",
    }];
    const STATES: [OwnState; 0] = [];

    fn affine_beyond(_: [f64; 1]) -> f64 {
        0.0
    }
}

/// Longest delay, s: what was set meanwhile is kept.
const LONGEST: f64 = 1.0;
