//! The plant over whole samples, exactly and through its events, from states that are imposed on it.

use drivescope_plant::drive::Drive;
use drivescope_plant::integrate::{Integrator, State};
use drivescope_plant::model::{Applied, OWN, SPEED};
use drivescope_plant::sampled::DelayLine;

use super::state::{LOAD, OWN_STATES, SENSORS, VOLTAGE, Vector};
use super::track::Tick;
use crate::measured::Measured;

pub(super) struct Stepper<'a> {
    measured: &'a Measured,
    integrator: Integrator<f64>,
    state: State<f64, 1>,
    delay: Option<DelayLine<f64, 1>>,
    /// Own states that the filter knows.
    known: usize,
}

impl<'a> Stepper<'a> {
    /// `known` own states are imposed, those after them run on their own.
    pub(super) fn new(drive: &Drive, measured: &'a Measured, known: usize, longest_s: f64) -> Self {
        let model = drive.model();
        let state = State::at_rest(&model);
        let delay = model.delays().map(DelayLine::new);
        Self { measured, integrator: Integrator::paced(model, longest_s), state, delay, known }
    }

    /// A piece begins: own states at rest.
    fn begin(&mut self) {
        let model = self.integrator.model();
        self.state = State::at_rest(model);
        self.delay = model.delays().map(DelayLine::new);
    }

    /// Imposes a state of the filter; what acts then, with d_V and d_T in it.
    fn impose(&mut self, sample: usize, state: &Vector) -> Applied<f64, 1> {
        let own = self.known.min(OWN_STATES);
        for (place, [value]) in self.state.x.iter_mut().enumerate().take(OWN + own) {
            *value = state[place];
        }
        let omega = self.state.x[SPEED][0];
        self.state.set_speed(self.integrator.model(), 0, omega);
        let load = self.measured.load.as_ref().map_or(0.0, |load| load[sample]);
        let model = self.integrator.model();
        let (j, l) = (model.motors.j[0], model.motors.l[0]);
        let voltage = if model.force { 0.0 } else { l * state[VOLTAGE] };
        Applied {
            u: [self.measured.u[sample] + voltage],
            load: [load - j * state[LOAD]],
            time: self.measured.time(sample),
        }
    }

    /// What the sensors show of that state.
    fn shown(&mut self, sample: usize, state: &Vector) -> [f64; SENSORS] {
        let applied = self.impose(sample, state);
        let shown = self.integrator.model().outputs(&self.state.x, &applied);
        [shown.i[0], shown.omega[0], shown.theta[0]]
    }

    /// The plant's states one sample later.
    fn step(&mut self, sample: usize, state: &Vector) -> &[[f64; 1]] {
        let applied = self.impose(sample, state);
        let period = self.measured.period_s;
        match &mut self.delay {
            None => self.integrator.advance(&mut self.state, &applied, period),
            Some(line) => {
                for (held, length) in line.pieces(&applied, period) {
                    self.integrator.advance(&mut self.state, held, *length);
                }
            }
        }
        &self.state.x
    }

    /// What the sensors show at a tick, and the states one sample later.
    pub(super) fn at(&mut self, tick: &Tick) -> Stepped {
        if tick.begins {
            self.begin();
        }
        let shown = self.shown(tick.sample, &tick.predicted);
        let mut state = Vector::zeros();
        let next = self.step(tick.sample, &tick.filtered);
        for (row, [value]) in next.iter().enumerate().take(LOAD) {
            state[row] = *value;
        }
        Stepped { shown, state }
    }
}

/// What the sensors show at a tick, and the states one sample later; 0 for those it does not have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stepped {
    pub(super) shown: [f64; SENSORS],
    pub(super) state: Vector,
}

/// A drive stepped from every state of a track; `known` own states stand in the track's drive.
pub(super) fn stepped(
    drive: &Drive,
    measured: &Measured,
    known: usize,
    longest_s: f64,
    ticks: &[Tick],
) -> Vec<Stepped> {
    let mut stepper = Stepper::new(drive, measured, known, longest_s);
    ticks.iter().map(|tick| stepper.at(tick)).collect()
}
