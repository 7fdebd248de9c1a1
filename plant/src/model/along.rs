//! A drive along a motion that is known, whatever moves it: the torque of its balance, and own states
//! that follow the motion.

use drivescope_numerics::Real;

use super::field::field_along;
use super::{Applied, Model, OWN, SPEED};
use crate::effects::law::Beside;

/// The masses behind a joint turn by so much of a radian a step at most.
const RADIANS_A_STEP: f64 = 0.5;
/// Steps from one point to the next at most: what is faster is not told from what is rigid.
const MOST_STEPS: usize = 16;

/// How long a rate acts within a period, s, on a state that decays with it.
pub fn acting(decay: f64, period_s: f64) -> f64 {
    if decay * period_s < 1e-9 { period_s } else { (1.0 - (-decay * period_s).exp()) / decay }
}

/// A drive without a controller along a motion: points that are so far apart, one after the other.
#[derive(Debug, Clone)]
pub struct Along<R> {
    model: Model<R, 1>,
    x: Vec<[R; 1]>,
    rate: Vec<[R; 1]>,
    decay: Vec<[R; 1]>,
    period_s: f64,
    steps: usize,
}

impl<R: Real> Along<R> {
    /// At rest; points are so far apart, s.
    pub fn new(model: Model<R, 1>, period_s: f64) -> Self {
        let zero = vec![[R::zero()]; model.states()];
        let steps = if model.has(Beside::LoadSpeed) {
            (period_s * model.fastest(0, 0.0) / RADIANS_A_STEP).ceil()
        } else {
            1.0
        };
        // Not a number is the most too.
        let steps = if steps <= MOST_STEPS as f64 { steps.max(1.0) as usize } else { MOST_STEPS };
        let (x, rate, decay) = (zero.clone(), zero.clone(), zero);
        Self { model, x, rate, decay, period_s, steps }
    }

    /// Own states at rest.
    pub fn begin(&mut self) {
        self.x.fill([R::zero()]);
    }

    /// Torque (force) that the drive itself gives its shaft at a point, and the inertia of the shaft:
    /// that times the acceleration less the torque is what acts besides. `motion` is current, speed and
    /// position; of a force-driven drive u drives.
    pub fn balance(&mut self, applied: &Applied<R, 1>, sign: f64, motion: [R; OWN]) -> [R; 2] {
        let inertia = self.rates(applied, sign, motion, R::zero());
        [self.rate[SPEED][0] * inertia, inertia]
    }

    /// The own states go on to the next point.
    pub fn advance(&mut self, applied: &Applied<R, 1>, sign: f64, [from, to]: [[R; OWN]; 2]) {
        if self.x.len() == OWN {
            return;
        }
        let h = 0.5 * self.period_s / self.steps as f64;
        let acceleration = (to[SPEED] - from[SPEED]).scaled(1.0 / self.period_s);
        for step in 0..self.steps {
            let part = (step as f64 + 0.5) / self.steps as f64;
            let mut motion = from;
            for (value, to) in motion.iter_mut().zip(to) {
                *value += (to - *value).scaled(part);
            }
            // Each state with what the others have become, half a step in one order and half in the
            // other: what swings keeps its phase and its energy.
            for place in (OWN..self.x.len()).rev().chain(OWN..self.x.len()) {
                self.rates(applied, sign, motion, acceleration);
                let acts = acting(self.decay[place][0].value(), h);
                self.x[place][0] += self.rate[place][0].scaled(acts);
            }
        }
    }

    fn rates(
        &mut self,
        applied: &Applied<R, 1>,
        sign: f64,
        motion: [R; OWN],
        acceleration: R,
    ) -> R {
        for (own, value) in self.x.iter_mut().zip(motion) {
            *own = [value];
        }
        self.decay.fill([R::zero()]);
        let Self { model, x, rate, decay, .. } = self;
        let [inertia] = field_along(model, x, (applied, &[acceleration]), &[sign], rate, decay);
        inertia
    }
}

#[cfg(test)]
mod tests {
    use super::super::field;
    use super::*;
    use crate::drive::{Drive, EffectData};
    use crate::testing::{EMPS, drive};
    use std::f64::consts::TAU;

    fn with_load(ratio: f64, k: f64, d: f64) -> Drive {
        let mut drive = drive(EMPS);
        let parameters = [("k", k), ("d", d), ("ratio", ratio)];
        let parameters = parameters.map(|(name, value)| (name.to_owned(), value)).to_vec();
        let kind = "flexible_coupling".to_owned();
        drive.effects = vec![EffectData { id: kind.clone(), kind, parameters, law: None }];
        drive
    }

    /// Against the transfer function of the load: T_k = -J_l w^2 theta (k + i w d) / (k - J_l w^2 + i w d).
    #[test]
    fn a_load_on_a_spring_follows_a_swinging_shaft() {
        let (ratio, hz, w, period_s) = (0.4, 10.0, TAU * 4.0, 2e-3);
        let j = drive(EMPS).motor.j;
        let k = ratio * j * (TAU * hz).powi(2);
        let d = 0.1 * k / (TAU * hz);
        let drive = with_load(ratio, k, d);
        let mut along = Along::new(drive.model(), period_s);
        let at = |t: f64| [0.0, w * (w * t).cos(), (w * t).sin()];
        let applied = |t| Applied { u: [0.0], load: [0.0], time: t };
        let (m, own) = (ratio * j * w * w, drive.motor.b_m);
        // (a + i b) / (c + i b)
        let (a, b, c) = (k, w * d, k - m);
        let square = c * c + b * b;
        let (real, imaginary) = ((a * c + b * b) / square, (b * c - a * b) / square);
        let mut worst: f64 = 0.0;
        for step in 0..2000 {
            let t = f64::from(step) * period_s;
            let [torque, inertia] = along.balance(&applied(t), 1.0, at(t));
            along.advance(&applied(t), 1.0, [at(t), at(t + period_s)]);
            assert!((inertia / ((1.0 - ratio) * j) - 1.0).abs() < 1e-12);
            // Phase of the load's part: theta is the imaginary part of exp(i w t).
            let (sin, cos) = (w * t).sin_cos();
            let joint = -m * (real * sin + imaginary * cos);
            if step > 1000 {
                worst = worst.max((torque + own * w * cos + joint).abs());
            }
        }
        assert!(worst < 0.02 * m, "{worst} of {m}");
    }

    #[test]
    fn without_own_states_the_torque_is_that_of_the_field() {
        let drive = drive(EMPS);
        let model = drive.model();
        let mut along = Along::new(model.clone(), 1e-3);
        let applied = Applied { u: [1.5], load: [0.0], time: 0.0 };
        let mut rate = vec![[0.0]; model.states()];
        field(&model, &[[0.0], [0.2], [0.1]], &applied, &[1.0], &mut rate, None);
        let [torque, inertia] = along.balance(&applied, 1.0, [0.0, 0.2, 0.1]);
        assert_eq!((torque / inertia, inertia), (rate[SPEED][0], drive.motor.j));
    }
}
