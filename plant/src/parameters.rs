//! The numbers of a drive by the names under which people, fits and FMUs know them.
//!
//! One list for units, ranges and descriptions, `drive/sections.rs`: the drive file is checked against
//! it, its schema is filled from it, and [`Drive::parameters`] and [`Drive::set`] read it. Effects bring
//! their own list, the registry.

use thiserror::Error;

use crate::drive::{ANY, Drive, EffectData, Field, Input, LawData, fields};
use crate::effects::custom::Target;
use crate::effects::law::Parameter;
use crate::effects::learned::Factor;
use crate::effects::registry::Entry;
use crate::units::for_motion;

/// What a number of the drive is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// It enters the balances: what a fit estimates.
    Physics,
    /// Controller, amplifier or generator: set by people, not estimated.
    Control,
    /// Resolution or noise of a sensor, or a disturbance.
    Sensing,
    /// A figure of the rating plate, a scale only.
    Rating,
}

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

/// Why a value cannot be set.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs)] // A field is named for what its message says of it.
pub enum SetError {
    /// The drive has no parameter of that name.
    #[error("the drive has no parameter `{name}`{}; it has {known}", meant(.nearest))]
    Unknown {
        name: String,
        /// A name of the drive that is spelt alike.
        nearest: Option<String>,
        /// The names there are.
        known: String,
    },
    /// The value is not physically possible.
    #[error("`{name}` = {value} is outside what is possible: give {allowed}")]
    OutOfRange {
        name: String,
        value: f64,
        /// What is possible, in words, with the unit.
        allowed: String,
    },
}

/// The question after an unknown name.
pub(crate) fn meant(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

/// The known name that is spelt most like the given one, if one is near.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    // A third of the letters may be wrong, and R and r are the same slip of a key.
    let most = (name.chars().count() / 3).max(1);
    let lower = name.to_lowercase();
    let distance = |other: &str| strsim::damerau_levenshtein(&lower, &other.to_lowercase());
    known
        .map(|other| (distance(other), other))
        .filter(|(d, _)| *d <= most)
        .min()
        .map(|(_, other)| other.to_owned())
}

/// Whether a value is finite and within the range.
pub(crate) fn possible(value: f64, (low, high): (f64, f64)) -> bool {
    value.is_finite() && low <= value && value <= high
}

/// A range in words, with the unit.
pub(crate) fn allowed((low, high): (f64, f64), unit: &str) -> String {
    let number = match (low, high) {
        (f64::NEG_INFINITY, f64::INFINITY) => "a finite number".to_owned(),
        (f64::MIN_POSITIVE, f64::INFINITY) => "a finite number above 0".to_owned(),
        (low, f64::INFINITY) => format!("a finite number of {low} or more"),
        (low, high) => format!("a number from {low} to {high}"),
    };
    if unit.is_empty() || unit == "1" { number } else { format!("{number} ({unit})") }
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

    /// Sets a parameter by its name, SI.
    ///
    /// # Errors
    /// [`SetError`] if the drive has no such parameter or the value is not possible; the drive
    /// is then unchanged.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), SetError> {
        let all = self.parameters();
        let Some(parameter) = all.iter().find(|parameter| parameter.name == name) else {
            let names: Vec<&str> = all.iter().map(|parameter| parameter.name.as_str()).collect();
            let nearest = nearest(name, names.iter().copied());
            return Err(SetError::Unknown {
                name: name.to_owned(),
                nearest,
                known: names.join(", "),
            });
        };
        if !possible(value, parameter.range) {
            let allowed = allowed(parameter.range, &parameter.unit);
            return Err(SetError::OutOfRange { name: name.to_owned(), value, allowed });
        }
        if let Some(slot) = self.slot(name) {
            *slot = value;
        }
        Ok(())
    }

    fn slot(&mut self, name: &str) -> Option<&mut f64> {
        if let Some(field) = fields().find(|field| field.name(self.motion) == name) {
            return (field.slot)(self);
        }
        let (id, key) = name.split_once('.')?;
        let effect = self.effects.iter_mut().find(|effect| effect.id == id)?;
        effect.parameters.iter_mut().find(|(k, _)| k == key).map(|(_, value)| value)
    }
}

fn magnitude(value: f64, typical: f64) -> f64 {
    if value == 0.0 { typical.abs() } else { value.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::registry::REGISTRY;

    const DR300: &str = include_str!("../../scenarios/drives/dr300.toml");
    const EMPS: &str = include_str!("../../scenarios/drives/emps.toml");

    fn drive(text: &str) -> Drive {
        Drive::parse(text, "shipped.toml").expect("a right drive file")
    }

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

    /// Each place is read back under its own name: no two rows of the list are swapped.
    #[test]
    fn every_parameter_can_be_set_and_changes_alone() {
        let mut drive = drive(DR300);
        drive.generator =
            Some(crate::drive::GeneratorData { k_m: 0.06, gain: 0.2, limit: Some(2.0) });
        let before = drive.parameters();
        for (k, parameter) in before.iter().enumerate() {
            let mut changed = drive.clone();
            let value = parameter.value + 0.5;
            assert_eq!(changed.set(&parameter.name, value), Ok(()), "{}", parameter.name);
            for (j, now) in changed.parameters().iter().enumerate() {
                let expected = if j == k { value } else { before[j].value };
                assert_eq!(now.value, expected, "{} after {}", now.name, parameter.name);
            }
        }
        assert_eq!(before.len(), fields().count() + 3, "the three parameters of its effects");
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
    fn what_cannot_be_set_is_refused() {
        let mut drive = drive(DR300);
        let before = drive.clone();
        let shown = drive.set("coulomb.t_c", 1.0).expect_err("no such name").to_string();
        assert!(
            shown.starts_with(
                "the drive has no parameter `coulomb.t_c` (did you mean `coulomb.T_c`?)"
            )
        );
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let shown = drive.set("J", value).expect_err("not possible").to_string();
            assert!(shown.ends_with("give a finite number above 0 (kg m^2)"), "{shown}");
        }
        assert!(drive.set("generator.gain", 1.0).is_err(), "DR300 uses no generator");
        assert_eq!(drive, before);
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

    #[test]
    fn a_slip_of_a_key_finds_its_name() {
        let known = ["R", "K_e", "K_m", "coulomb"];
        let found = |name| nearest(name, known.into_iter());
        assert_eq!(found("r").as_deref(), Some("R"));
        assert_eq!(found("Coulmob").as_deref(), Some("coulomb"));
        assert_eq!(found("k_M").as_deref(), Some("K_m"));
        assert_eq!(found("viscous"), None);
    }
}
