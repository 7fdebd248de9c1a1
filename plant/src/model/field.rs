//! The right-hand side of the drive, written once over the scalar and over the lanes.
//!
//! L di/dt = u - R (1 + ..) i - K_e (flux) omega - (voltage)                     (20), (21)
//! J domega/dt = K_m (flux) i - B_m omega - (torque) - T_l - s (dry friction)    (22), (23)
//!
//! The brackets are what the effects add up to. s is the sign of the motion: +1 or -1 while
//! the shaft slips, 0 while it sticks. For a given s the field is smooth, also across
//! omega = 0: the automaton of [`crate::integrate`] changes s at located events.

use drivescope_numerics::Real;

use super::{Applied, CURRENT, Inverses, Model, OWN, POSITION, SPEED};
use crate::effects::law::{Sum, Sums, Views};

/// What the effects see at `time`, lane by lane.
#[inline(always)]
pub(super) fn views<'a, R: Real, const N: usize>(
    model: &'a Model<R, N>,
    x: &'a [[R; N]],
    applied: &'a Applied<R, N>,
    time: f64,
    direction: &'a [f64; N],
) -> Views<'a, R, N> {
    let i = if model.force { &applied.u } else { &x[CURRENT] };
    let (omega, theta) = (&x[SPEED], &x[POSITION]);
    let (motors, u, load) = (&model.motors, &applied.u, &applied.load);
    Views { motors, i, omega, theta, direction, u, load, time }
}

/// Sums before any effect, with the inverse of the inertia that the motor alone has.
#[inline(always)]
fn empty<R: Real, const N: usize>(inverses: &Inverses<R, N>) -> Sums<R, N> {
    let zero = R::zero();
    Sums {
        inverse_inertia: inverses.j,
        ..Sums::splat(Sum {
            voltage: zero,
            torque: zero,
            forward: zero,
            backward: zero,
            flux: R::one(),
            resistance: R::one(),
            heat: zero,
            inverse_inertia: zero,
            load: zero,
            acceleration: zero,
        })
    }
}

/// Adds up the effects, without the acceleration, which closes the balances. In place: the sums
/// of a block of lanes are too large to be handed on by value.
#[inline(always)]
fn add_up<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    sum: &mut Sums<R, N>,
) {
    let motors = &model.motors;
    sum.load = *at.load;
    for part in &model.placed {
        part.share(&model.laws, &model.p, &x[OWN..], at, sum);
    }
    for l in 0..N {
        sum.forward[l] *= motors.friction[l];
        sum.backward[l] *= motors.friction[l];
    }
}

/// Torque on the shaft without dry friction, one lane.
#[inline(always)]
fn net<R: Real, const N: usize>(
    model: &Model<R, N>,
    at: &Views<'_, R, N>,
    sum: &Sums<R, N>,
    l: usize,
) -> R {
    let viscous = model.motors.b_m[l] * model.motors.friction[l] * at.omega[l];
    model.motors.k_m[l] * at.i[l] * sum.flux[l] - viscous - sum.torque[l] - sum.load[l]
}

/// Time derivatives `dx` of the state `x`, and the decay rates of its stiff own states where
/// `lambda` is given. `sign` is the sign of the motion in each lane, 0 where it sticks.
#[inline(always)]
pub fn field<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    applied: &Applied<R, N>,
    sign: &[f64; N],
    dx: &mut [[R; N]],
    lambda: Option<&mut [[R; N]]>,
) {
    let inverses = model.motors.inverses();
    field_at(model, x, (applied, applied.time), (sign, &inverses), dx, lambda);
}

/// The same at another time, the inputs held, with inverses made once for many calls.
#[inline(always)]
pub(crate) fn field_at<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    (applied, time): (&Applied<R, N>, f64),
    (sign, inverses): (&[f64; N], &Inverses<R, N>),
    dx: &mut [[R; N]],
    lambda: Option<&mut [[R; N]]>,
) {
    let controlled;
    let applied = match &model.control {
        None => applied,
        Some(_) => {
            integrate_error(model, x, &Applied { time, ..*applied }, dx);
            controlled = model.under_control(x, &Applied { time, ..*applied });
            &controlled
        }
    };
    let at = views(model, x, applied, time, sign);
    let mut sum = empty(inverses);
    close(model, x, &at, (sign, inverses), &mut sum, dx);
    own_rates(model, x, &at, &sum, dx, lambda);
}

/// The same along a motion that is known: the shaft has that acceleration, whatever gives it, and own
/// states follow it; `dx` holds what the balances say of current and speed. The inertia of the shaft.
pub(super) fn field_along<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    (applied, acceleration): (&Applied<R, N>, &[R; N]),
    sign: &[f64; N],
    dx: &mut [[R; N]],
    lambda: &mut [[R; N]],
) -> [R; N] {
    let at = views(model, x, applied, applied.time, sign);
    let inverses = model.motors.inverses();
    let mut sum = empty(&inverses);
    close(model, x, &at, (sign, &inverses), &mut sum, dx);
    sum.acceleration = *acceleration;
    own_rates(model, x, &at, &sum, dx, Some(lambda));
    sum.inverse_inertia.map(|inverse| R::one() / inverse)
}

/// Adds up the effects and closes the balances: the rates of current, speed and position.
#[inline(always)]
fn close<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    (sign, inverses): (&[f64; N], &Inverses<R, N>),
    sum: &mut Sums<R, N>,
    dx: &mut [[R; N]],
) {
    add_up(model, x, at, sum);
    let motors = &model.motors;
    for l in 0..N {
        let net = net(model, at, sum, l);
        let level = R::select(sign[l] > 0.0, sum.forward[l], -sum.backward[l]);
        let slipping = if model.dry { net - level } else { net };
        let sticks = model.dry && sign[l] == 0.0;
        sum.acceleration[l] = R::select(sticks, R::zero(), slipping * sum.inverse_inertia[l]);
    }
    for l in 0..N {
        let drop = motors.r[l] * sum.resistance[l] * at.i[l] + sum.voltage[l];
        let back_emf = motors.k_e[l] * sum.flux[l] * at.omega[l];
        let electrical = (at.u[l] - drop - back_emf) * inverses.l[l];
        dx[CURRENT][l] = if model.force { R::zero() } else { electrical };
        dx[SPEED][l] = sum.acceleration[l];
        dx[POSITION][l] = at.omega[l];
    }
}

/// Rates of the own states, and their decay rates.
#[inline(always)]
fn own_rates<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    sum: &Sums<R, N>,
    dx: &mut [[R; N]],
    lambda: Option<&mut [[R; N]]>,
) {
    if model.own_states == 0 {
        return;
    }
    for part in &model.placed {
        part.rate(&model.p, &x[OWN..], at, sum, &mut dx[OWN..]);
    }
    if let Some(lambda) = lambda {
        for part in &model.placed {
            part.decay(&model.p, &x[OWN..], at, sum, &mut lambda[OWN..]);
        }
    }
}

/// Rates of the continuous controllers' integrators.
#[inline(always)]
fn integrate_error<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &[[R; N]],
    applied: &Applied<R, N>,
    dx: &mut [[R; N]],
) {
    for l in 0..N {
        let rate = model.controlled(x, applied, l).map(|signals| signals.integral_rate);
        dx[OWN + model.own_states][l] = rate.unwrap_or(R::zero());
    }
}

/// Torques that decide whether a shaft at rest stays there, N m or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRest<R> {
    /// Torque on the shaft without dry friction, load included.
    pub net: R,
    /// Break-away level in forward direction.
    pub forward: R,
    /// Break-away level in backward direction.
    pub backward: R,
}

impl<R: Real> AtRest<R> {
    /// What is missing until the shaft breaks away; negative once it must move.
    pub fn margin(&self) -> R {
        let (up, down) = (self.forward - self.net, self.backward + self.net);
        R::select(up.value() < down.value(), up, down)
    }

    /// Sign of the motion that a shaft at rest takes up: 0 if it sticks.
    pub fn sign(&self) -> f64 {
        if self.net.value() > self.forward.value() {
            1.0
        } else if self.net.value() < -self.backward.value() {
            -1.0
        } else {
            0.0
        }
    }
}

/// The torques at the state `x`, whose speed is zero.
pub fn at_rest<R: Real>(model: &Model<R, 1>, x: &[[R; 1]], applied: &Applied<R, 1>) -> AtRest<R> {
    let applied = &model.under_control(x, applied);
    let at = views(model, x, applied, applied.time, &[0.0]);
    let mut sum = empty(&model.motors.inverses());
    add_up(model, x, &at, &mut sum);
    AtRest { net: net(model, &at, &sum, 0), forward: sum.forward[0], backward: sum.backward[0] }
}
