//! The plant's right-hand side along a recording, from states that are imposed on it.

use drivescope_numerics::Dual;
use drivescope_plant::drive::Drive;
use drivescope_plant::model::{Applied, Model, OWN, SPEED, acting, field};
use drivescope_plant::sampled::DelayLine;

use super::rows::{LANES, NO_ROWS, Rows};
use super::state::{LOAD, OWN_STATES, SENSORS, VOLTAGE, Vector};
use crate::measured::Measured;

/// A drive whose numbers carry `P` directions.
pub(super) struct Plant<'a, const P: usize> {
    measured: &'a Measured,
    model: Model<Dual<P>, 1>,
    delay: Option<DelayLine<Dual<P>, 1>>,
    /// States that are imposed: those of the motor and the own ones that the filter knows.
    pub(super) imposed: usize,
    /// What acts over this sample, without the disturbances.
    held: Applied<Dual<P>, 1>,
    x: Vec<[Dual<P>; 1]>,
    /// Rates of the states, and their own decay rates where they are stiff, 1/s.
    pub(super) rate: Vec<[Dual<P>; 1]>,
    decay: Vec<[Dual<P>; 1]>,
}

/// Sign of the motion in which a shaft goes at a speed, 0 where dry friction holds it.
pub(super) fn sign<const P: usize>(model: &Model<Dual<P>, 1>, direction: f64, speed: f64) -> f64 {
    // A law that replaces dry friction knows no rest.
    let resting = direction == 0.0 && !model.dry();
    if resting { 1.0_f64.copysign(speed) } else { direction }
}

fn constant<const P: usize>(v: f64) -> Dual<P> {
    Dual { v, d: [0.0; P] }
}

impl<'a, const P: usize> Plant<'a, P> {
    /// Of a drive, whose parameters are made by `scalar` from name and value; `known` own states
    /// are imposed, those after them run on their own.
    pub(super) fn new(
        drive: &Drive,
        measured: &'a Measured,
        known: usize,
        scalar: impl Fn(&str, f64) -> Dual<P>,
    ) -> Self {
        let values = drive.parameters();
        let model = drive.model_of(|name| {
            let known = values.iter().find(|parameter| parameter.name == name);
            scalar(name, known.expect("a drive has what its model asks for").value)
        });
        let zero = vec![[constant(0.0)]; model.states()];
        let held = Applied { u: [constant(0.0)], load: [constant(0.0)], time: 0.0 };
        let delay = model.delays().map(DelayLine::new);
        let imposed = OWN + known.min(OWN_STATES);
        let (x, rate, decay) = (zero.clone(), zero.clone(), zero);
        Self { measured, model, delay, imposed, held, x, rate, decay }
    }

    /// A piece begins: own states at rest.
    pub(super) fn begin(&mut self) {
        self.x.fill([constant(0.0)]);
        self.delay = self.model.delays().map(DelayLine::new);
    }

    /// A sample begins; samples come one after the other. Of a delayed input the mean acts.
    pub(super) fn enter(&mut self, sample: usize) {
        let load = self.measured.load.as_ref().map_or(0.0, |load| load[sample]);
        let (u, time) = (constant(self.measured.u[sample]), self.measured.time(sample));
        self.held = Applied { u: [u], load: [constant(load)], time };
        if let Some(line) = &mut self.delay {
            let period = self.measured.period_s;
            let pieces = line.pieces(&self.held, constant(period));
            let sum =
                pieces.iter().fold(constant(0.0), |sum, (held, length)| sum + held.u[0] * *length);
            self.held.u = [sum * constant(1.0 / period)];
        }
    }

    fn impose(
        &mut self,
        state: &Vector,
        seed: impl Fn(f64, usize) -> Dual<P>,
    ) -> Applied<Dual<P>, 1> {
        for (place, [value]) in self.x.iter_mut().enumerate().take(self.imposed) {
            *value = seed(state[place], place);
        }
        // The disturbances are accelerations and slopes of the current: what moves J or L leaves
        // them, and with them the gains, as they are.
        let (j, l) = (self.model.motors.j[0], self.model.motors.l[0]);
        let u = if self.model.force {
            self.held.u[0]
        } else {
            self.held.u[0] + l * seed(state[VOLTAGE], VOLTAGE)
        };
        Applied { u: [u], load: [self.held.load[0] - j * seed(state[LOAD], LOAD)], ..self.held }
    }

    /// What the sensors show of a state in this sample; `seed` makes a number of value and place.
    pub(super) fn shown(
        &mut self,
        state: &Vector,
        seed: impl Fn(f64, usize) -> Dual<P>,
    ) -> [Dual<P>; SENSORS] {
        let applied = self.impose(state, seed);
        let shown = self.model.outputs(&self.x, &applied);
        [shown.i[0], shown.omega[0], shown.theta[0]]
    }

    /// Whether the sensors show the states themselves, whatever the parameters.
    pub(super) fn shows_state(&self) -> bool {
        self.model.shows_state()
    }

    /// Sets the rates at a state in this sample, the shaft moving in that direction.
    pub(super) fn rates(
        &mut self,
        state: &Vector,
        direction: f64,
        seed: impl Fn(f64, usize) -> Dual<P>,
    ) {
        let applied = self.impose(state, seed);
        self.decay.fill([constant(0.0)]);
        let sign = sign(&self.model, direction, state[SPEED]);
        let (rate, decay) = (&mut self.rate, &mut self.decay);
        field(&self.model, &self.x, &applied, &[sign], rate, Some(decay.as_mut_slice()));
    }

    /// The model, and what acts over this sample.
    pub(super) fn held(&self) -> (&Model<Dual<P>, 1>, &Applied<Dual<P>, 1>) {
        (&self.model, &self.held)
    }

    /// Advances the own states that are not imposed, by the rates that were set.
    pub(super) fn advance(&mut self) {
        let period = self.measured.period_s;
        for place in self.imposed..self.x.len() {
            let acting = acting(self.decay[place][0].v, period);
            self.x[place][0] = self.x[place][0] + self.rate[place][0] * constant(acting);
        }
    }
}

impl Plant<'_, LANES> {
    /// Derivatives of the rates that were set, a row an imposed state.
    pub(super) fn rate_rows(&self) -> Rows {
        let mut rows = NO_ROWS;
        for (row, [rate]) in rows.iter_mut().zip(&self.rate).take(self.imposed) {
            *row = rate.d;
        }
        rows
    }
}
