//! What the laws of a drive take from its balances, and which of their parameters enter linearly.
//!
//! The torque balance J domega/dt + B_m omega + brake = K_m i - T_l, the voltage balance
//! L di/dt + R i + K_e omega + drop = u: brake and drop are what the model's own right-hand side
//! leaves of them. A parameter enters linearly if the difference that it makes is proportional to
//! it, which is tried. Effects with states of their own are left out there; of a drive as it is
//! ([`Laws::of_drive`]) a load that moves by itself follows the motion that was measured.

use drivescope_plant::drive::{Drive, EffectData, Input};
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::model::{self, Along, Applied, CURRENT, Model, SPEED, field};
use drivescope_plant::parameters::NamedParameter;

/// What the motor's own balances are made of.
pub(super) const OWN: [&str; 6] = ["R", "L", "K_e", "K_m", "J", "B_m"];
/// Departure from proportionality, relative to the share, that is rounding.
const ROUNDING: f64 = 1e-6;
/// Share of the largest torque (voltage) of the motor that is a share at all, and no rounding.
const LEAST: f64 = 1e-9;

/// A point at which laws are looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Current, A; of a force-driven drive what drives it.
    pub(super) current: f64,
    pub(super) speed: f64,
    pub(super) angle: f64,
    pub(super) time: f64,
}

/// The laws at given values.
pub(super) struct Laws {
    model: Model<f64, 1>,
    drive: Drive,
}

impl Laws {
    /// Of a drive without its effects that have states of their own.
    pub(super) fn new(drive: &Drive) -> Self {
        Self { model: without_states(drive).model(), drive: drive.clone() }
    }

    /// Of a drive with what follows a motion ([`along_motion`]).
    pub(super) fn of_drive(drive: &Drive) -> Self {
        Self { model: along_motion(drive).model(), drive: drive.clone() }
    }

    /// Brake, N m (N), and drop, V; own states at rest.
    pub(super) fn at(&self, point: &Point) -> [f64; 2] {
        let motor = &self.drive.motor;
        let mut x = vec![[0.0]; self.model.states()];
        x[..model::OWN].copy_from_slice(&self.motion(point).map(|value| [value]));
        let mut rates = x.clone();
        let applied = self.applied(point);
        field(&self.model, &x, &applied, &[sign(point)], &mut rates, None);
        let brake = self.brake(point, motor.j * rates[SPEED][0]);
        let [r, l, k_e] = [motor.r, motor.l, motor.k_e].map(|value| value.unwrap_or(0.0));
        let drop = applied.u[0] - r * point.current - k_e * point.speed - l * rates[CURRENT][0];
        [brake, if motor.input == Input::Force { 0.0 } else { drop }]
    }

    /// Brake at points that are so far apart, s, one after the other, and the inertia of the shaft.
    pub(super) fn along(&self, points: &[Point], period_s: f64) -> (Vec<f64>, f64) {
        if self.model.states() == model::OWN {
            return (points.iter().map(|point| self.at(point)[0]).collect(), self.drive.motor.j);
        }
        let mut along = Along::new(self.model.clone(), period_s);
        let mut inertia = self.drive.motor.j;
        let next = points.iter().skip(1).chain(points.last());
        let brake = points.iter().zip(next).map(|(point, next)| {
            let (applied, sign) = (self.applied(point), sign(point));
            let both = [point, next].map(|point| self.motion(point));
            let [torque, of_shaft] = along.balance(&applied, sign, both[0]);
            along.advance(&applied, sign, both);
            inertia = of_shaft;
            self.brake(point, torque)
        });
        (brake.collect(), inertia)
    }

    fn motion(&self, point: &Point) -> [f64; model::OWN] {
        [point.current, point.speed, point.angle]
    }

    fn applied(&self, point: &Point) -> Applied<f64, 1> {
        let force = self.drive.motor.input == Input::Force;
        let u = if force { point.current } else { 0.0 };
        Applied { u: [u], load: [0.0], time: point.time }
    }

    /// What the drive's own laws take where its shaft is left with so much torque.
    fn brake(&self, point: &Point, torque: f64) -> f64 {
        let motor = &self.drive.motor;
        motor.k_m * point.current - motor.b_m * point.speed - torque
    }
}

fn sign(point: &Point) -> f64 {
    if point.speed < 0.0 { -1.0 } else { 1.0 }
}

/// The drive without the effects of which a motion that was measured does not tell the states: a load
/// that moves by itself follows it.
pub(super) fn along_motion(drive: &Drive) -> Drive {
    without(drive, |effect| Entry::find(&effect.kind).is_some_and(Entry::has_load))
}

/// The drive without the effects that have states of their own.
pub(super) fn without_states(drive: &Drive) -> Drive {
    without(drive, |_| false)
}

/// The same but for those that are `kept`.
fn without(drive: &Drive, kept: impl Fn(&EffectData) -> bool) -> Drive {
    let mut plain = drive.clone();
    plain.controller = None;
    let mut k = 0;
    while k < plain.effects.len() {
        let states = plain.model().states();
        let mut without = plain.clone();
        let effect = without.effects.remove(k);
        if without.model().states() < states && !kept(&effect) { plain = without } else { k += 1 }
    }
    plain
}

/// Parameters of effects that enter one balance linearly, the drive with them at zero, and those
/// that are left.
pub(super) struct Linear {
    /// Of the torque balance and of the voltage balance.
    pub(super) of: [Vec<NamedParameter>; 2],
    /// Parameters of effects that enter in another way.
    pub(super) others: Vec<NamedParameter>,
    /// The drive with the linear ones at zero.
    pub(super) zero: Drive,
}

impl Linear {
    pub(super) fn of(drive: &Drive, points: &[Point]) -> Self {
        let mut parameters = drive.fitted();
        parameters.retain(|it| !OWN.contains(&it.name.as_str()));
        let mut zero = drive.clone();
        parameters.retain(|it| {
            let may_be_zero = it.range.0 <= 0.0 && it.range.1 >= 0.0;
            may_be_zero && zero.set(&it.name, 0.0).is_ok()
        });
        let mut of = [Vec::new(), Vec::new()];
        for parameter in &parameters {
            if let Some(balance) = balance(&zero, parameter, points) {
                of[balance].push(parameter.clone());
            }
        }
        let named = |of: &[Vec<NamedParameter>; 2], it: &NamedParameter| {
            of.iter().flatten().any(|other| other.name == it.name)
        };
        // What is not linear after all keeps its value; beside that others may be, which do nothing
        // where it is zero.
        parameters.retain(|it| !named(&of, it));
        for parameter in &parameters {
            let _ = zero.set(&parameter.name, parameter.value);
        }
        for parameter in &parameters {
            let mut without = zero.clone();
            if without.set(&parameter.name, 0.0).is_ok()
                && let Some(balance) = balance(&without, parameter, points)
            {
                of[balance].push(parameter.clone());
                zero = without;
            }
        }
        let mut others = drive.fitted();
        others.retain(|it| !OWN.contains(&it.name.as_str()) && !named(&of, it));
        Self { of, others, zero }
    }
}

/// The balance that a parameter enters linearly: 0 the torque's, 1 the voltage's.
fn balance(zero: &Drive, parameter: &NamedParameter, points: &[Point]) -> Option<usize> {
    let with = |value: f64| {
        let mut drive = zero.clone();
        drive.set(&parameter.name, value).ok().map(|()| Laws::new(&drive))
    };
    let nominal = parameter.nominal;
    let [none, once, twice] = [Some(Laws::new(zero)), with(nominal), with(2.0 * nominal)];
    let (none, once, twice) = (none?, once?, twice?);
    let (mut largest, mut bent) = ([0.0_f64; 2], [0.0_f64; 2]);
    for point in points {
        let [none, once, twice] = [&none, &once, &twice].map(|laws| laws.at(point));
        for it in 0..2 {
            largest[it] = largest[it].max((once[it] - none[it]).abs());
            bent[it] = bent[it].max((twice[it] - 2.0 * once[it] + none[it]).abs());
        }
    }
    let motor = &zero.motor;
    let current = points.iter().map(|point| point.current.abs()).fold(0.0, f64::max);
    let of_motor = [motor.k_m, motor.r.unwrap_or(0.0)].map(|factor| factor * current);
    let matters = |it: usize| largest[it] > LEAST * of_motor[it];
    let linear = |it: usize| bent[it] <= ROUNDING * largest[it];
    match [matters(0), matters(1)] {
        [true, false] if linear(0) => Some(0),
        [false, true] if linear(1) => Some(1),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::dr300;
    use drivescope_plant::drive::EffectData;

    fn points() -> Vec<Point> {
        let point = |k: i32| {
            let t = f64::from(k);
            Point { current: t.sin(), speed: 50.0 * (0.7 * t).cos(), angle: 0.3 * t, time: t }
        };
        (0..20).map(point).collect()
    }

    fn with(kind: &str, values: &[(&str, f64)]) -> Drive {
        let mut drive = dr300();
        let parameters = values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        let (kind, id) = (kind.to_owned(), kind.to_owned());
        drive.effects.push(EffectData { kind, id, parameters, law: None });
        drive
    }

    #[test]
    fn linear_parameters_are_told_from_others() {
        let names =
            |all: &[NamedParameter]| all.iter().map(|it| it.name.clone()).collect::<Vec<_>>();
        let found = Linear::of(&dr300(), &points());
        assert_eq!(names(&found.of[0]), ["coulomb.T_c", "stribeck.T_b"]);
        assert!(found.of[1].is_empty());
        assert_eq!(names(&found.others), ["stribeck.omega_s"]);
        let drag = Linear::of(&with("quadratic_drag", &[("c", 1e-6)]), &points());
        assert!(names(&drag.of[0]).contains(&"quadratic_drag.c".to_owned()));
        // Where N is zero, b does nothing.
        let ripple =
            Linear::of(&with("cogging", &[("N", 7.0), ("a", 1e-3), ("b", 1e-3)]), &points());
        assert!(
            ["cogging.a", "cogging.b"]
                .iter()
                .all(|it| names(&ripple.of[0]).contains(&(*it).to_owned()))
        );
        assert!(names(&ripple.others).contains(&"cogging.N".to_owned()));
        let at = Point { current: 0.0, speed: -10.0, angle: 0.0, time: 0.0 };
        let [brake, drop] = Laws::new(&with("quadratic_drag", &[("c", 1e-6)])).at(&at);
        let dry = 0.016 + 0.008 * (-4.0_f64).exp();
        assert!((brake + 1e-4 + dry).abs() < 1e-9 && drop.abs() < 1e-12, "{brake} {drop}");
    }

    #[test]
    fn effects_with_states_are_left_out() {
        let drive = with("winding_heating", &[("alpha", 0.0039), ("R_th", 1.0), ("C_th", 10.0)]);
        assert_eq!(without_states(&drive).effects.len(), dr300().effects.len());
        assert_eq!(without_states(&dr300()).effects, dr300().effects);
    }
}
