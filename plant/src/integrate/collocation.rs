//! One step over as much as many sub-steps cover: what the motor does by itself is exact, what the
//! laws add follows from its values at a few instants of the step (exponential collocation; Hochbruck
//! and Ostermann, 2005).
//!
//! dy/dt = A y + B (u, T_l) + g, y = (i, omega): A and B are the motor's, g is what the laws add to its
//! two rates along the motion. g is the polynomial through its values at Lobatto's nodes, to which the
//! response is exact ([`super::response`]). The values follow by sweeps: each shortens what is missing
//! by the rate of the laws times the step. The nodes are lanes of the field, so that a sweep is vector
//! code also for one drive.
//!
//! The last coefficients of g tell whether the nodes resolved it: at its end a step errs as their
//! square where the laws are smooth, and as themselves where they may have kinks. A step that does not converge or is not resolved is refused, and made of
//! sub-steps instead. Where the shaft stops in it, the instant is located on the response, which holds
//! between the nodes too.

use drivescope_numerics::Real;
use drivescope_numerics::dispatch::{Work, widest};

use super::affine::Continuous;
use super::automaton::locate;
use super::nodes::{NODES, Nodes};
use super::response::{At, AtNodes, RADIANS};
use super::step::may_dip;
use crate::model::{
    Applied, CURRENT, Inverses, Model, OWN, POSITION, Rows, SPEED, field_at, zeros,
};

/// Sub-steps that one step stands for at most: 4 armature time constants, a radian of the laws.
const MOST: usize = 32;
/// Where sub-steps are fewer, they cost less.
const LEAST: usize = 6;
/// Sweeps after which a step is given up.
const SWEEPS: usize = 16;
/// Change of a variable in the last sweep, over its size: what is missing still is that times the rate
/// of the laws times the step, some hundredths.
const CONVERGED: f64 = 1e-9;
/// Error that the polynomial between the nodes leaves in a variable, over its size.
const RESOLVED: f64 = 1e-9;
/// Share of the step by which the place of a stop is corrected at most: what is left is its square.
const LONGEST_CORRECTION: f64 = 1e-5;
/// See [`Collocation::response`]; at the start of a cache line.
#[derive(Debug, Clone)]
#[repr(align(64))]
struct Response<R>([[[AtNodes<R>; 2]; NODES]; OWN]);

/// The step over a length, for one set of parameters and both directions of motion.
#[derive(Debug, Clone)]
pub(super) struct Collocation<R> {
    /// The same drive at every node.
    model: Model<R, NODES>,
    inverses: Inverses<R, NODES>,
    motor: Continuous<R>,
    h: R,
    /// Without laws: `flow[row][column]`; columns current, speed, u, load.
    flow: Box<[[AtNodes<R>; 4]; OWN]>,
    /// To what the laws add to a rate at a node: `response[row][node of it][rate]`.
    response: Box<Response<R>>,
    nodes: &'static Nodes,
}

/// How many such steps an interval of that many sub-steps takes; nothing where they would not do.
pub(super) fn spans<R: Real, const N: usize>(
    model: &Model<R, N>,
    substeps: usize,
) -> Option<usize> {
    (model.is_without_memory() && substeps >= LEAST).then(|| substeps.div_ceil(MOST))
}

/// Room for the values at the nodes. They are rows in memory, as those of a block are: held in the
/// processor they become pieces of vectors.
#[derive(Debug, Clone)]
pub(super) struct Room<R> {
    /// The state, and what the next sweep makes of it.
    y: Rows<R, NODES>,
    next: Rows<R, NODES>,
    /// Its rates, what the laws add to them, and the state without that.
    rates: Rows<R, NODES>,
    added: Rows<R, NODES>,
    free: Rows<R, NODES>,
}

impl<R: Real> Room<R> {
    pub(super) fn new() -> Self {
        let zero = zeros(OWN);
        let [y, next, rates, added, free] = std::array::from_fn(|_| zero.clone());
        Self { y, next, rates, added, free }
    }
}

/// Rows of values at the nodes.
type Values<'a, R> = &'a [AtNodes<R>];

/// What becomes of a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum Course<R> {
    /// `x` is its end.
    Made,
    /// The speed was zero after that time, s, at that state.
    Stops(f64, [R; OWN]),
    /// It has to be made of sub-steps.
    Refused,
}

impl<R: Real> Collocation<R> {
    /// The step over `h`; nothing where the motor is too fast for it.
    pub(super) fn new(model: &Model<R, 1>, h: R) -> Option<Self> {
        let [motor] = Continuous::read(&model.bare(), 1.0, &[0.0]);
        let [[a, b], [c, d]] = motor.a.map(|row| row.map(R::value));
        let fastest = a.abs().max(d.abs()) + (b * c).abs().sqrt();
        let resolved = fastest * h.value() <= RADIANS;
        if !resolved {
            return None;
        }
        let nodes = Nodes::lobatto();
        let zero = [R::zero(); NODES];
        let mut flow = Box::new([[zero; 4]; OWN]);
        let mut response = Box::new(Response([[[zero; 2]; NODES]; OWN]));
        for (node, place) in nodes.places.into_iter().enumerate() {
            let at = At::new(&motor, nodes, h, place);
            for row in 0..OWN {
                for column in 0..4 {
                    flow[row][column][node] = at.flow[row][column];
                }
                for of in 0..NODES {
                    for rate in 0..2 {
                        response.0[row][of][rate][node] = at.response[of][rate][row];
                    }
                }
            }
        }
        let model = Model::side_by_side([model; NODES]);
        let inverses = model.motors.inverses();
        Some(Self { model, inverses, motor, h, flow, response, nodes })
    }

    /// Takes the step, or that share of it, where it holds: `x` is its end then, and else as it was.
    pub(super) fn advance(
        &self,
        x: &mut [[R; 1]],
        sign: f64,
        (applied, share): (&Applied<R, 1>, f64),
        room: &mut Room<R>,
    ) -> Course<R> {
        let mut course = Course::Refused;
        widest(Step { of: self, x, sign, applied, share, room, course: &mut course });
        course
    }

    /// The length of the whole step, s.
    pub(super) fn seconds(&self) -> f64 {
        self.h.value()
    }

    /// What the motor alone does from that state.
    #[inline(always)]
    fn flow(&self, start: [R; OWN], applied: &Applied<R, 1>, free: &mut [AtNodes<R>]) {
        for row in 0..OWN {
            let [current, speed, u, load] = &self.flow[row];
            let constant = if row == POSITION { start[POSITION] } else { R::zero() };
            for node in 0..NODES {
                let own = current[node] * start[CURRENT] + speed[node] * start[SPEED];
                let forced = u[node] * applied.u[0] + load[node] * applied.load[0];
                free[row][node] = own + forced + constant;
            }
        }
    }

    /// What the laws add to the two rates: those of the drive less those of the motor alone.
    #[inline(always)]
    fn add_up(
        &self,
        (y, rates): (&[AtNodes<R>], &[AtNodes<R>]),
        applied: &Applied<R, 1>,
        added: &mut [AtNodes<R>],
    ) {
        for rate in [CURRENT, SPEED] {
            let (a, b) = (&self.motor.a[rate], &self.motor.b[rate]);
            let held = b[0] * applied.u[0] + b[1] * applied.load[0];
            for node in 0..NODES {
                let own = a[0] * y[CURRENT][node] + a[1] * y[SPEED][node];
                added[rate][node] = rates[rate][node] - own - held;
            }
        }
    }

    /// The state with the response to that.
    #[inline(always)]
    fn respond(&self, free: &[AtNodes<R>], added: &[AtNodes<R>], next: &mut [AtNodes<R>]) {
        for row in 0..OWN {
            let mut sum = free[row];
            for of in 0..NODES {
                let [to_current, to_speed] = &self.response.0[row][of];
                let (current, speed) = (added[CURRENT][of], added[SPEED][of]);
                for node in 0..NODES {
                    sum[node] += to_current[node] * current + to_speed[node] * speed;
                }
            }
            next[row] = sum;
        }
    }

    /// Whether what the laws add is resolved, at the end of the step or everywhere in it.
    #[inline(always)]
    fn is_resolved(&self, added: &[AtNodes<R>], y: &[AtNodes<R>], everywhere: bool) -> bool {
        let mut resolved = true;
        for rate in 0..2 {
            let (tail, greatest) = self.nodes.tail(&added[rate]);
            // What is left out is integrated: Legendre's polynomials by 1 / (2 n + 1). At the end the
            // rule is right for twice the degree, and its error falls as the square.
            let between = tail / (2 * NODES + 1) as f64;
            let error = if everywhere || tail == 0.0 { between } else { tail * (tail / greatest) };
            resolved &= error * self.h.value() <= RESOLVED * size(&y[rate]);
        }
        resolved
    }

    /// Whether the sign of the motion stays at every node and between them.
    #[inline(always)]
    fn goes_on(&self, y: &[AtNodes<R>], rates: &[AtNodes<R>], sign: f64) -> bool {
        let mut ends = 0;
        for node in 1..NODES {
            ends |= u64::from(sign * y[SPEED][node].value() < 0.0);
            ends |= u64::from(self.may_dip(y, rates, sign, node));
        }
        ends == 0
    }

    /// Whether the speed may pass through zero and come back between that node and the one before.
    #[inline(always)]
    fn may_dip(&self, y: &[AtNodes<R>], rates: &[AtNodes<R>], sign: f64, node: usize) -> bool {
        let h = self.h.value() * (self.nodes.places[node] - self.nodes.places[node - 1]);
        let speed = |node: usize| sign * y[SPEED][node].value();
        let change = |node: usize| sign * rates[SPEED][node].value() * h;
        may_dip((speed(node - 1), speed(node)), (change(node - 1), change(node)))
    }

    /// Puts the end of the share of a converged step into `x`, if it holds.
    #[inline(always)]
    fn ended(
        &self,
        x: &mut [[R; 1]],
        (y, rates, added): (Values<'_, R>, Values<'_, R>, Values<'_, R>),
        (sign, applied): (f64, &Applied<R, 1>),
        share: f64,
    ) -> Course<R> {
        let start = [x[CURRENT][0], x[SPEED][0], x[POSITION][0]];
        // Where no turn is located, a drag may be kinked at one.
        let turns = !self.model.directed() && turns(&y[SPEED]);
        let everywhere = share < 1.0 || turns || !self.model.is_smooth();
        if !self.is_resolved(added, y, everywhere) {
            return Course::Refused;
        }
        if self.model.directed() && !self.goes_on(y, rates, sign) {
            let course = self.stop((start, y), (rates, added), sign, applied);
            if !matches!(course, Course::Stops(instant, _) if instant >= share * self.h.value()) {
                return course;
            }
        }
        if share < 1.0 {
            let at = At::new(&self.motor, self.nodes, self.h, share);
            x.copy_from_slice(&at.state(start, applied, added).map(|value| [value]));
        } else {
            for row in 0..OWN {
                x[row] = [y[row][NODES - 1]];
            }
        }
        Course::Made
    }

    /// Where the shaft stops first, if that is clear.
    #[cold]
    fn stop(
        &self,
        (start, y): ([R; OWN], &[AtNodes<R>]),
        (rates, added): (&[AtNodes<R>], &[AtNodes<R>]),
        sign: f64,
        applied: &Applied<R, 1>,
    ) -> Course<R> {
        let speed = |node: usize| sign * y[SPEED][node].value();
        let after = (1..NODES).find(|node| speed(*node) < 0.0);
        let until = after.unwrap_or(NODES);
        let dips = (1..until).any(|node| self.may_dip(y, rates, sign, node));
        let clear = !dips && self.is_resolved(added, y, true);
        let Some(after) = after.filter(|after| clear && speed(after - 1) > 0.0) else {
            return Course::Refused;
        };
        // The polynomial through the speeds is close; on the exact response one correction is left.
        let polynomial = self.nodes.polynomial(&y[SPEED].map(R::value));
        let near = |place: f64| sign * value(&polynomial, place);
        let [low, high] = [after - 1, after].map(|node| self.nodes.places[node]);
        let located = locate(near(low), near(high), high - low, |share| near(low + share));
        let Some(place) = located.map(|share| low + share) else { return Course::Refused };
        let there = |place: f64| {
            let at = At::new(&self.motor, self.nodes, self.h, place);
            at.state(start, applied, added)
        };
        let correction = there(place)[SPEED].value() / slope(&polynomial, place);
        let small = correction.abs() <= LONGEST_CORRECTION;
        if !small {
            return Course::Refused;
        }
        let place = place - correction;
        Course::Stops(place * self.h.value(), there(place))
    }
}

/// The polynomial of those coefficients, the lowest first, at t.
fn value(coefficients: &[f64; NODES], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// Its slope there.
fn slope(coefficients: &[f64; NODES], t: f64) -> f64 {
    let terms = coefficients.iter().enumerate().skip(1).rev();
    terms.fold(0.0, |sum, (power, c)| sum * t + power as f64 * c)
}

/// Whether a speed changes its sign.
#[inline(always)]
fn turns<R: Real>(speeds: &AtNodes<R>) -> bool {
    speeds.iter().any(|speed| speed.value() * speeds[0].value() < 0.0)
}

/// The greater of a variable's magnitudes at the two ends.
#[inline(always)]
fn size<R: Real>(y: &AtNodes<R>) -> f64 {
    let [first, last] = [y[0].value().abs(), y[NODES - 1].value().abs()];
    if first > last { first } else { last }
}

/// The greatest change of a sweep in current and speed, each over its size.
#[inline(always)]
fn change<R: Real>(before: &[AtNodes<R>], after: &[AtNodes<R>]) -> f64 {
    let mut greatest = 0.0;
    for row in [CURRENT, SPEED] {
        let mut change = 0.0;
        for node in 0..NODES {
            let apart = (after[row][node].value() - before[row][node].value()).abs();
            change = if apart > change { apart } else { change };
        }
        let share = if change > 0.0 { change / size(&after[row]) } else { 0.0 };
        greatest = if share > greatest { share } else { greatest };
    }
    greatest
}

/// One step of a drive.
struct Step<'a, R> {
    of: &'a Collocation<R>,
    x: &'a mut [[R; 1]],
    sign: f64,
    applied: &'a Applied<R, 1>,
    share: f64,
    room: &'a mut Room<R>,
    course: &'a mut Course<R>,
}

impl<R: Real> Work for Step<'_, R> {
    #[inline(always)]
    fn run(self) {
        let Self { of, x, sign, applied, share, room, course } = self;
        let Room { y, next, rates, added, free } = room;
        let (mut y, mut next) = (&mut **y, &mut **next);
        let (rates, added, free) = (&mut **rates, &mut **added, &mut **free);
        let (u, load) = ([applied.u[0]; NODES], [applied.load[0]; NODES]);
        let held = Applied { u, load, time: applied.time };
        let start = [x[CURRENT][0], x[SPEED][0], x[POSITION][0]];
        for row in 0..OWN {
            y[row] = [start[row]; NODES];
        }
        of.flow(start, applied, free);
        let signs = [sign; NODES];
        for _ in 0..SWEEPS {
            field_at(&of.model, y, (&held, held.time), (&signs, &of.inverses), rates, None);
            of.add_up((y, rates), applied, added);
            of.respond(free, added, next);
            let converged = change(y, next) <= CONVERGED;
            std::mem::swap(&mut y, &mut next);
            if converged {
                *course = of.ended(x, (y, rates, added), (sign, applied), share);
                return;
            }
        }
    }
}
