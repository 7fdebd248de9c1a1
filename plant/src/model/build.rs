//! From a drive to its model: over plain numbers for a run, over duals for a fit.

use std::sync::Arc;

use drivescope_numerics::Real;

use super::{Model, Motor, Part};
use crate::drive::{Drive, EffectData, Input};
use crate::effects::custom::Law;
use crate::effects::registry::{Entry, Kind};

impl Drive {
    /// The model with the drive's own values.
    ///
    /// # Panics
    /// If the drive was put together by hand with an effect that no drive file may have (see
    /// [`Drive::model_of`]).
    pub fn model(&self) -> Model<f64, 1> {
        let all = self.parameters();
        self.build(false, |name| {
            let of_that_name = all.iter().find(|parameter| parameter.name == name);
            of_that_name.expect("built from its own names").value
        })
    }

    /// The model whose parameters are what `values` gives for their names (`R`, `coulomb.T_c`).
    /// With `tie_K` the value of `K_e` serves as K_m too, and `K_m` is not asked for.
    ///
    /// # Panics
    /// If an effect's kind is not in the registry, its parameters are not those of its kind, or
    /// its law cannot be parsed: reading the drive file excludes all three.
    pub fn model_of<R: Real>(&self, values: impl Fn(&str) -> R) -> Model<R, 1> {
        self.build(self.motor.tie_k, values)
    }

    fn build<R: Real>(&self, tie: bool, values: impl Fn(&str) -> R) -> Model<R, 1> {
        let force = self.motor.input == Input::Force;
        // A force-driven drive has no armature circuit; its field reads none of these three.
        let electrical = |name, without| if force { R::constant(without) } else { values(name) };
        let k_e = electrical("K_e", 0.0);
        let motor = Motor {
            r: electrical("R", 1.0),
            l: electrical("L", 1.0),
            k_e,
            k_m: if tie && !force { k_e } else { values("K_m") },
            j: values("J"),
            b_m: values("B_m"),
            friction: R::one(),
        };
        let mut laws = Vec::new();
        let parts: Vec<Part<R>> = self
            .effects
            .iter()
            .map(|effect| Part {
                kind: kind(effect, &mut laws),
                parameters: effect
                    .parameters
                    .iter()
                    .map(|(name, _)| values(&format!("{}.{name}", effect.id)))
                    .collect(),
            })
            .collect();
        Model::new(motor, force, &parts, Arc::from(laws))
    }
}

/// The kind of an effect; a typed law is parsed and gets the next number.
fn kind(effect: &EffectData, laws: &mut Vec<Law>) -> Kind {
    let names: Vec<&str> = effect.parameters.iter().map(|(name, _)| name.as_str()).collect();
    let Some((target, text)) = &effect.law else {
        let entry = Entry::find(&effect.kind).expect("the kind is in the registry");
        assert!(
            entry.parameters.iter().map(|parameter| parameter.name).eq(names),
            "`{}` takes its own parameters in their order",
            effect.kind
        );
        return entry.kind;
    };
    let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
    laws.push(Law::parse(*target, text, &names).expect("the law was parsed with the drive file"));
    Kind::Custom(laws.len() - 1)
}
