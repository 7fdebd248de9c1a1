//! The drive with a random load torque and a random voltage as a state space, filtered along a
//! recording (extended Kalman filter).
//!
//! The state is what the drive's model has (current, speed, position, own states) and two
//! disturbances, d_T / J in the balance of torques and d_V / L in that of voltages, each an
//! Ornstein-Uhlenbeck process. A sample is advanced by the plant's own right-hand side from the
//! filtered state, linear over the sample; its derivative by that state, from duals, carries the
//! covariance (Anderson and Moore, Optimal Filtering, 1979, ch. 8). Dry friction acts against the
//! motion that was measured ([`Direction`]).
//! A random load is thus a part of the model and no excuse: whatever it explains has its price.

use std::sync::Arc;

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::integrate::{Work, widest};
use drivescope_plant::model::{CURRENT, OWN, POSITION, SPEED};
use nalgebra::SVector;

use super::beginning::beginning;
use super::direction::Direction;
use super::linear::{Along, Itself, Linearised, Step};
use super::noise::{Noise, Wandering};
use super::rows::{NO_ROWS, Row, Rows, add};
use crate::measured::Measured;

/// States of the filter at most: current, speed, position, three own states, d_T, d_V.
pub(crate) const STATES: usize = 8;
/// Own states of effects that the filter corrects.
pub(crate) const OWN_STATES: usize = 3;
/// Place of d_T / J and of d_V / L in the state.
pub(crate) const LOAD: usize = OWN + OWN_STATES;
pub(crate) const VOLTAGE: usize = LOAD + 1;
/// Place of what oscillates of d_T / J, with its quadrature behind it: that of own states which few
/// drives have.
pub(crate) const CYCLE: usize = LOAD - 2;
/// Sensors: of current, speed and position; those beside the motor are not filtered.
pub(crate) const SENSORS: usize = 3;

pub(crate) type Vector = SVector<f64, STATES>;

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
    /// Acceleration over the sample that the model foretells, rad/s^2 (m/s^2).
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

/// Own states of a drive's effects.
pub(crate) fn own_states(drive: &Drive) -> usize {
    drive.model().states() - OWN
}

/// Whether a part of the load may oscillate: where own states stand nothing else does.
pub(super) fn holds_a_cycle(drive: &Drive) -> bool {
    OWN + own_states(drive) <= CYCLE
}

/// Filters a recording. Nothing where the model overflows.
pub(crate) fn track(
    drive: &Drive,
    (measured, direction): (&Measured, &Direction),
    noise: &Noise,
) -> Option<Track> {
    let plant = Itself::new(drive, measured, direction);
    filter(drive, (measured, direction), noise, plant)
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

    /// The same recording with other noise, the plant as it was linearised along this track.
    pub(crate) fn with(
        &self,
        drive: &Drive,
        recording: (&Measured, &Direction),
        noise: &Noise,
    ) -> Option<Self> {
        filter(drive, recording, noise, Along::new(self))
    }
}

fn filter(
    drive: &Drive,
    (measured, direction): (&Measured, &Direction),
    noise: &Noise,
    mut plant: impl Linearised,
) -> Option<Track> {
    let noise = &Noise { cycle: noise.cycle.filter(|_| holds_a_cycle(drive)), ..*noise };
    let variances = noise.sensors.map(|sd| sd * sd);
    let mut wandering = noise.wandering(measured.period_s);
    if drive.motor.input == Input::Force {
        wandering = wandering.of_load();
    }
    let (mut ticks, mut log_likelihood) = (Vec::with_capacity(measured.len()), 0.0);
    plant.begin();
    let slipping = plant.slipping(measured.pieces.first().map_or(0, |piece| piece.start));
    for piece in &measured.pieces {
        plant.begin();
        let (mut mean, variance) = beginning(drive, measured, piece.start, noise);
        let mut covariance = NO_ROWS;
        (0..STATES).for_each(|state| covariance[state][state] = variance[state]);
        for sample in piece.clone() {
            if let Some(angle) = &measured.angle {
                mean[POSITION] = angle[sample];
                covariance[POSITION].fill(0.0);
                covariance.iter_mut().for_each(|row| row[POSITION] = 0.0);
            }
            let mut tick = Tick {
                sample,
                begins: sample == piece.start,
                predicted: mean,
                filtered: mean,
                propagated: mean,
                mean,
                step: 0,
                shown: [0.0; SENSORS],
                gain: [Vector::zeros(); SENSORS],
                inverse_sd: [0.0; SENSORS],
                innovation: [0.0; SENSORS],
            };
            let senses = plant.shown(&mut tick);
            for channel in &measured.outputs {
                let (sensor, value) = (channel.output as usize, channel.values[sample]);
                if sensor >= SENSORS || !value.is_finite() {
                    continue;
                }
                let sense = &senses[sensor];
                let mut seen: Row = [0.0; STATES];
                for (row, sense) in covariance.iter().zip(sense).filter(|(_, it)| **it != 0.0) {
                    add(&mut seen, *sense, row);
                }
                let seen = Vector::from(seen);
                let variance = sense.dot(&seen) + variances[sensor];
                let gain = seen / variance;
                let expected = tick.shown[sensor] + sense.dot(&(mean - tick.predicted));
                let innovation = value - expected;
                mean += gain * innovation;
                let seen: &Row = &seen.data.0[0];
                for (row, gain) in covariance.iter_mut().zip(&gain).filter(|(_, it)| **it != 0.0) {
                    add(row, -gain, seen);
                }
                tick.gain[sensor] = gain;
                tick.inverse_sd[sensor] = 1.0 / variance.sqrt();
                tick.innovation[sensor] = innovation * tick.inverse_sd[sensor];
                log_likelihood -= 0.5 * (tick.innovation[sensor].powi(2) + variance.ln());
            }
            tick.filtered = wandering.whole(&mean);
            let step = plant.propagate(&mut tick);
            widest(Carried { covariance: &mut covariance, step, wandering: &wandering });
            wandering.carry(&mean, &mut tick.propagated);
            mean = tick.propagated;
            wandering.add_to(&mut covariance);
            let loose = direction.loose(sample).powi(2);
            if loose > 0.0 {
                add_loose(&mut covariance, loose, &slipping, measured);
            }
            if !mean.iter().all(|value| value.is_finite()) {
                return None;
            }
            ticks.push(tick);
        }
    }
    log_likelihood.is_finite().then_some(Track {
        ticks,
        steps: plant.steps(),
        slipping,
        wandering,
        log_likelihood,
    })
}

/// Adds what any acceleration within a sample does, early or late in it, whose change of the speed has
/// that variance; own states follow as they do where the shaft slips.
fn add_loose(covariance: &mut Rows, loose: f64, slipping: &Vector, measured: &Measured) {
    let period = measured.period_s;
    let known = measured.angle.is_some();
    let mut moved = *slipping;
    (moved[CURRENT], moved[SPEED]) = (0.0, 1.0);
    moved[POSITION] = if known { 0.0 } else { 0.5 * period };
    for (row, factor) in covariance.iter_mut().zip(&moved) {
        add(row, loose * factor, &moved.data.0[0]);
    }
    if !known {
        covariance[POSITION][POSITION] += period * period * loose / 12.0;
    }
}

/// A covariance over a sample.
struct Carried<'a> {
    covariance: &'a mut Rows,
    step: &'a Step,
    wandering: &'a Wandering,
}

impl Work for Carried<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { covariance, step, wandering } = self;
        let over = |columns: &Rows| {
            let mut next = NO_ROWS;
            step.transition.add_times(&wandering.whole_of(columns), &mut next);
            wandering.carry_columns(columns, &mut next);
            next
        };
        let half = over(covariance);
        // As the covariance is symmetric, so is the whole.
        let turned = std::array::from_fn(|row| std::array::from_fn(|column| half[column][row]));
        *covariance = over(&turned);
    }
}
