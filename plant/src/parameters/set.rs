//! Numbers of a drive set by their names.

use thiserror::Error;

use super::range::{allowed, possible};
use super::spelling::{meant, nearest};
use crate::drive::{Drive, fields};

/// Why a value cannot be set.
#[derive(Debug, Clone, PartialEq, Error)]
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

impl Drive {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DR300, drive};

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
}
