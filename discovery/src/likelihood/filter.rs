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

use drivescope_numerics::Dual;
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::model::{CURRENT, OWN, POSITION, SPEED};
use nalgebra::{SMatrix, SVector};

use super::direction::Direction;
use super::exponential::Exponential;
use super::noise::Noise;
use super::plant::Plant;
use crate::measured::{Measured, Output};

/// States of the filter at most: current, speed, position, three own states, d_T, d_V.
pub(crate) const STATES: usize = 8;
/// Own states of effects that the filter corrects.
pub(crate) const OWN_STATES: usize = 3;
/// Place of d_T / J and of d_V / L in the state.
pub(crate) const LOAD: usize = OWN + OWN_STATES;
pub(crate) const VOLTAGE: usize = LOAD + 1;
/// Parts of a sample in which teeth may meet, and parts of the armature's time constant.
const KNOCKING: usize = 8;
const SETTLING: f64 = 6.0;
/// Sensors: of current, speed and position; those beside the motor are not filtered.
pub(crate) const SENSORS: usize = 3;

pub(crate) type Vector = SVector<f64, STATES>;
pub(crate) type Square = SMatrix<f64, STATES, STATES>;
type Number = Dual<STATES>;

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
    /// Derivative of the propagated state by the filtered one.
    pub(crate) transition: Square,
    /// The same by the rates of the states over the sample, s.
    pub(crate) input: Square,
    /// What the sensors should have shown, and the derivative by the predicted state.
    pub(crate) shown: [f64; SENSORS],
    pub(crate) sense: [Vector; SENSORS],
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
    /// Logarithm of the likelihood, without its constant.
    pub(crate) log_likelihood: f64,
}

/// Own states of a drive's effects.
pub(crate) fn own_states(drive: &Drive) -> usize {
    drive.model().states() - OWN
}

/// The state in which a piece begins, as its first samples show it, and how little is known of it.
fn beginning(drive: &Drive, measured: &Measured, first: usize, noise: &Noise) -> (Vector, Square) {
    let (mut mean, mut covariance) = (Vector::zeros(), Square::zeros());
    let rms = |values: &[f64]| {
        let finite = || values.iter().filter(|y| y.is_finite());
        (finite().map(|y| y * y).sum::<f64>() / finite().count().max(1) as f64).sqrt()
    };
    for channel in measured.outputs.iter().filter(|it| (it.output as usize) < SENSORS) {
        let place = channel.output as usize;
        let value = channel.values[first];
        mean[place] = if value.is_finite() { value } else { 0.0 };
        covariance[(place, place)] = 0.1 * rms(&channel.values).powi(2);
    }
    if let (Some(x), None) = (measured.output(Output::Position), measured.output(Output::Speed)) {
        // A line through the first samples; the speed is known no better than it may be.
        let ahead = 10.min(x.values.len() - 1 - first);
        let slope =
            (x.values[first + ahead] - x.values[first]) / (ahead.max(1) as f64 * measured.period_s);
        mean[SPEED] = if slope.is_finite() { slope } else { 0.0 };
        let steps = x.values.windows(11).map(|w| (w[10] - w[0]) / (10.0 * measured.period_s));
        let speeds: Vec<f64> = steps.collect();
        covariance[(SPEED, SPEED)] = 0.1 * rms(&speeds).powi(2);
    }
    if measured.output(Output::Current).is_none() && drive.motor.input == Input::Voltage {
        let resistance = drive.motor.r.unwrap_or(1.0);
        covariance[(CURRENT, CURRENT)] = 0.1 * (rms(&measured.u) / resistance).powi(2);
    }
    if measured.output(Output::Speed).is_none() && measured.output(Output::Position).is_none() {
        let k = drive.motor.k_e.unwrap_or(1.0);
        covariance[(SPEED, SPEED)] = 0.1 * (rms(&measured.u) / k).powi(2);
    }
    covariance[(LOAD, LOAD)] = noise.load_sd.powi(2);
    covariance[(VOLTAGE, VOLTAGE)] = noise.voltage_sd.powi(2);
    (mean, covariance)
}

/// What the model foretells of a sample, and its derivative.
trait Linearised {
    /// A piece begins.
    fn begin(&mut self);
    /// What the sensors show of the predicted state.
    fn shown(&mut self, tick: &mut Tick);
    /// The filtered state one sample later, disturbances left out.
    fn propagate(&mut self, tick: &mut Tick);
}

/// The plant itself, its rates linear over a part of a sample.
struct Itself<'a> {
    plant: Plant<'a, STATES>,
    direction: &'a Direction,
    exponential: Exponential,
    /// Parts of a sample, and how long each is, s.
    parts: usize,
    part_s: f64,
}

impl Linearised for Itself<'_> {
    fn begin(&mut self) {
        self.plant.begin();
    }

    fn shown(&mut self, tick: &mut Tick) {
        self.plant.enter(tick.sample);
        let shown = self.plant.shown(&tick.predicted, Number::parameter);
        tick.shown = shown.map(|it| it.v);
        tick.sense = shown.map(|it| Vector::from(it.d));
    }

    fn propagate(&mut self, tick: &mut Tick) {
        tick.propagated = tick.filtered;
        tick.transition = Square::identity();
        let direction = self.direction.at(tick.sample);
        tick.mean = Vector::zeros();
        for _ in 0..self.parts {
            self.plant.rates(&tick.propagated, direction, Number::parameter);
            let (mut f, mut rates) = (Vector::zeros(), Square::zeros());
            for (row, [rate]) in self.plant.rate.iter().enumerate().take(self.plant.imposed) {
                f[row] = rate.v;
                for column in 0..STATES {
                    rates[(row, column)] = rate.d[column];
                }
            }
            self.exponential.set(&rates, self.part_s);
            let Exponential { whole, input, mean, .. } = &self.exponential;
            tick.mean += (tick.propagated + mean * f) / self.parts as f64;
            tick.propagated += input * f;
            tick.transition = whole * tick.transition;
            tick.input = whole * tick.input + input;
        }
        self.plant.advance();
    }
}

/// The plant as it was linearised along a track.
struct Along<'a> {
    ticks: std::slice::Iter<'a, Tick>,
    now: Option<&'a Tick>,
}

impl Linearised for Along<'_> {
    fn begin(&mut self) {}

    fn shown(&mut self, tick: &mut Tick) {
        self.now = self.ticks.next();
        let Some(now) = self.now else { return };
        let apart = tick.predicted - now.predicted;
        tick.shown =
            std::array::from_fn(|sensor| now.shown[sensor] + now.sense[sensor].dot(&apart));
        tick.sense = now.sense;
    }

    fn propagate(&mut self, tick: &mut Tick) {
        let Some(now) = self.now else { return };
        tick.propagated = now.propagated + now.transition * (tick.filtered - now.filtered);
        tick.mean =
            now.mean + 0.5 * (tick.filtered - now.filtered + tick.propagated - now.propagated);
        tick.transition = now.transition;
        tick.input = now.input;
    }
}

/// Filters a recording. Nothing where the model overflows.
pub(crate) fn track(
    drive: &Drive,
    (measured, direction): (&Measured, &Direction),
    noise: &Noise,
) -> Option<Track> {
    let constant = |_: &str, value: f64| Number { v: value, d: [0.0; STATES] };
    let plant = Plant::new(drive, measured, own_states(drive), constant);
    let parts = parts(drive, measured.period_s);
    let part_s = measured.period_s / parts as f64;
    let exponential = Exponential::new();
    let plant = Itself { plant, direction, exponential, parts, part_s };
    filter(drive, (measured, direction), noise, plant)
}

/// Parts of a sample over each of which the drive is nearly linear.
fn parts(drive: &Drive, period_s: f64) -> usize {
    let knocks = |kind: &str| Entry::find(kind).is_some_and(|entry| entry.info.knocks);
    if drive.effects.iter().any(|it| knocks(&it.kind)) {
        return KNOCKING;
    }
    let armature = match (drive.motor.r, drive.motor.l) {
        (Some(r), Some(l)) if drive.motor.input == Input::Voltage => period_s * r / l,
        _ => 0.0,
    };
    (SETTLING * armature).ceil().clamp(1.0, KNOCKING as f64) as usize
}

impl Track {
    /// The same recording with other noise, the plant as it was linearised along this track.
    pub(crate) fn with(
        &self,
        drive: &Drive,
        recording: (&Measured, &Direction),
        noise: &Noise,
    ) -> Option<Self> {
        filter(drive, recording, noise, Along { ticks: self.ticks.iter(), now: None })
    }
}

fn filter(
    drive: &Drive,
    (measured, direction): (&Measured, &Direction),
    noise: &Noise,
    mut plant: impl Linearised,
) -> Option<Track> {
    let variances = noise.sensors.map(|sd| sd * sd);
    let left = noise.left(measured.period_s);
    let added = noise.added(measured.period_s);
    let (mut ticks, mut log_likelihood) = (Vec::with_capacity(measured.len()), 0.0);
    let electrical = drive.motor.input != Input::Force;
    for piece in &measured.pieces {
        plant.begin();
        let (mut mean, mut covariance) = beginning(drive, measured, piece.start, noise);
        for sample in piece.clone() {
            if let Some(angle) = &measured.angle {
                mean[POSITION] = angle[sample];
                covariance.row_mut(POSITION).fill(0.0);
                covariance.column_mut(POSITION).fill(0.0);
            }
            let mut tick = Tick {
                sample,
                begins: sample == piece.start,
                predicted: mean,
                filtered: mean,
                propagated: mean,
                mean,
                transition: Square::zeros(),
                input: Square::zeros(),
                shown: [0.0; SENSORS],
                sense: [Vector::zeros(); SENSORS],
                gain: [Vector::zeros(); SENSORS],
                inverse_sd: [0.0; SENSORS],
                innovation: [0.0; SENSORS],
            };
            plant.shown(&mut tick);
            for channel in &measured.outputs {
                let (sensor, value) = (channel.output as usize, channel.values[sample]);
                if sensor >= SENSORS || !value.is_finite() {
                    continue;
                }
                let sense = tick.sense[sensor];
                let seen = covariance * sense;
                let variance = sense.dot(&seen) + variances[sensor];
                let gain = seen / variance;
                let expected = tick.shown[sensor] + sense.dot(&(mean - tick.predicted));
                let innovation = value - expected;
                mean += gain * innovation;
                covariance -= gain * seen.transpose();
                tick.gain[sensor] = gain;
                tick.inverse_sd[sensor] = 1.0 / variance.sqrt();
                tick.innovation[sensor] = innovation * tick.inverse_sd[sensor];
                log_likelihood -= 0.5 * (tick.innovation[sensor].powi(2) + variance.ln());
            }
            tick.filtered = mean;
            plant.propagate(&mut tick);
            tick.propagated[LOAD] = left[0] * mean[LOAD];
            tick.propagated[VOLTAGE] = left[1] * mean[VOLTAGE];
            tick.transition[(LOAD, LOAD)] = left[0];
            tick.transition[(VOLTAGE, VOLTAGE)] = if electrical { left[1] } else { 0.0 };
            mean = tick.propagated;
            covariance = tick.transition * covariance * tick.transition.transpose();
            covariance[(LOAD, LOAD)] += added[0];
            // Any acceleration within the sample, early or late in it.
            let (loose, period) = (direction.loose(sample).powi(2), measured.period_s);
            covariance[(SPEED, SPEED)] += loose;
            covariance[(SPEED, POSITION)] += 0.5 * period * loose;
            covariance[(POSITION, SPEED)] += 0.5 * period * loose;
            if measured.angle.is_none() {
                covariance[(POSITION, POSITION)] += period * period / 3.0 * loose;
            }
            covariance[(VOLTAGE, VOLTAGE)] += if electrical { added[1] } else { 0.0 };
            if !mean.iter().all(|value| value.is_finite()) {
                return None;
            }
            ticks.push(tick);
        }
    }
    log_likelihood.is_finite().then_some(Track { ticks, log_likelihood })
}
