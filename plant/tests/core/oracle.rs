//! The drive once more, written independently over `ode_solvers`: its own right-hand side, its
//! own search for events.
//!
//! [`Solver::Fine`] is the reference, [`Solver::Plain`] the competitor of the benchmark.
//! Output is sparse: the dense output of `ode_solvers` is wrong at the end point when its
//! increment equals the interval.

use nalgebra::Vector3;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, System};

/// Parameters of the drive that is checked; SI units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth {
    pub(crate) r: f64,
    pub(crate) l: f64,
    pub(crate) k_e: f64,
    pub(crate) k_m: f64,
    pub(crate) j: f64,
    pub(crate) b_m: f64,
    pub(crate) t_c: f64,
    pub(crate) t_b: f64,
    pub(crate) omega_s: f64,
    pub(crate) drag: f64,
    pub(crate) cogging: [f64; 3],
    pub(crate) saturation: f64,
}

/// The AMIRA DR300, as the shipped drive file states it.
pub(crate) const DR300: Truth = Truth {
    r: 3.13,
    l: 5e-3,
    k_e: 0.0599,
    k_m: 0.06,
    j: 8.2e-5,
    b_m: 6e-5,
    t_c: 0.016,
    t_b: 0.008,
    omega_s: 5.0,
    drag: 0.0,
    cogging: [0.0; 3],
    saturation: 0.0,
};

/// No single step is longer, s: a speed that dips below zero within one is off by less than
/// (acceleration 1e3 rad/s^2) x step^2 / 8 = 3e-7 rad/s.
const LONGEST: f64 = 5e-5;
/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-10;
/// Below this an event function is a rounding error of a state that starts at the event.
const CLEAR: f64 = 1e-13;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    Forward,
    Stuck,
    Backward,
}

/// Current, speed, position.
type Y = Vector3<f64>;

/// The smooth equations of one motion with the inputs held.
#[derive(Clone, Copy)]
struct Phase {
    truth: Truth,
    u: f64,
    load: f64,
    motion: Motion,
}

impl Phase {
    fn constant(&self, i: f64) -> f64 {
        1.0 / (1.0 + self.truth.saturation * i.powi(2))
    }

    fn pull(&self, y: &Y) -> f64 {
        let p = &self.truth;
        let [n, a, b] = p.cogging;
        let cogging = a * (n * y[2]).cos() + b * (n * y[2]).sin();
        let friction = p.b_m * y[1] + p.drag * y[1] * y[1].abs();
        p.k_m * self.constant(y[0]) * y[0] - friction - cogging - self.load
    }

    fn dry(&self, omega: f64) -> f64 {
        let p = &self.truth;
        p.t_c + p.t_b * (-(omega / p.omega_s).powi(2)).exp()
    }

    /// Positive while the motion lasts.
    fn lasts(&self, y: &Y) -> f64 {
        match self.motion {
            Motion::Forward => y[1],
            Motion::Backward => -y[1],
            Motion::Stuck => self.dry(0.0) - self.pull(y).abs(),
        }
    }

    /// The motion after an instant at which the shaft rests.
    fn motion_off_rest(&self, y: &Y) -> Motion {
        let pull = self.pull(y);
        match pull.abs() > self.dry(0.0) {
            false => Motion::Stuck,
            true if pull > 0.0 => Motion::Forward,
            true => Motion::Backward,
        }
    }
}

impl System<f64, Y> for Phase {
    fn system(&self, _: f64, y: &Y, dy: &mut Y) {
        let p = &self.truth;
        let emf = p.k_e * self.constant(y[0]) * y[1];
        let dry = match self.motion {
            Motion::Forward => self.dry(y[1]),
            Motion::Backward => -self.dry(y[1]),
            Motion::Stuck => self.pull(y),
        };
        *dy = Y::new((self.u - emf - p.r * y[0]) / p.l, (self.pull(y) - dry) / p.j, y[1]);
    }
}

/// Which program integrates a phase.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Solver {
    /// Dop853 at 1e-10 in steps of at most [`LONGEST`]: the reference.
    Fine,
    /// Dopri5 at 1e-6 in steps of its own choice: what a user of `ode_solvers` would run.
    Plain,
}

/// Every step of the integration over `span`.
fn path(solver: Solver, phase: Phase, y: Y, span: f64) -> (Vec<f64>, Vec<Y>) {
    match solver {
        Solver::Fine => {
            let mut fine = Dop853::from_param(
                phase,
                0.0,
                span,
                span,
                y,
                TOLERANCE,
                TOLERANCE,
                0.9,
                0.0,
                0.333,
                6.0,
                LONGEST,
                0.0,
                1_000_000,
                1_000_000,
                OutputType::Sparse,
            );
            fine.integrate().expect("a smooth phase integrates");
            let (t, y) = fine.results().get();
            (t.clone(), y.clone())
        }
        Solver::Plain => {
            let mut plain = Dopri5::new(phase, 0.0, span, span, y, 1e-6, 1e-6);
            plain.set_output(OutputType::Sparse);
            plain.integrate().expect("a smooth phase integrates");
            let (t, y) = plain.results().get();
            (t.clone(), y.clone())
        }
    }
}

fn end(solver: Solver, phase: Phase, y: Y, span: f64) -> Y {
    path(solver, phase, y, span).1.last().copied().unwrap_or(y)
}

/// [`run_by`] the fine solver.
pub(crate) fn reference(truth: Truth, h: f64) -> impl FnMut(f64, f64) -> [f64; 3] {
    run_by(Solver::Fine, truth, h)
}

/// The drive from rest as a function from inputs, held over `h`, to states.
pub(crate) fn run_by(solver: Solver, truth: Truth, h: f64) -> impl FnMut(f64, f64) -> [f64; 3] {
    let mut y = Y::zeros();
    let mut motion = Motion::Stuck;
    move |u, load| {
        let mut phase = Phase { truth, u, load, motion };
        let mut left = h;
        if phase.motion == Motion::Stuck {
            phase.motion = phase.motion_off_rest(&y);
        }
        while left > 0.0 {
            let (times, states) = path(solver, phase, y, left);
            let Some(after) = states.iter().position(|y| phase.lasts(y) < -CLEAR) else {
                y = states[states.len() - 1];
                break;
            };
            let (from, start) = (states[after - 1], times[after - 1]);
            // Bisection of the last step, each try integrated anew.
            let (mut low, mut high) = (0.0, times[after] - start);
            while high - low > 1e-16 {
                let middle = 0.5 * (low + high);
                if phase.lasts(&end(solver, phase, from, middle)) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            y = end(solver, phase, from, high);
            left -= start + high;
            let slipped = phase.motion != Motion::Stuck;
            y[1] = 0.0;
            phase.motion = if slipped {
                phase.motion_off_rest(&y)
            } else if phase.pull(&y) > 0.0 {
                Motion::Forward
            } else {
                Motion::Backward
            };
        }
        motion = phase.motion;
        [y[0], y[1], y[2]]
    }
}
