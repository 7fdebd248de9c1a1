//! The model stepped along a recording, sample by sample, over plain numbers or duals.
//!
//! At sample k the sensors are read, the observer corrects the state by what they should have
//! shown, and the state is advanced to the next sample under u_k (and the load), held.

use drivescope_numerics::{Dual, Real};
use drivescope_plant::integrate::{Integrator, State};
use drivescope_plant::model::{Applied, CURRENT, POSITION, SPEED};
use drivescope_plant::sampled::DelayLine;

use crate::case::Case;
use crate::measured::{Measured, OUTPUTS, Output};
use crate::observer::Gains;
use crate::start::{OWN_STATES, STARTS, Start};

/// A model on its way along a recording.
pub(crate) struct Runner<'a, R> {
    measured: &'a Measured,
    gains: Option<Gains>,
    integrator: Integrator<R>,
    state: State<R, 1>,
    /// What holds u back, where the drive has a delay.
    delay: Option<DelayLine<R, 1>>,
    /// The beginning of each piece, in the order of [`Start::values`].
    starts: Vec<[R; STARTS]>,
    zeros: [R; OUTPUTS],
    next_piece: usize,
    period: R,
}

impl Runner<'_, f64> {
    /// A run with the drive's own values.
    pub(crate) fn of_values<'a>(case: &Case<'a>) -> Runner<'a, f64> {
        Runner::new(case, case.starts.iter().map(Start::values).collect(), |_, value| value)
    }
}

impl<R: Real> Runner<'_, R> {
    /// A run from those starts; `scalar` makes the scalar of a parameter from its name and value.
    pub(crate) fn new<'a>(
        case: &Case<'a>,
        starts: Vec<[R; STARTS]>,
        scalar: impl Fn(&str, f64) -> R,
    ) -> Runner<'a, R> {
        let values = case.drive.parameters();
        let model = case.drive.model_of(|name| {
            let known = values.iter().find(|parameter| parameter.name == name);
            scalar(name, known.expect("a drive has what its model asks for").value)
        });
        let state = State::at_rest(&model);
        let delay = model.delays().map(DelayLine::new);
        Runner {
            measured: case.measured,
            gains: case.setting.observer.gains(case.measured),
            integrator: Integrator::paced(model, case.setting.longest_s),
            state,
            delay,
            starts,
            zeros: [R::zero(); OUTPUTS],
            next_piece: 0,
            period: R::constant(case.measured.period_s),
        }
    }

    /// What the sensors show at sample `k`, in the order of [`crate::Output`], before the
    /// correction; then on to the next sample. Samples of the pieces are visited in order.
    /// `added` is a torque against nothing (N m, positive forward) and a voltage in the armature
    /// circuit (V), added to the balances over this sample.
    #[inline]
    pub(crate) fn sample(&mut self, k: usize, added: [R; 2]) -> [R; OUTPUTS] {
        let is_here = |piece: &std::ops::Range<usize>| piece.start == k;
        if self.measured.pieces.get(self.next_piece).is_some_and(is_here) {
            self.begin();
        }
        let load = self.measured.load.as_ref().map_or(0.0, |load| load[k]);
        let applied = Applied {
            u: [R::constant(self.measured.u[k]) + added[1]],
            load: [R::constant(load) - added[0]],
            time: self.measured.time(k),
        };
        if let Some(angle) = &self.measured.angle {
            self.state.x[POSITION] = [R::constant(angle[k])];
        }
        let of_motor = self.integrator.model().outputs(&self.state.x, &applied);
        let mut shown = self.zeros;
        shown[Output::Current as usize] = of_motor.i[0];
        shown[Output::Speed as usize] = of_motor.omega[0];
        shown[Output::Position as usize] = of_motor.theta[0];
        self.show_beside(k, &mut shown);
        self.correct(k, &shown);
        self.advance(&applied);
        shown
    }

    /// Adds what the sensors beside those of the motor show to their zeros.
    #[inline]
    fn show_beside(&self, k: usize, shown: &mut [R; OUTPUTS]) {
        for channel in &self.measured.outputs {
            let Some(sensor) = channel.output.beside() else { continue };
            let model = self.integrator.model();
            let of_motor = self.measured.of_motor(sensor, k);
            let state = if !model.has(sensor) && of_motor.is_finite() {
                Some(R::constant(of_motor))
            } else {
                model.beside(sensor, &self.state.x, 0)
            };
            shown[channel.output as usize] += state.unwrap_or(R::zero());
        }
    }

    #[inline]
    fn advance(&mut self, applied: &Applied<R, 1>) {
        match &mut self.delay {
            None => self.integrator.advance(&mut self.state, applied, self.period),
            Some(line) => {
                for (held, length) in line.pieces(applied, self.period) {
                    self.integrator.advance(&mut self.state, held, *length);
                }
            }
        }
    }

    /// Leaves out the pieces before that one.
    pub(crate) fn skip_to(&mut self, piece: usize) {
        self.next_piece = piece;
    }

    fn begin(&mut self) {
        let model = self.integrator.model();
        self.state = State::at_rest(model);
        self.delay = model.delays().map(DelayLine::new);
        let start = self.starts[self.next_piece];
        let [current, speed, position, ..] = start;
        self.zeros = std::array::from_fn(|output| start[output]);
        self.state.x[CURRENT] = [current];
        self.state.x[POSITION] = [position];
        for (sensor, number) in OWN_STATES {
            if let Some(state) = model.told_by(sensor) {
                self.state.x[state] = [start[number]];
            }
        }
        self.state.set_speed(model, 0, speed);
        self.next_piece += 1;
    }

    #[inline]
    fn correct(&mut self, k: usize, shown: &[R; OUTPUTS]) {
        let Some(gains) = self.gains else { return };
        let measured = self.measured.output(gains.output).map_or(f64::NAN, |y| y.values[k]);
        if !measured.is_finite() {
            return;
        }
        let error = R::constant(measured) - shown[gains.output as usize];
        let speed = self.state.x[SPEED][0] + error.scaled(gains.speed);
        self.state.set_speed(self.integrator.model(), 0, speed);
        self.state.x[POSITION][0] += error.scaled(gains.position);
    }

    /// The state in which the next sample finds the drive.
    pub(crate) fn state(&self) -> &State<R, 1> {
        &self.state
    }

    /// Whether u acts later than it is applied.
    pub(crate) fn holds_back(&self) -> bool {
        self.delay.is_some()
    }

    /// Whether nothing has overflowed.
    pub(crate) fn is_finite(&self) -> bool {
        self.state.is_finite()
    }
}

impl<const P: usize> Runner<'_, Dual<P>> {
    /// Makes the derivatives of the state those by itself: what the next sample does to it.
    pub(crate) fn seed(&mut self) {
        for (number, [value]) in self.state.x.iter_mut().enumerate() {
            *value = Dual::parameter(value.v, number);
        }
    }
}
