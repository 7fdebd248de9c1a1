//! From a drive to its model: over plain numbers for a run, over duals for a fit.

use std::sync::Arc;

use drivescope_numerics::Real;

use super::{Model, Motor, Part};
use crate::drive::{Drive, EffectData, Input, LawData, Motion};
use crate::effects::custom::Law;
use crate::effects::registry::{Entry, Kind};

impl Drive {
    /// The model with the drive's own values.
    ///
    /// # Panics
    /// If the drive was put together by hand without a value that a drive file must have, or with an
    /// effect that none may have (see [`Drive::model_of`]).
    pub fn model(&self) -> Model<f64, 1> {
        self.build(false, |_, _, own| own.expect("the drive file must have it"))
    }

    /// The model whose parameters are what `values` gives for their names (`R`, `coulomb.T_c`).
    /// With `tie_K` the value of `K_e` serves as K_m too, and `K_m` is not asked for.
    ///
    /// # Panics
    /// If an effect's kind is not in the registry, its parameters are not those of its kind, or
    /// its law is wrong: reading the drive file excludes all three.
    pub fn model_of<R: Real>(&self, values: impl Fn(&str) -> R) -> Model<R, 1> {
        self.build(self.motor.tie_k, |effect, key, _| match effect {
            Some(effect) => values(&format!("{}.{key}", effect.id)),
            None => values(key),
        })
    }

    /// `values` gives a number for the effect that it belongs to, none for the motor, its key there and
    /// the drive's own.
    fn build<R: Real>(
        &self,
        tie: bool,
        values: impl Fn(Option<&EffectData>, &str, Option<f64>) -> R,
    ) -> Model<R, 1> {
        let data = &self.motor;
        let force = data.input == Input::Force;
        // A force-driven drive has no armature circuit; its field reads none of these three.
        let electrical = |key, own, without| {
            if force { R::constant(without) } else { values(None, key, own) }
        };
        let k_e = electrical("K_e", data.k_e, 0.0);
        let motor = Motor {
            r: electrical("R", data.r, 1.0),
            l: electrical("L", data.l, 1.0),
            k_e,
            k_m: if tie && !force { k_e } else { values(None, "K_m", Some(data.k_m)) },
            j: values(None, "J", Some(data.j)),
            b_m: values(None, "B_m", Some(data.b_m)),
            friction: R::one(),
        };
        let mut laws = Vec::new();
        let parts: Vec<Part<R>> = self
            .effects
            .iter()
            .map(|effect| Part {
                kind: kind(effect, self.motion, &mut laws),
                parameters: effect
                    .parameters
                    .iter()
                    .map(|(key, own)| values(Some(effect), key, Some(*own)))
                    .collect(),
            })
            .collect();
        Model::new(motor, force, &parts, Arc::from(laws))
    }
}

/// The kind of an effect; a law of the drive file gets the next number.
fn kind(effect: &EffectData, motion: Motion, laws: &mut Vec<Law>) -> Kind {
    let names: Vec<&str> = effect.parameters.iter().map(|(name, _)| name.as_str()).collect();
    let law = match &effect.law {
        None => {
            let entry = Entry::find(&effect.kind).expect("the kind is in the registry");
            assert!(
                entry.parameters.iter().map(|parameter| parameter.name).eq(names),
                "`{}` takes its own parameters in their order",
                effect.kind
            );
            return entry.kind;
        }
        Some(LawData::Typed { .. }) => effect.typed().expect("it is typed"),
        Some(LawData::Learned { target, over, times, knots }) => {
            assert_eq!(knots.len(), names.len(), "`{}` has a value at every knot", effect.id);
            let curve = motion.curve(*over, knots).expect("the knots were read with the file");
            Law::learned(*target, curve.times(*times))
        }
    };
    laws.push(law);
    Kind::Custom(laws.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Drive;
    use crate::model::{Applied, field};
    use crate::testing::{DR300, EMPS, drive};
    use drivescope_numerics::Dual;
    use std::cell::RefCell;

    fn asked(drive: &Drive) -> Vec<String> {
        let names = RefCell::new(Vec::new());
        drive.model_of(|name| {
            names.borrow_mut().push(name.to_owned());
            1.0
        });
        names.into_inner()
    }

    #[test]
    fn a_model_has_the_values_of_the_drive() {
        let model = drive(DR300).model();
        let motor = model.motors.lane(0);
        assert_eq!((motor.r, motor.l, motor.k_e), (3.13, 5e-3, 0.0599));
        // tie_K is for fits: a run takes the file's own K_m.
        assert_eq!((motor.k_m, motor.j, motor.b_m, motor.friction), (0.06, 8.2e-5, 6e-5, 1.0));
        assert_eq!(model.clone().parameters_mut(), &[[0.016], [0.008], [5.0]]);
        assert!(model.dry() && !model.force);
    }

    #[test]
    fn only_the_names_of_the_drive_are_asked_for() {
        let tied = ["K_e", "R", "L", "J", "B_m", "coulomb.T_c", "stribeck.T_b", "stribeck.omega_s"];
        assert_eq!(asked(&drive(DR300)), tied);
        assert_eq!(asked(&drive(EMPS)), ["K_m", "J", "B_m", "coulomb.T_c", "constant_load.T_0"]);
    }

    /// Two laws of one kind, one of them typed: each takes its own coefficients, and the
    /// derivative with respect to them is exact.
    #[test]
    fn typed_laws_keep_their_coefficients_apart() {
        let first =
            "\n[[effect]]\nkind = \"custom\"\ntorque = \"a * omega\"\nparameters = { a = 1 }";
        let second = "\n[[effect]]\nkind = \"custom\"\nid = \"second\"\ntorque = \"b - a\"\n\
                      parameters = { b = 1, a = 1 }\n";
        let drive = drive(&EMPS.replace("[fit]", &format!("{first}{second}[fit]")));
        let model = drive.model_of(|name| match name {
            "custom.a" => Dual::<3>::parameter(2.0, 0),
            "second.a" => Dual::parameter(5.0, 1),
            "second.b" => Dual::parameter(7.0, 2),
            "J" => Dual::constant(1.0),
            _ => Dual::constant(0.0),
        });
        let zero = Dual::constant(0.0);
        let applied = Applied { u: [zero], load: [zero], time: 0.0 };
        let x = [[zero], [Dual::constant(3.0)], [zero]];
        let mut rates = [[zero]; 3];
        field(&model, &x, &applied, &[1.0], &mut rates, None);
        // J domega/dt = a omega + (b - a').
        assert_eq!((rates[1][0].v, rates[1][0].d), (8.0, [3.0, -1.0, 1.0]));
    }
}
