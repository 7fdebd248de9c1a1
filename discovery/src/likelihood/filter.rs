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

use drivescope_numerics::dispatch::{Work, widest};
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::model::{CURRENT, POSITION, SPEED};

use super::beginning::beginning;
use super::direction::Direction;
use super::linear::{Along, Itself, Linearised};
use super::noise::{Noise, Wandering};
use super::rows::{NO_ROWS, Row, Rows, add};
use super::state::{SENSORS, STATES, Vector, holds_a_cycle};
use super::track::{Step, Tick, Track};
use crate::measured::Measured;

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
            let number = ticks.len();
            ticks.push(Tick {
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
            });
            // Where it stays: it is large, and the passes are many.
            let tick = &mut ticks[number];
            let senses = plant.shown(tick);
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
            let step = plant.propagate(tick);
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
        wandering.advance(&step.transition, covariance, &NO_ROWS);
        // As the covariance is symmetric, so is the whole.
        let half = *covariance;
        for (row, values) in covariance.iter_mut().enumerate() {
            for (value, column) in values.iter_mut().zip(&half) {
                *value = column[row];
            }
        }
        wandering.advance(&step.transition, covariance, &NO_ROWS);
    }
}
