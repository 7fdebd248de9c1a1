//! The drive with a random load torque and a random voltage as a state space, filtered along a
//! recording (extended Kalman filter).
//!
//! The state is what the drive's model has (current, speed, position, own states) and two
//! disturbances, d_T in the balance of torques and d_V in that of voltages, each an
//! Ornstein-Uhlenbeck process. A sample is advanced by the plant itself, exactly and through its
//! stick-slip events, from the filtered state; its derivative by that state, from duals in the
//! same step, carries the covariance (Anderson and Moore, Optimal Filtering, 1979, ch. 8).
//! A random load is thus a part of the model and no excuse: whatever it explains has its price.

use drivescope_numerics::Dual;
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::integrate::{Integrator, State};
use drivescope_plant::model::{Applied, CURRENT, OWN, POSITION, SPEED};
use drivescope_plant::sampled::DelayLine;
use nalgebra::{SMatrix, SVector};

use crate::measured::{Measured, Output};

/// States of the filter at most: current, speed, position, three own states, d_T, d_V.
pub(crate) const STATES: usize = 8;
/// Own states of effects that the filter corrects.
const OWN_STATES: usize = 3;
/// Place of d_T and of d_V in the state.
pub(crate) const LOAD: usize = OWN + OWN_STATES;
pub(crate) const VOLTAGE: usize = LOAD + 1;
/// Sensors: of current, speed and position; those beside the motor are not filtered.
pub(crate) const SENSORS: usize = 3;

pub(crate) type Vector = SVector<f64, STATES>;
pub(crate) type Square = SMatrix<f64, STATES, STATES>;
type Number = Dual<STATES>;

/// What is random in a recording: two disturbances and the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation of the load torque, N m (N), and its correlation time, s.
    pub(crate) load_sd: f64,
    pub(crate) load_s: f64,
    /// Standard deviation of the voltage, V, and its correlation time, s.
    pub(crate) voltage_sd: f64,
    pub(crate) voltage_s: f64,
    /// Standard deviation of each sensor's noise, in its unit.
    pub(crate) sensors: [f64; SENSORS],
}

impl Noise {
    /// Share of each disturbance that is left after a sample.
    fn left(&self, period_s: f64) -> [f64; 2] {
        [self.load_s, self.voltage_s].map(|time| (-period_s / time).exp())
    }

    /// Variances that a sample adds to the disturbances.
    fn added(&self, period_s: f64) -> [f64; 2] {
        let [load, voltage] = self.left(period_s);
        [
            self.load_sd * self.load_sd * (1.0 - load * load),
            self.voltage_sd * self.voltage_sd * (1.0 - voltage * voltage),
        ]
    }
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
    /// Its derivative by the filtered state.
    pub(crate) transition: Square,
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

/// One sample of the plant from states that are imposed.
pub(crate) struct Stepper<'a, const P: usize> {
    measured: &'a Measured,
    integrator: Integrator<Dual<P>>,
    state: State<Dual<P>, 1>,
    delay: Option<DelayLine<Dual<P>, 1>>,
    /// Own states that the filter knows.
    known: usize,
    period: Dual<P>,
}

/// What acts over a sample: voltage and load, with d_V and d_T in them.
fn applied<const P: usize>(
    measured: &Measured,
    sample: usize,
    voltage: Dual<P>,
    torque: Dual<P>,
) -> Applied<Dual<P>, 1> {
    let load = measured.load.as_ref().map_or(0.0, |load| load[sample]);
    Applied {
        u: [Dual { v: measured.u[sample], d: [0.0; P] } + voltage],
        load: [Dual { v: load, d: [0.0; P] } - torque],
        time: measured.time(sample),
    }
}

impl<'a, const P: usize> Stepper<'a, P> {
    /// Of a drive, whose parameters are made by `scalar` from name and value; `known` own states
    /// are imposed, those after them run on their own.
    pub(crate) fn new(
        drive: &Drive,
        measured: &'a Measured,
        known: usize,
        longest_s: f64,
        scalar: impl Fn(&str, f64) -> Dual<P>,
    ) -> Self {
        let values = drive.parameters();
        let model = drive.model_of(|name| {
            let known = values.iter().find(|parameter| parameter.name == name);
            scalar(name, known.expect("a drive has what its model asks for").value)
        });
        let state = State::at_rest(&model);
        let delay = model.delays().map(DelayLine::new);
        let period = Dual { v: measured.period_s, d: [0.0; P] };
        Self {
            measured,
            integrator: Integrator::paced(model, longest_s),
            state,
            delay,
            known,
            period,
        }
    }

    /// A piece begins: own states at rest.
    pub(crate) fn begin(&mut self) {
        let model = self.integrator.model();
        self.state = State::at_rest(model);
        self.delay = model.delays().map(DelayLine::new);
    }

    /// Imposes a state of the filter; `seed` makes a number of its value and place.
    fn impose(&mut self, state: &Vector, seed: impl Fn(f64, usize) -> Dual<P>) {
        let own = self.known.min(OWN_STATES);
        for (place, [value]) in self.state.x.iter_mut().enumerate().take(OWN + own) {
            *value = seed(state[place], place);
        }
        let omega = self.state.x[SPEED][0];
        self.state.set_speed(self.integrator.model(), 0, omega);
    }

    /// What the sensors show of that state.
    pub(crate) fn shown(
        &mut self,
        sample: usize,
        state: &Vector,
        seed: impl Fn(f64, usize) -> Dual<P>,
    ) -> [Dual<P>; SENSORS] {
        self.impose(state, &seed);
        let applied =
            applied(self.measured, sample, seed(state[VOLTAGE], VOLTAGE), seed(state[LOAD], LOAD));
        let shown = self.integrator.model().outputs(&self.state.x, &applied);
        [shown.i[0], shown.omega[0], shown.theta[0]]
    }

    /// The plant's states one sample later.
    pub(crate) fn step(
        &mut self,
        sample: usize,
        state: &Vector,
        seed: impl Fn(f64, usize) -> Dual<P>,
    ) -> &[[Dual<P>; 1]] {
        self.impose(state, &seed);
        let applied =
            applied(self.measured, sample, seed(state[VOLTAGE], VOLTAGE), seed(state[LOAD], LOAD));
        match &mut self.delay {
            None => self.integrator.advance(&mut self.state, &applied, self.period),
            Some(line) => {
                for (held, length) in line.pieces(&applied, self.period) {
                    self.integrator.advance(&mut self.state, held, *length);
                }
            }
        }
        &self.state.x
    }
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

/// Filters a recording. Nothing where the model overflows.
pub(crate) fn track(
    drive: &Drive,
    measured: &Measured,
    noise: &Noise,
    longest_s: f64,
) -> Option<Track> {
    let constant = |_: &str, value: f64| Number { v: value, d: [0.0; STATES] };
    let known = own_states(drive);
    let mut plant = Stepper::new(drive, measured, known, longest_s, constant);
    let variances = noise.sensors.map(|sd| sd * sd);
    let left = noise.left(measured.period_s);
    let added = noise.added(measured.period_s);
    let (mut ticks, mut log_likelihood) = (Vec::with_capacity(measured.len()), 0.0);
    let force = drive.motor.input == Input::Force;
    for piece in &measured.pieces {
        plant.begin();
        let (mut mean, mut covariance) = beginning(drive, measured, piece.start, noise);
        for sample in piece.clone() {
            if let Some(angle) = &measured.angle {
                mean[POSITION] = angle[sample];
                covariance.row_mut(POSITION).fill(0.0);
                covariance.column_mut(POSITION).fill(0.0);
            }
            let predicted = mean;
            let shown = plant.shown(sample, &predicted, Number::parameter);
            let mut tick = Tick {
                sample,
                begins: sample == piece.start,
                predicted,
                filtered: mean,
                propagated: mean,
                transition: Square::zeros(),
                shown: shown.map(|it| it.v),
                sense: shown.map(|it| Vector::from(it.d)),
                gain: [Vector::zeros(); SENSORS],
                inverse_sd: [0.0; SENSORS],
                innovation: [0.0; SENSORS],
            };
            for channel in &measured.outputs {
                let (sensor, value) = (channel.output as usize, channel.values[sample]);
                if sensor >= SENSORS || !value.is_finite() {
                    continue;
                }
                let sense = tick.sense[sensor];
                let seen = covariance * sense;
                let variance = sense.dot(&seen) + variances[sensor];
                let gain = seen / variance;
                let expected = tick.shown[sensor] + sense.dot(&(mean - predicted));
                let innovation = value - expected;
                mean += gain * innovation;
                covariance -= gain * seen.transpose();
                tick.gain[sensor] = gain;
                tick.inverse_sd[sensor] = 1.0 / variance.sqrt();
                tick.innovation[sensor] = innovation * tick.inverse_sd[sensor];
                log_likelihood -= 0.5 * (tick.innovation[sensor].powi(2) + variance.ln());
            }
            tick.filtered = mean;
            let next = plant.step(sample, &mean, Number::parameter);
            for (row, [value]) in next.iter().enumerate().take(OWN + known.min(OWN_STATES)) {
                mean[row] = value.v;
                for column in 0..STATES {
                    tick.transition[(row, column)] = value.d[column];
                }
            }
            mean[LOAD] *= left[0];
            mean[VOLTAGE] *= left[1];
            tick.transition[(LOAD, LOAD)] = left[0];
            tick.transition[(VOLTAGE, VOLTAGE)] = if force { 0.0 } else { left[1] };
            tick.propagated = mean;
            covariance = tick.transition * covariance * tick.transition.transpose();
            covariance[(LOAD, LOAD)] += added[0];
            covariance[(VOLTAGE, VOLTAGE)] += if force { 0.0 } else { added[1] };
            if !mean.iter().all(|value| value.is_finite()) {
                return None;
            }
            ticks.push(tick);
        }
    }
    log_likelihood.is_finite().then_some(Track { ticks, log_likelihood })
}
