//! The stick-slip automaton: forward, stuck, backward, with located changes.
//!
//! Within a sub-step the sign of the motion is fixed and the field smooth. Where the speed
//! would cross zero, or a stuck shaft would break away, the instant is located, the speed set
//! to exactly zero and the next sign decided by the torques at rest. For duals the instant
//! carries its derivatives by the implicit-function theorem.

use drivescope_numerics::Real;

use super::step::{Armature, Stages, may_dip, step};
use crate::model::{Applied, Model, SPEED, at_rest, field};

/// More changes of the sign than this within a sub-step: the sign is held for the rest of it,
/// and a shaft with dry friction too.
const MOST_EVENTS: usize = 16;
/// Halvings of a bracket until it is as short as a rounding error of the step.
const MOST_HALVINGS: usize = 60;
/// Golden sections until a minimum is known as well as rounding lets it: 0.618^36 = 3e-8.
const MOST_SECTIONS: usize = 36;
/// Share of the step by which the rate of the event function is found by differences.
const DIFFERENCE: f64 = 1e-4;

/// Advances one drive by `h`, its state `x` and sign of motion in place. `start` is the state
/// before the step, to return to if the step met an event.
#[inline(always)]
pub(super) fn advance<R: Real>(
    model: &Model<R, 1>,
    (x, sign): (&mut [[R; 1]], &mut f64),
    applied: &Applied<R, 1>,
    h: R,
    armature: &Armature<R, 1>,
    room: &mut Stages<R, 1>,
    start: &[[R; 1]],
) {
    one_step(model, x, *sign, applied, h, armature, room);
    if model.directed() && may_change(model, (start, x), *sign, applied, h.value(), room) {
        x.copy_from_slice(start);
        through_events(model, x, sign, applied, h, room);
    }
}

/// The same in equal parts.
#[cold]
pub(super) fn advance_in_parts<R: Real>(
    model: &Model<R, 1>,
    (x, sign): (&mut [[R; 1]], &mut f64),
    applied: &Applied<R, 1>,
    h: R,
    parts: f64,
    room: &mut Stages<R, 1>,
    start: &mut [[R; 1]],
) {
    let h = h.scaled(1.0 / parts);
    let armature = Armature::new(model, h);
    for k in 0..parts as usize {
        start.copy_from_slice(x);
        let held = Applied { time: applied.time + k as f64 * h.value(), ..*applied };
        advance(model, (x, sign), &held, h, &armature, room, start);
    }
}

/// The step of one drive, compiled once a scalar: it holds every effect four times.
#[inline(never)]
fn one_step<R: Real>(
    model: &Model<R, 1>,
    x: &mut [[R; 1]],
    sign: f64,
    applied: &Applied<R, 1>,
    h: R,
    armature: &Armature<R, 1>,
    room: &mut Stages<R, 1>,
) {
    step(model, x, (applied, applied.time), &[sign], h, armature, room);
}

/// The event function `tau` after the inputs' time: positive while the sign of the motion holds.
fn event<R: Real>(
    model: &Model<R, 1>,
    x: &[[R; 1]],
    sign: f64,
    applied: &Applied<R, 1>,
    tau: f64,
) -> R {
    if sign == 0.0 {
        at_rest(model, x, &Applied { time: applied.time + tau, ..*applied }).margin()
    } else {
        x[SPEED][0].scaled(sign)
    }
}

/// Whether the sign of the motion changes by the end of the step just made from `start` to
/// `end`, or may have changed inside it.
#[inline(always)]
fn may_change<R: Real>(
    model: &Model<R, 1>,
    (start, end): (&[[R; 1]], &[[R; 1]]),
    sign: f64,
    applied: &Applied<R, 1>,
    h: f64,
    room: &Stages<R, 1>,
) -> bool {
    let last = event(model, end, sign, applied, h).value();
    if last < 0.0 {
        return true;
    }
    if sign != 0.0 {
        let first = sign * start[SPEED][0].value();
        let [falls, rises] = room.accelerations().map(|slope| sign * slope[0].value() * h);
        return may_dip((first, last), (falls, rises));
    }
    if !model.restless() {
        return false;
    }
    let first = event(model, start, sign, applied, 0.0).value();
    let middle = event(model, room.middle(), sign, applied, 0.5 * h).value();
    // The parabola first + b t + c t^2 through the three has its lowest point inside.
    let (b, c) = (4.0 * middle - 3.0 * first - last, 2.0 * (first + last - 2.0 * middle));
    middle < 0.0 || (b < 0.0 && -b < 2.0 * c && 4.0 * c * first < b * b)
}

/// The state after a step of `h` with that sign of the motion.
fn stepped<R: Real>(
    model: &Model<R, 1>,
    x: &[[R; 1]],
    sign: f64,
    applied: &Applied<R, 1>,
    h: R,
    room: &mut Stages<R, 1>,
) -> Vec<[R; 1]> {
    let mut next = x.to_vec();
    one_step(model, &mut next, sign, applied, h, &Armature::new(model, h), room);
    next
}

#[cold]
fn through_events<R: Real>(
    model: &Model<R, 1>,
    x: &mut [[R; 1]],
    sign: &mut f64,
    applied: &Applied<R, 1>,
    h: R,
    room: &mut Stages<R, 1>,
) {
    let mut left = h;
    let mut applied = *applied;
    for _ in 0..MOST_EVENTS {
        let end = stepped(model, x, *sign, &applied, left, room);
        let whole = left.value();
        let may_change = may_change(model, (x, &end), *sign, &applied, whole, room);
        let last = event(model, &end, *sign, &applied, whole).value();
        let start = event(model, x, *sign, &applied, 0.0).value();
        let mut margin = |tau: f64| {
            let there = stepped(model, x, *sign, &applied, R::constant(tau), room);
            event(model, &there, *sign, &applied, tau).value()
        };
        let negative = match may_change {
            true if last < 0.0 => Some((whole, last)),
            true => Some(lowest(whole, &mut margin)).filter(|(_, value)| *value < 0.0),
            false => None,
        };
        let Some((until, value)) = negative else {
            x.copy_from_slice(&end);
            return;
        };
        let Some(instant) = locate(start, value, until, margin) else {
            // Pressed back at once: it was at rest and stays there, or goes the other way.
            *sign = if model.dry() { 0.0 } else { -*sign };
            continue;
        };
        let (there, moved) = at_event(model, x, *sign, &applied, (instant, left), room);
        left -= R::constant(instant) + moved;
        applied.time += instant;
        *sign = after(model, &there, *sign, &applied);
        x.copy_from_slice(&there);
        if left.value() <= 0.0 {
            return;
        }
    }
    if model.dry() {
        *sign = 0.0;
        x[SPEED] = [R::zero()];
    }
    let end = stepped(model, x, *sign, &applied, left, room);
    x.copy_from_slice(&end);
}

/// The sign of the motion after an event, at which the state is `x`.
pub(super) fn after<R: Real>(
    model: &Model<R, 1>,
    x: &[[R; 1]],
    sign: f64,
    applied: &Applied<R, 1>,
) -> f64 {
    if !model.dry() {
        return -sign;
    }
    let torques = at_rest(model, x, applied);
    if sign != 0.0 {
        return torques.sign();
    }
    // It breaks away to the side it is pushed to, whatever the last bit says.
    if torques.net.value() > 0.0 { 1.0 } else { -1.0 }
}

/// The state at a located event, its speed exactly zero, and by how much the instant moves with
/// the parameters: d tau = -d(event) / (rate of the event). The value of that is zero.
pub(super) fn at_event<R: Real>(
    model: &Model<R, 1>,
    x: &[[R; 1]],
    sign: f64,
    applied: &Applied<R, 1>,
    (instant, left): (f64, R),
    room: &mut Stages<R, 1>,
) -> (Vec<[R; 1]>, R) {
    let mut there = stepped(model, x, sign, applied, R::constant(instant), room);
    let value = event(model, &there, sign, applied, instant);
    let mut beside = |tau: f64| {
        let there = stepped(model, x, sign, applied, R::constant(tau), room);
        event(model, &there, sign, applied, tau).value()
    };
    let difference = DIFFERENCE * left.value();
    let rise = beside(instant + difference) - beside(instant - difference);
    let rate = rise / (2.0 * difference);
    // A plain number does not move, and a grazing event (rate zero) has no derivative.
    let inverse = if rate == 0.0 { 0.0 } else { 1.0 / rate };
    let moved = (R::constant(value.value()) - value).scaled(inverse);
    let mut slope = there.clone();
    let then = Applied { time: applied.time + instant, ..*applied };
    field(model, &there, &then, &[sign], &mut slope, None);
    for (state, slope) in there.iter_mut().zip(&slope) {
        state[0] += slope[0] * moved;
    }
    there[SPEED] = [R::zero()];
    (there, moved)
}

/// The lowest point of a function with one minimum in [0, h], as (place, value): by golden
/// section, which ends early once the function is seen negative.
fn lowest(h: f64, mut event: impl FnMut(f64) -> f64) -> (f64, f64) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.0, h);
    let mut left = (h - golden * h, event(h - golden * h));
    let mut right = (golden * h, event(golden * h));
    for _ in 0..MOST_SECTIONS {
        if left.1 < 0.0 || right.1 < 0.0 {
            break;
        }
        if left.1 < right.1 {
            (high, right) = (right.0, left);
            let place = high - golden * (high - low);
            left = (place, event(place));
        } else {
            (low, left) = (left.0, right);
            let place = low + golden * (high - low);
            right = (place, event(place));
        }
    }
    if left.1 < right.1 { left } else { right }
}

/// The instant in (0, h] at which an event function that ends negative becomes so; nothing if
/// it is negative from the start on. By the Illinois method, to a rounding error of `h`.
pub(super) fn locate(
    start: f64,
    end: f64,
    h: f64,
    mut event: impl FnMut(f64) -> f64,
) -> Option<f64> {
    let (mut low, mut at_low) = (0.0, start);
    let (mut high, mut at_high) = (h, end);
    // An event leaves exactly zero behind: go forward until the function is clear of it.
    let mut halvings = 0;
    while at_low <= 0.0 {
        halvings += 1;
        if halvings > MOST_HALVINGS {
            return None;
        }
        let tau = 0.5 * high;
        let value = event(tau);
        if value > 0.0 {
            (low, at_low) = (tau, value);
        } else {
            (high, at_high) = (tau, value);
        }
    }
    let mut side = 0;
    for _ in 0..MOST_HALVINGS {
        if high - low <= f64::EPSILON * h {
            break;
        }
        let chord = (low * at_high - high * at_low) / (at_high - at_low);
        let inside = chord > low && chord < high;
        let tau = if inside { chord } else { 0.5 * (low + high) };
        let value = event(tau);
        if value == 0.0 {
            return Some(tau);
        }
        if value > 0.0 {
            (low, at_low) = (tau, value);
            if side == 1 {
                at_high *= 0.5;
            }
            side = 1;
        } else {
            (high, at_high) = (tau, value);
            if side == -1 {
                at_low *= 0.5;
            }
            side = -1;
        }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_is_located_to_a_rounding_error() {
        let f = |t: f64| 2.0 - (3.0 * t).exp();
        let root = locate(f(0.0), f(1.0), 1.0, f).expect("it crosses");
        assert!((root - 2f64.ln() / 3.0).abs() < 1e-15, "{root}");
    }

    #[test]
    fn a_dip_is_found_and_its_depth_where_it_stays_above_zero() {
        let (place, value) = lowest(2.0, |t| (t - 0.7).powi(2) + 0.1);
        assert!((place - 0.7).abs() < 1e-7 && (value - 0.1).abs() < 1e-14, "{place}, {value}");
        let (place, value) = lowest(2.0, |t| (t - 0.7).powi(2) - 1e-6);
        assert!(value < 0.0 && (place - 0.7).abs() < 1e-3, "{place}, {value}");
    }

    #[test]
    fn a_function_that_leaves_zero_upwards_first_is_located_later() {
        let f = |t: f64| t * (0.3 - t);
        let root = locate(f(0.0), f(1.0), 1.0, f).expect("it crosses");
        assert!((root - 0.3).abs() < 1e-15, "{root}");
        assert_eq!(locate(0.0, -1.0, 1.0, |t| -t), None);
    }
}
