//! One exponential Runge-Kutta step of order four, over lanes, for a given sign of the motion.

use drivescope_numerics::Real;

use super::exponential::Exponential;
use crate::model::{Applied, CURRENT, Model, OWN, SPEED, field};

/// Room for the stages of a step; allocated once, reused by every step.
#[derive(Debug, Clone)]
pub(super) struct Stages<R, const N: usize> {
    /// Slopes N(x) = x' + lambda x at the start, twice in the middle and at the end.
    slopes: [Vec<[R; N]>; 4],
    /// State at a stage, and the middle stage that the last one starts from.
    stage: Vec<[R; N]>,
    middle: Vec<[R; N]>,
    lambda: Vec<[R; N]>,
    /// Coefficients of the stiff own states, made anew at each step.
    stiff: Vec<Option<Exponential<R, N>>>,
}

impl<R: Real, const N: usize> Stages<R, N> {
    pub(super) fn new(states: usize) -> Self {
        let zero = vec![[R::zero(); N]; states];
        Self {
            slopes: [zero.clone(), zero.clone(), zero.clone(), zero.clone()],
            stage: zero.clone(),
            middle: zero.clone(),
            lambda: zero,
            stiff: vec![None; states],
        }
    }

    /// Whether the speed of lane `l` may have dipped below zero inside the step just made over
    /// `h`, from `first` to `last` (speeds in the direction of motion): a curve that is bent
    /// upwards stays above its two end tangents, and so above where they meet.
    #[inline(always)]
    pub(super) fn may_dip(&self, l: usize, sign: f64, (first, last): (f64, f64), h: f64) -> bool {
        let falls = sign * self.slopes[0][SPEED][l].value() * h;
        let rises = sign * self.slopes[3][SPEED][l].value() * h;
        // Meet at t: first + falls t = last - rises (1 - t), for falls < 0 < rises.
        let meeting = first * rises - falls * (last - rises);
        (falls < 0.0) & (rises > 0.0) & (meeting < 0.0)
    }

    /// The state about the middle of the step just made.
    pub(super) fn middle(&self) -> &[[R; N]] {
        &self.middle
    }
}

/// The armature's decay and its coefficients for one step size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Armature<R, const N: usize> {
    rate: [R; N],
    coefficients: Exponential<R, N>,
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
        Self { rate, coefficients: Exponential::new(&rate, h) }
    }
}

/// Advances the state `x` by `h`. `armature` was made for the same model and step.
#[inline(always)]
pub(super) fn step<R: Real, const N: usize>(
    model: &Model<R, N>,
    x: &mut [[R; N]],
    applied: &Applied<R, N>,
    sign: &[f64; N],
    h: R,
    armature: &Armature<R, N>,
    room: &mut Stages<R, N>,
) {
    let Stages { slopes: [n0, na, nb, nc], stage, middle, lambda, stiff } = room;
    let half = h.scaled(0.5);
    let seconds = h.value();
    let at = |share: f64| Applied { time: applied.time + share * seconds, ..*applied };
    lambda[CURRENT] = armature.rate;
    field(model, x, applied, sign, n0, Some(lambda));
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
            None => (0..N).for_each(|l| middle[j][l] = x[j][l] + half * n0[j][l]),
            Some(c) => {
                for l in 0..N {
                    n0[j][l] += lambda[j][l] * x[j][l];
                    middle[j][l] = c.half[l] * x[j][l] + c.stage[l] * n0[j][l];
                }
            }
        }
    }
    field(model, middle, &at(0.5), sign, na, None);
    for j in 0..x.len() {
        match coefficients(j) {
            None => (0..N).for_each(|l| stage[j][l] = x[j][l] + half * na[j][l]),
            Some(c) => {
                for l in 0..N {
                    na[j][l] += lambda[j][l] * middle[j][l];
                    stage[j][l] = c.half[l] * x[j][l] + c.stage[l] * na[j][l];
                }
            }
        }
    }
    field(model, stage, &at(0.5), sign, nb, None);
    for j in 0..x.len() {
        match coefficients(j) {
            None => (0..N).for_each(|l| stage[j][l] = x[j][l] + h * nb[j][l]),
            Some(c) => {
                for l in 0..N {
                    nb[j][l] += lambda[j][l] * stage[j][l];
                    let slope = nb[j][l].scaled(2.0) - n0[j][l];
                    stage[j][l] = c.half[l] * middle[j][l] + c.stage[l] * slope;
                }
            }
        }
    }
    field(model, stage, &at(1.0), sign, nc, None);
    let sixth = h.scaled(1.0 / 6.0);
    let third = h.scaled(1.0 / 3.0);
    for j in 0..x.len() {
        match coefficients(j) {
            None => {
                for l in 0..N {
                    let inner = third * (na[j][l] + nb[j][l]);
                    x[j][l] += sixth * (n0[j][l] + nc[j][l]) + inner;
                }
            }
            Some(c) => {
                for l in 0..N {
                    nc[j][l] += lambda[j][l] * stage[j][l];
                    let inner = c.middle[l] * (na[j][l] + nb[j][l]);
                    let outer = c.first[l] * n0[j][l] + c.last[l] * nc[j][l];
                    x[j][l] = c.whole[l] * x[j][l] + outer + inner;
                }
            }
        }
    }
}
