//! One step over as much as many sub-steps cover: what the motor does by itself is exact, what the
//! laws add follows from its values at a few instants of the step.
//!
//! dy/dt = A y + B (u, T_l) + g(t), y = (i, omega): A and B are the motor's, g what the laws add to
//! its two rates along the motion. Between Lobatto's nodes g is the polynomial through its values there,
//! whose response is exact:
//!
//!   y(c h) = e^(A c h) y(0) + .. + h sum_m c^(m+1) m! phi_(m+1)(A c h) d_m,  g = sum_m d_m (t / h)^m
//!
//! (Hochbruck and Ostermann, 2005: exponential collocation). The values follow by sweeps, each of
//! which shortens what is missing by the rate of the laws times h. At its end such a step errs as the square of the
//! last coefficients of g does, so these tell whether the nodes resolved it. The nodes are lanes of
//! the field: a sweep is vector code also for one drive.
//!
//! A step that does not converge or is not resolved is refused, and made of sub-steps instead. Where
//! the shaft stops in it, the instant is located on the exact response, which holds between the nodes too.

use drivescope_numerics::Real;
use drivescope_numerics::dispatch::{Work, widest};

use super::affine::Continuous;
use super::automaton::locate;
use super::nodes::{NODES, Nodes};
use super::step::may_dip;
use crate::model::{Applied, CURRENT, Inverses, Model, OWN, POSITION, SPEED, field_at};

/// Sub-steps that one step stands for at most: 4 armature time constants, a radian of the laws.
const MOST: usize = 32;
/// Where sub-steps are fewer, they cost less.
const LEAST: usize = 6;
/// Sweeps after which a step is given up.
const SWEEPS: usize = 16;
/// Change of a sweep, over the size of the variable, that ends them: what is missing still is that
/// times the rate of the laws times h.
const CONVERGED: f64 = 1e-9;
/// Error of the speed by the nodes, over its size; the laws that follow bring in no more by being
/// differentiated.
const RESOLVED: f64 = 1e-10;
/// Share of the step by which the place of a stop is corrected at most: what is left is its square.
const LONGEST_CORRECTION: f64 = 1e-5;
/// Fastest rate of the motor times the step at most, for the series for phi ends after [`TERMS`].
const RADIANS: f64 = 5.0;
/// 5^28 9! / 37! is 1e-18.
const TERMS: usize = 28;

/// What a value at every node is.
type AtNodes<R> = [R; NODES];

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
    /// To what the laws add to a rate at a node: `response[node of it][rate][row]`.
    response: Box<[[[AtNodes<R>; OWN]; 2]; NODES]>,
    nodes: Nodes,
}

/// A 2 x 2 matrix.
type Square<R> = [[R; 2]; 2];

/// `z x + unit I`.
fn product_and_unit<R: Real>(z: &Square<R>, x: &Square<R>, unit: f64) -> Square<R> {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let sum = z[row][0] * x[0][column] + z[row][1] * x[1][column];
            if row == column { sum + R::constant(unit) } else { sum }
        })
    })
}

/// 1 / k!.
const INVERSE_FACTORIALS: [f64; TERMS + NODES + 1] = {
    let mut all = [1.0; TERMS + NODES + 1];
    let mut k = 1;
    while k < all.len() {
        all[k] = all[k - 1] / k as f64;
        k += 1;
    }
    all
};

/// phi_0 = e^z to phi_(NODES + 1): phi_k = z phi_(k+1) + 1 / k!, the last as a series.
fn phi<R: Real>(z: &Square<R>) -> [Square<R>; NODES + 2] {
    let mut last = [[R::zero(); 2]; 2];
    for inverse in INVERSE_FACTORIALS[NODES + 1..].iter().rev() {
        last = product_and_unit(z, &last, *inverse);
    }
    let mut all = [last; NODES + 2];
    for k in (0..=NODES).rev() {
        all[k] = product_and_unit(z, &all[k + 1], INVERSE_FACTORIALS[k]);
    }
    all
}

/// How many such steps an interval of that many sub-steps takes; nothing where they would not do.
pub(super) fn spans<R: Real, const N: usize>(
    model: &Model<R, N>,
    substeps: usize,
) -> Option<usize> {
    (model.is_without_memory() && substeps >= LEAST).then(|| substeps.div_ceil(MOST))
}

/// What the state at one place in the step follows from.
struct At<R> {
    flow: [[R; 4]; OWN],
    response: [[[R; OWN]; 2]; NODES],
}

impl<R: Real> At<R> {
    /// `place` is the share of the step `h` that has passed.
    fn new(motor: &Continuous<R>, nodes: &Nodes, h: R, place: f64) -> Self {
        let passed = h.scaled(place);
        let phi = phi(&motor.a.map(|row| row.map(|rate| rate * passed)));
        // To inputs that grow with that power of time; the position is the integral of the speed.
        let rows = |power: usize| {
            let [now, next] = [phi[power + 1], phi[power + 2]];
            [now[0], now[1], next[1].map(|x| x * passed)]
        };
        let mut made =
            Self { flow: [[R::zero(); 4]; OWN], response: [[[R::zero(); OWN]; 2]; NODES] };
        let free = [phi[0][0], phi[0][1], phi[1][1].map(|x| x * passed)];
        let held = rows(0).map(|row| row.map(|x| x * passed));
        for row in 0..OWN {
            for column in 0..2 {
                made.flow[row][column] = free[row][column];
                let [b, d] = [motor.b[0][column], motor.b[1][column]];
                made.flow[row][2 + column] = held[row][0] * b + held[row][1] * d;
            }
        }
        // m! c^(m+1).
        let mut weight = place;
        for power in 0..NODES {
            weight *= if power == 0 { 1.0 } else { power as f64 * place };
            let rows = rows(power);
            for (response, coefficients) in made.response.iter_mut().zip(&nodes.coefficients) {
                let share = h.scaled(weight * coefficients[power]);
                for rate in 0..2 {
                    for row in 0..OWN {
                        response[rate][row] += share * rows[row][rate];
                    }
                }
            }
        }
        made
    }

    /// The state there.
    fn state(&self, start: [R; OWN], applied: &Applied<R, 1>, added: &[AtNodes<R>; 2]) -> [R; OWN] {
        let acting = [start[CURRENT], start[SPEED], applied.u[0], applied.load[0]];
        std::array::from_fn(|row| {
            let mut sum = if row == POSITION { start[POSITION] } else { R::zero() };
            for (share, value) in self.flow[row].iter().zip(acting) {
                sum += *share * value;
            }
            for (of, response) in self.response.iter().enumerate() {
                sum += response[0][row] * added[0][of] + response[1][row] * added[1][of];
            }
            sum
        })
    }
}

/// What becomes of a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum Course<R> {
    /// It was made.
    Whole,
    /// The speed was zero after that time, s, at that state.
    Stops(f64, [R; OWN]),
    /// It has to be made of sub-steps.
    Refused,
}

impl<R: Real> Collocation<R> {
    /// The step over `h`; nothing where the motor is too fast for it.
    pub(super) fn new(model: &Model<R, 1>, h: R) -> Option<Self> {
        let motor = Continuous::read(&model.bare(), 0, 1.0, 0.0);
        let [[a, b], [c, d]] = motor.a.map(|row| row.map(R::value));
        let fastest = a.abs().max(d.abs()) + (b * c).abs().sqrt();
        if !(fastest * h.value() <= RADIANS) {
            return None;
        }
        let nodes = Nodes::new();
        let zero = [R::zero(); NODES];
        let mut flow = Box::new([[zero; 4]; OWN]);
        let mut response = Box::new([[[zero; OWN]; 2]; NODES]);
        for (node, place) in nodes.places.into_iter().enumerate() {
            let at = At::new(&motor, &nodes, h, place);
            for row in 0..OWN {
                for column in 0..4 {
                    flow[row][column][node] = at.flow[row][column];
                }
                for of in 0..NODES {
                    for rate in 0..2 {
                        response[of][rate][row][node] = at.response[of][rate][row];
                    }
                }
            }
        }
        let model = Model::side_by_side([model; NODES]);
        let inverses = model.motors.inverses();
        Some(Self { model, inverses, motor, h, flow, response, nodes })
    }

    /// Takes the step where it holds: `x` is its end then, and else as it was.
    pub(super) fn advance(
        &self,
        x: &mut [[R; 1]],
        sign: f64,
        applied: &Applied<R, 1>,
    ) -> Course<R> {
        let mut course = Course::Refused;
        widest(Step { of: self, x, sign, applied, course: &mut course });
        course
    }

    /// What the motor alone does from that state.
    #[inline(always)]
    fn flow(&self, start: [R; OWN], applied: &Applied<R, 1>) -> [AtNodes<R>; OWN] {
        let mut y = [[R::zero(); NODES]; OWN];
        for row in 0..OWN {
            let [current, speed, u, load] = &self.flow[row];
            let constant = if row == POSITION { start[POSITION] } else { R::zero() };
            for node in 0..NODES {
                let free = current[node] * start[CURRENT] + speed[node] * start[SPEED];
                let forced = u[node] * applied.u[0] + load[node] * applied.load[0];
                y[row][node] = free + forced + constant;
            }
        }
        y
    }

    /// What the laws add to the two rates: those of the drive less those of the motor alone.
    #[inline(always)]
    fn added(
        &self,
        rates: &[AtNodes<R>; OWN],
        y: &[AtNodes<R>; OWN],
        applied: &Applied<R, 1>,
    ) -> [AtNodes<R>; 2] {
        let mut added = [[R::zero(); NODES]; 2];
        for rate in 0..2 {
            let [a, b] = [self.motor.a[rate], [self.motor.b[rate][0], self.motor.b[rate][1]]];
            let held = b[0] * applied.u[0] + b[1] * applied.load[0];
            for node in 0..NODES {
                let own = a[0] * y[CURRENT][node] + a[1] * y[SPEED][node];
                added[rate][node] = rates[rate][node] - own - held;
            }
        }
        added
    }

    /// The response to that.
    #[inline(always)]
    fn respond(&self, free: &[AtNodes<R>; OWN], added: &[AtNodes<R>; 2]) -> [AtNodes<R>; OWN] {
        let mut sums = [*free, [[R::zero(); NODES]; OWN]];
        for (of, response) in self.response.iter().enumerate() {
            for rate in 0..2 {
                for row in 0..OWN {
                    for node in 0..NODES {
                        sums[rate][row][node] += response[rate][row][node] * added[rate][of];
                    }
                }
            }
        }
        let [mut y, by_speed] = sums;
        for row in 0..OWN {
            for node in 0..NODES {
                y[row][node] += by_speed[row][node];
            }
        }
        y
    }

    /// Whether what the laws add is resolved: over the step the speed errs by less than its share.
    #[inline(always)]
    fn is_resolved(&self, added: &[AtNodes<R>; 2], y: &[AtNodes<R>; OWN]) -> bool {
        let mut resolved = true;
        for rate in 0..2 {
            let error = self.h.value() * self.nodes.quadrature_error(&added[rate]);
            resolved &= error <= RESOLVED * size(&y[rate]);
        }
        resolved
    }

    /// Whether the sign of the motion stays at every node and between them.
    #[inline(always)]
    fn goes_on(&self, y: &[AtNodes<R>; OWN], rates: &[AtNodes<R>; OWN], sign: f64) -> bool {
        let mut ends = 0;
        for node in 1..NODES {
            ends |= u64::from(sign * y[SPEED][node].value() < 0.0);
            ends |= u64::from(self.may_dip(y, rates, sign, node));
        }
        ends == 0
    }

    /// Whether the speed may pass through zero and come back between that node and the one before.
    #[inline(always)]
    fn may_dip(
        &self,
        y: &[AtNodes<R>; OWN],
        rates: &[AtNodes<R>; OWN],
        sign: f64,
        node: usize,
    ) -> bool {
        let h = self.h.value() * (self.nodes.places[node] - self.nodes.places[node - 1]);
        let speed = |node: usize| sign * y[SPEED][node].value();
        let change = |node: usize| sign * rates[SPEED][node].value() * h;
        may_dip((speed(node - 1), speed(node)), (change(node - 1), change(node)))
    }

    /// Where the shaft stops first, if that is clear.
    #[cold]
    fn stop(
        &self,
        (start, y): ([R; OWN], &[AtNodes<R>; OWN]),
        (rates, added): (&[AtNodes<R>; OWN], &[AtNodes<R>; 2]),
        sign: f64,
        applied: &Applied<R, 1>,
    ) -> Course<R> {
        let speed = |node: usize| sign * y[SPEED][node].value();
        let after = (1..NODES).find(|node| speed(*node) < 0.0);
        let until = after.unwrap_or(NODES);
        let dips = (1..until).any(|node| self.may_dip(y, rates, sign, node));
        let Some(after) = after.filter(|after| !dips && speed(after - 1) > 0.0) else {
            return Course::Refused;
        };
        // The polynomial through the speeds is close; on the exact response one correction is left.
        let polynomial = self.nodes.polynomial(&y[SPEED].map(R::value));
        let near = |place: f64| sign * value(&polynomial, place);
        let [low, high] = [after - 1, after].map(|node| self.nodes.places[node]);
        let located = locate(near(low), near(high), high - low, |share| near(low + share));
        let Some(place) = located.map(|share| low + share) else { return Course::Refused };
        let there = |place: f64| {
            let at = At::new(&self.motor, &self.nodes, self.h, place);
            at.state(start, applied, added)
        };
        let correction = there(place)[SPEED].value() / slope(&polynomial, place);
        if !(correction.abs() <= LONGEST_CORRECTION) {
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

/// The greater of a variable's magnitudes at the two ends.
#[inline(always)]
fn size<R: Real>(y: &AtNodes<R>) -> f64 {
    let [first, last] = [y[0].value().abs(), y[NODES - 1].value().abs()];
    if first > last { first } else { last }
}

/// Whether a sweep changed neither current nor speed by more than [`CONVERGED`].
#[inline(always)]
fn is_close<R: Real>(before: &[AtNodes<R>; OWN], after: &[AtNodes<R>; OWN]) -> bool {
    let mut apart = 0;
    for row in [CURRENT, SPEED] {
        let limit = CONVERGED * size(&after[row]);
        for node in 0..NODES {
            let change = (after[row][node].value() - before[row][node].value()).abs();
            // Not a number is never close.
            apart += u64::from(!(change <= limit));
        }
    }
    apart == 0
}

/// One step of a drive.
struct Step<'a, R> {
    of: &'a Collocation<R>,
    x: &'a mut [[R; 1]],
    sign: f64,
    applied: &'a Applied<R, 1>,
    course: &'a mut Course<R>,
}

impl<R: Real> Work for Step<'_, R> {
    #[inline(always)]
    fn run(self) {
        let Self { of, x, sign, applied, course } = self;
        let start = [x[CURRENT][0], x[SPEED][0], x[POSITION][0]];
        let held = Applied {
            u: [applied.u[0]; NODES],
            load: [applied.load[0]; NODES],
            time: applied.time,
        };
        let free = of.flow(start, applied);
        let signs = ([sign; NODES], &of.inverses);
        let mut y = [[start[0]; NODES], [start[1]; NODES], [start[2]; NODES]];
        let mut rates = [[R::zero(); NODES]; OWN];
        for _ in 0..SWEEPS {
            field_at(&of.model, &y, (&held, held.time), (&signs.0, signs.1), &mut rates, None);
            let added = of.added(&rates, &y, applied);
            let next = of.respond(&free, &added);
            let close = is_close(&y, &next);
            y = next;
            if close {
                if !of.is_resolved(&added, &y) {
                    return;
                }
                if of.model.directed() && !of.goes_on(&y, &rates, sign) {
                    *course = of.stop((start, &y), (&rates, &added), sign, applied);
                    return;
                }
                for row in [CURRENT, SPEED, POSITION] {
                    x[row] = [y[row][NODES - 1]];
                }
                *course = Course::Whole;
                return;
            }
        }
    }
}
