//! One exponential Runge-Kutta step of order four, over lanes, for a given sign of the motion.

use drivescope_numerics::Real;

use super::exponential::Exponential;
use crate::model::{Applied, CURRENT, Inverses, Model, OWN, Rows, SPEED, field_at, zeros};

/// Room for the stages of a step; allocated once, reused by every step.
#[derive(Debug, Clone)]
pub(super) struct Stages<R, const N: usize> {
    /// Slopes N(x) = x' + lambda x at the start, twice in the middle and at the end.
    slopes: [Rows<R, N>; 4],
    /// State at a stage, and the middle stage that the last one starts from.
    stage: Rows<R, N>,
    middle: Rows<R, N>,
    lambda: Rows<R, N>,
    /// Coefficients of the stiff own states, made anew at each step.
    stiff: Vec<Option<Exponential<R, N>>>,
}

impl<R: Real, const N: usize> Stages<R, N> {
    pub(super) fn new(states: usize) -> Self {
        let zero = zeros(states);
        Self {
            slopes: [zero.clone(), zero.clone(), zero.clone(), zero.clone()],
            stage: zero.clone(),
            middle: zero.clone(),
            lambda: zero,
            stiff: vec![None; states],
        }
    }

    /// Accelerations at the start and at the end of the step just made.
    #[inline(always)]
    pub(super) fn accelerations(&self) -> [&[R; N]; 2] {
        [&self.slopes[0][SPEED], &self.slopes[3][SPEED]]
    }

    /// The state about the middle of the step just made.
    pub(super) fn middle(&self) -> &[[R; N]] {
        &self.middle
    }
}

/// The armature's decay, its coefficients for one step size, and what else is made once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Armature<R, const N: usize> {
    pub(super) rate: [R; N],
    pub(super) coefficients: Exponential<R, N>,
    pub(super) inverses: Inverses<R, N>,
}

impl<R: Real, const N: usize> Armature<R, N> {
    #[inline(always)]
    pub(super) fn new(model: &Model<R, N>, h: R) -> Self {
        let mut rate = [R::zero(); N];
        if !model.force {
            for l in 0..N {
                rate[l] = model.motors.r[l] / model.motors.l[l];
            }
        }
        Self { rate, coefficients: Exponential::new(&rate, h), inverses: model.motors.inverses() }
    }
}

/// Whether a speed that goes from `first` to `last` (in the direction of motion) may dip below
/// zero in between, `falls` and `rises` its slopes at the two ends times the step: a curve that
/// is bent upwards stays above its two end tangents, and so above where they meet.
#[inline(always)]
pub(super) fn may_dip((first, last): (f64, f64), (falls, rises): (f64, f64)) -> bool {
    // Meet at t: first + falls t = last - rises (1 - t), for falls < 0 < rises.
    let meeting = first * rises - falls * (last - rises);
    (falls < 0.0) & (rises > 0.0) & (meeting < 0.0)
}

/// x + h slope, every lane. Here and below whole rows are passed, so that the compiler knows
/// that they do not overlap.
#[inline(always)]
fn forward<R: Real, const N: usize>(to: &mut [R; N], x: &[R; N], h: R, slope: &[R; N]) {
    for l in 0..N {
        to[l] = x[l] + h * slope[l];
    }
}

/// The same for a decaying state; `slope` becomes x' + lambda at at the stage `at`.
#[inline(always)]
fn decayed<R: Real, const N: usize>(
    to: &mut [R; N],
    x: &[R; N],
    c: &Exponential<R, N>,
    slope: &mut [R; N],
    (lambda, at): (&[R; N], &[R; N]),
) {
    for l in 0..N {
        slope[l] += lambda[l] * at[l];
        to[l] = c.half[l] * x[l] + c.stage[l] * slope[l];
    }
}

/// The last stage of a decaying state, which starts from the middle one.
#[inline(always)]
fn decayed_last<R: Real, const N: usize>(
    to: &mut [R; N],
    middle: &[R; N],
    c: &Exponential<R, N>,
    (first, slope): (&[R; N], &mut [R; N]),
    lambda: &[R; N],
) {
    for l in 0..N {
        slope[l] += lambda[l] * to[l];
        to[l] = c.half[l] * middle[l] + c.stage[l] * (slope[l].scaled(2.0) - first[l]);
    }
}

/// The step of a state from its four slopes.
#[inline(always)]
fn close<R: Real, const N: usize>(x: &mut [R; N], h: R, slopes: [&[R; N]; 4]) {
    let [n0, na, nb, nc] = slopes;
    let (sixth, third) = (h.scaled(1.0 / 6.0), h.scaled(1.0 / 3.0));
    for l in 0..N {
        x[l] += sixth * (n0[l] + nc[l]) + third * (na[l] + nb[l]);
    }
}

/// The step of a decaying state; `last` is the stage at which the last slope was taken.
#[inline(always)]
fn close_decayed<R: Real, const N: usize>(
    x: &mut [R; N],
    c: &Exponential<R, N>,
    slopes: [&[R; N]; 4],
    (lambda, last): (&[R; N], &[R; N]),
) {
    let [n0, na, nb, nc] = slopes;
    for l in 0..N {
        let end = nc[l] + lambda[l] * last[l];
        let outer = c.first[l] * n0[l] + c.last[l] * end;
        x[l] = c.whole[l] * x[l] + outer + c.middle[l] * (na[l] + nb[l]);
    }
}

/// Advances the state `x` by `h` from that time, the inputs held. `armature` was made for the
/// same model and step.
#[inline(always)]
pub(super) fn step<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &mut [[R; N]],
    (applied, start): (&Applied<R, N>, f64),
    sign: &[f64; N],
    h: R,
    armature: &Armature<R, N>,
    room: &mut Stages<R, N>,
) {
    let Stages { slopes, stage, middle, lambda, stiff } = room;
    let [n0, na, nb, nc] = slopes.each_mut().map(|rows| &mut **rows);
    let (stage, middle, lambda) = (&mut **stage, &mut **middle, &mut **lambda);
    let half = h.scaled(0.5);
    let seconds = h.value();
    let fixed = (sign, &armature.inverses);
    let at = |share: f64| start + share * seconds;
    lambda[CURRENT] = armature.rate;
    field_at(model, x, (applied, at(0.0)), fixed, n0, Some(lambda));
    for j in OWN..x.len() {
        if model.is_stiff(j) {
            stiff[j] = Some(Exponential::new(&lambda[j], h));
        }
    }
    let coefficients = |j: usize| match j {
        CURRENT => Some(&armature.coefficients),
        _ => stiff[j].as_ref(),
    };

    for j in 0..x.len() {
        match coefficients(j) {
            None => forward(&mut middle[j], &x[j], half, &n0[j]),
            Some(c) => decayed(&mut middle[j], &x[j], c, &mut n0[j], (&lambda[j], &x[j])),
        }
    }
    field_at(model, middle, (applied, at(0.5)), fixed, na, None);
    for j in 0..x.len() {
        match coefficients(j) {
            None => forward(&mut stage[j], &x[j], half, &na[j]),
            Some(c) => decayed(&mut stage[j], &x[j], c, &mut na[j], (&lambda[j], &middle[j])),
        }
    }
    field_at(model, stage, (applied, at(0.5)), fixed, nb, None);
    for j in 0..x.len() {
        match coefficients(j) {
            None => forward(&mut stage[j], &x[j], h, &nb[j]),
            Some(c) => decayed_last(&mut stage[j], &middle[j], c, (&n0[j], &mut nb[j]), &lambda[j]),
        }
    }
    field_at(model, stage, (applied, at(1.0)), fixed, nc, None);
    for j in 0..x.len() {
        let slopes = [&n0[j], &na[j], &nb[j], &nc[j]];
        match coefficients(j) {
            None => close(&mut x[j], h, slopes),
            Some(c) => close_decayed(&mut x[j], c, slopes, (&lambda[j], &stage[j])),
        }
    }
}

/// Advances a shaft that sticks by the armature's step where nothing but the current moves: what else
/// makes its rate is constant then.
pub(super) fn step_at_rest<R: Real>(
    model: &Model<R, 1>,
    x: &mut [[R; 1]],
    applied: &Applied<R, 1>,
    armature: &Armature<R, 1>,
    room: &mut Stages<R, 1>,
) {
    let slope = &mut *room.slopes[0];
    field_at(model, x, (applied, applied.time), (&[0.0], &armature.inverses), slope, None);
    let (c, i) = (&armature.coefficients, x[CURRENT][0]);
    let steady = slope[CURRENT][0] + armature.rate[0] * i;
    // The weights of the slopes add up to h phi_1.
    let weight = c.first[0] + c.middle[0].scaled(2.0) + c.last[0];
    x[CURRENT] = [c.whole[0] * i + weight * steady];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dip_is_suspected_where_the_end_tangents_meet_below_zero() {
        // 0.1 - t + t^2 has its minimum -0.15 at 0.5, its tangents meet at -0.4.
        assert!(may_dip((0.1, 0.1), (-1.0, 1.0)));
        assert!(!may_dip((0.6, 0.6), (-1.0, 1.0)));
        assert!(!may_dip((0.1, 1.1), (0.5, 1.5)), "rising throughout");
        assert!(!may_dip((1.1, 0.1), (-1.5, -0.5)), "falling throughout");
    }
}
