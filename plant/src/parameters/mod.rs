//! The numbers of a drive by the names under which people, fits and FMUs know them.
//!
//! One list for units, ranges and descriptions, `drive/sections.rs`: the drive file is checked against
//! it, its schema is filled from it, and [`Drive::parameters`] and [`Drive::set`] read it. Effects bring
//! their own list, the registry.

mod range;
mod role;
mod set;
mod spelling;

pub use role::Role;
pub use set::SetError;

pub(crate) use range::{allowed, possible};
pub(crate) use spelling::{meant, nearest};

use crate::drive::{ANY, Drive, EffectData, Field, Input, LawData, fields};
use crate::effects::custom::Target;
use crate::effects::law::Parameter;
use crate::effects::learned::Factor;
use crate::effects::registry::Entry;
use crate::units::for_motion;

/// A number of the drive with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedParameter {
    /// Name: `R`, `coulomb.T_c`, `controller.K_p`, `noise.omega`.
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Its unit for the drive's motion; empty for coefficients of typed laws, whose unit
    /// follows from the law.
    pub unit: String,
    /// Least and greatest value that is physically possible.
    pub range: (f64, f64),
    /// One line for a person.
    pub description: &'static str,
    /// Typical magnitude: that of the value, or where it is zero that of the library.
    pub nominal: f64,
    /// What it is for.
    pub role: Role,
}

/// The registry's entry for a parameter of an effect; none for coefficients of typed laws.
fn registered(effect: &EffectData, name: &str) -> Option<&'static Parameter> {
    Entry::find(&effect.kind)?.parameters.iter().find(|parameter| parameter.name == name)
}

const AT_KNOT: &str = "value of the learned curve at a knot";

impl Drive {
    /// Every number of the drive in one order: motor, effects as the file lists them,
    /// controller, amplifier, generator, sensors, noise. What the drive does not have is absent.
    pub fn parameters(&self) -> Vec<NamedParameter> {
        let of_field = |field: &Field| {
            let value = (field.get)(self)?;
            Some(NamedParameter {
                name: field.name(self.motion),
                value,
                unit: self.unit(field),
                range: field.range,
                description: field.description,
                nominal: magnitude(value, field.nominal),
                role: field.role,
            })
        };
        let (motor, others): (Vec<_>, Vec<_>) = fields().partition(|f| f.section == "motor");
        let mut all: Vec<_> = motor.into_iter().filter_map(of_field).collect();
        for effect in &self.effects {
            all.extend(
                effect.parameters.iter().map(|(name, value)| self.of_effect(effect, name, *value)),
            );
        }
        all.extend(others.into_iter().filter_map(of_field));
        all
    }

    /// The field's unit for this drive: a force-driven one takes u in volts for amperes.
    pub(crate) fn unit(&self, field: &Field) -> String {
        let force =
            self.motor.input == Input::Force && (field.section, field.key) == ("motor", "K_m");
        for_motion(self.motion, if force { "N m/V" } else { field.unit })
    }

    fn of_effect(&self, effect: &EffectData, name: &str, value: f64) -> NamedParameter {
        let known = registered(effect, name);
        let of_file = match effect.law {
            Some(LawData::Learned {
                target: Target::Torque, times: Some(Factor::Current), ..
            }) => ("N m/A", AT_KNOT),
            Some(LawData::Learned { target: Target::Torque, .. }) => ("N m", AT_KNOT),
            Some(LawData::Learned {
                target: Target::Voltage,
                times: Some(Factor::Current),
                ..
            }) => ("Ohm", AT_KNOT),
            Some(LawData::Learned { target: Target::Voltage, .. }) => ("V", AT_KNOT),
            Some(LawData::Learned { .. }) => ("", AT_KNOT),
            Some(LawData::Typed { .. }) | None => ("", "coefficient of the typed law"),
        };
        NamedParameter {
            name: format!("{}.{name}", effect.id),
            value,
            unit: for_motion(self.motion, known.map_or(of_file.0, |p| p.unit)),
            range: known.map_or(ANY, |p| p.range),
            description: known.map_or(of_file.1, |p| p.description),
            nominal: magnitude(value, known.map_or(1.0, |p| p.nominal)),
            role: Role::Physics,
        }
    }

    /// What a fit estimates: the parameters of the balances that the file does not fix. K_m is
    /// none of them where it is tied to K_e, nor in a force-driven drive, of which only ratios
    /// to K_m are identifiable.
    pub fn fitted(&self) -> Vec<NamedParameter> {
        let k_m_follows = self.motor.tie_k || self.motor.input == Input::Force;
        let mut all = self.parameters();
        all.retain(|parameter| {
            parameter.role == Role::Physics
                && !self.fixed.contains(&parameter.name)
                && !(k_m_follows && parameter.name == "K_m")
        });
        all
    }
}

fn magnitude(value: f64, typical: f64) -> f64 {
    if value == 0.0 { typical.abs() } else { value.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::registry::REGISTRY;
    use crate::testing::{DR300, EMPS, drive};

    fn names(all: &[NamedParameter]) -> Vec<&str> {
        all.iter().map(|parameter| parameter.name.as_str()).collect()
    }

    #[test]
    fn names_are_unique_and_in_the_order_of_the_file() {
        let all = drive(DR300).parameters();
        let names = names(&all);
        let expected = ["R", "L", "K_e", "K_m", "J", "B_m", "rated_torque", "coulomb.T_c"];
        assert_eq!(names[..8], expected);
        assert_eq!(
            names[8..13],
            [
                "stribeck.T_b",
                "stribeck.omega_s",
                "controller.K_p",
                "controller.K_i",
                "controller.period"
            ]
        );
        for (k, name) in names.iter().enumerate() {
            assert!(!names[..k].contains(name), "{name} twice");
        }
    }

    /// A search divides by it: of a law that is at zero, or usually negative, too.
    #[test]
    fn the_scale_of_every_parameter_is_above_zero() {
        for entry in REGISTRY {
            let mut drive = drive(DR300);
            let (id, kind) = (entry.info.id.to_owned(), entry.info.id.to_owned());
            let zeros = entry.parameters.iter().map(|it| (it.name.to_owned(), 0.0)).collect();
            drive.effects = vec![EffectData { kind, id, parameters: zeros, law: None }];
            for parameter in drive.parameters() {
                assert!(parameter.nominal > 0.0, "{}: {}", parameter.name, parameter.nominal);
            }
        }
    }

    #[test]
    fn a_linear_drive_has_the_names_and_units_of_its_motion() {
        let all = drive(EMPS).parameters();
        let unit = |name: &str| {
            let found = all.iter().find(|parameter| parameter.name == name);
            found.map(|parameter| parameter.unit.as_str())
        };
        for (name, expected) in [
            ("K_m", "N/V"),
            ("J", "kg"),
            ("B_m", "N s/m"),
            ("coulomb.T_c", "N"),
            ("noise.v", "m/s"),
        ] {
            assert_eq!(unit(name), Some(expected), "{name}");
        }
        assert_eq!((unit("R"), unit("noise.omega")), (None, None));
    }

    #[test]
    fn a_fit_leaves_what_is_fixed_tied_or_not_identifiable() {
        let mut tied = drive(DR300);
        let physics =
            ["R", "L", "K_e", "J", "B_m", "coulomb.T_c", "stribeck.T_b", "stribeck.omega_s"];
        assert_eq!(names(&tied.fitted()), physics);
        tied.fixed = vec!["R".to_owned(), "stribeck.omega_s".to_owned()];
        tied.motor.tie_k = false;
        assert_eq!(
            names(&tied.fitted()),
            ["L", "K_e", "K_m", "J", "B_m", "coulomb.T_c", "stribeck.T_b"]
        );
        let mut force = drive(EMPS);
        force.fixed.clear();
        assert_eq!(names(&force.fitted()), ["J", "B_m", "coulomb.T_c", "constant_load.T_0"]);
    }
}
