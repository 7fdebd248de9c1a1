//! The numbers of a drive by the names under which people, fits and FMUs know them.
//!
//! One list for units, ranges and descriptions: the drive file is checked against it, its schema
//! is filled from it, and [`Drive::parameters`] and [`Drive::set`] read it. Effects bring their
//! own list, the registry.

mod fields;

use thiserror::Error;

use crate::drive::{Drive, EffectData, Input};
use crate::effects::law::Parameter;
use crate::effects::registry::Entry;
use crate::units::for_motion;

pub(crate) use fields::{FIELDS, Field};

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
pub enum SetError {
    /// The drive has no parameter of that name.
    #[error("the drive has no parameter `{name}`{}; it has {known}", meant(.nearest))]
    Unknown {
        /// The name.
        name: String,
        /// A name of the drive that is spelt alike.
        nearest: Option<String>,
        /// The names there are.
        known: String,
    },
    /// The value is not physically possible.
    #[error("`{name}` = {value} is outside what is possible: give {allowed}")]
    OutOfRange {
        /// The name.
        name: String,
        /// The value.
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

impl Drive {
    /// Every number of the drive in one order: motor, effects as the file lists them,
    /// controller, amplifier, generator, sensors, noise. What the drive does not have is absent.
    pub fn parameters(&self) -> Vec<NamedParameter> {
        let of_field = |field: &&Field| {
            let value = (field.get)(self)?;
            Some(NamedParameter {
                name: field.name(),
                value,
                unit: self.unit(field),
                range: field.range,
                description: field.description,
                nominal: magnitude(value, field.nominal),
                role: field.role,
            })
        };
        let (motor, rest): (Vec<_>, Vec<_>) = FIELDS.iter().partition(|f| f.section == "motor");
        let mut all: Vec<_> = motor.iter().filter_map(of_field).collect();
        for effect in &self.effects {
            all.extend(
                effect.parameters.iter().map(|(name, value)| self.of_effect(effect, name, *value)),
            );
        }
        all.extend(rest.iter().filter_map(of_field));
        all
    }

    /// The field's unit for this drive: a force-driven one takes u in volts for amperes.
    pub(crate) fn unit(&self, field: &Field) -> String {
        let force = self.motor.input == Input::Force && field.name() == "K_m";
        for_motion(self.motion, if force { "N m/V" } else { field.unit })
    }

    fn of_effect(&self, effect: &EffectData, name: &str, value: f64) -> NamedParameter {
        let known = registered(effect, name);
        NamedParameter {
            name: format!("{}.{name}", effect.id),
            value,
            unit: known.map_or_else(String::new, |p| for_motion(self.motion, p.unit)),
            range: known.map_or(fields::ANY, |p| p.range),
            description: known.map_or("coefficient of the typed law", |p| p.description),
            nominal: magnitude(value, known.map_or(1.0, |p| p.nominal)),
            role: Role::Physics,
        }
    }

    /// Whether a fit leaves the parameter as it is: the file says so, or nothing measured
    /// could tell it (K_m of a force-driven drive, of which only ratios to J are identifiable).
    pub fn is_fixed(&self, name: &str) -> bool {
        let unidentifiable = self.motor.input == Input::Force && name == "K_m";
        unidentifiable || self.fixed.iter().any(|fixed| fixed == name)
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
        if let Some(field) = FIELDS.iter().find(|field| field.name() == name) {
            return (field.slot)(self);
        }
        let (id, key) = name.split_once('.')?;
        let effect = self.effects.iter_mut().find(|effect| effect.id == id)?;
        effect.parameters.iter_mut().find(|(k, _)| k == key).map(|(_, value)| value)
    }
}

fn magnitude(value: f64, typical: f64) -> f64 {
    if value == 0.0 { typical } else { value.abs() }
}
