//! A variable: its name, type, role, unit and start value.

use super::{Causality, Initial, Type, Unit, UnitError, Variability};
use crate::vocabulary::default_initial;

/// A scalar variable of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Value reference: unique, not 0, the same in every release.
    pub reference: u32,
    /// Unique name.
    pub name: String,
    /// One line for users; may be empty.
    pub description: String,
    /// Data type: `Float64`, `Int32` or `Boolean`; the interface to the model is `f64` for all.
    pub kind: Type,
    /// Who gives the value.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// How it is initialized; `None` for the standard's default (see [`Variable::initial`]).
    pub initial: Option<Initial>,
    /// Unit of value, start, min, max and nominal.
    pub unit: Option<Unit>,
    /// Start value.
    pub start: Option<f64>,
    /// Least value that may be set.
    pub min: Option<f64>,
    /// Greatest value that may be set.
    pub max: Option<f64>,
    /// Typical size, > 0; of a state, the scale of its absolute tolerance.
    pub nominal: Option<f64>,
    /// Value reference of the state whose derivative this is.
    pub derivative_of: Option<u32>,
    /// A state that the model may set anew at an event.
    pub reinit: bool,
}

impl Variable {
    /// A real variable without unit, description, start value and range.
    pub fn new(
        reference: u32,
        name: impl Into<String>,
        causality: Causality,
        variability: Variability,
    ) -> Self {
        Self {
            reference,
            name: name.into(),
            description: String::new(),
            kind: Type::Float64,
            causality,
            variability,
            initial: None,
            unit: None,
            start: None,
            min: None,
            max: None,
            nominal: None,
            derivative_of: None,
            reinit: false,
        }
    }

    /// With a description.
    pub fn described(mut self, description: impl Into<String>) -> Self {
        self.description = description.into();
        self
    }

    /// With a unit such as `N m/A`.
    ///
    /// # Errors
    ///
    /// The part of the unit that is not known.
    pub fn in_unit(mut self, unit: &str) -> Result<Self, UnitError> {
        self.unit = Some(Unit::parse(unit)?);
        Ok(self)
    }

    /// With a start value (true is 1).
    pub fn starting_at(mut self, start: f64) -> Self {
        self.start = Some(start);
        self
    }

    /// How the value is found in initialization, the standard's default where none is given. No
    /// variable of a model is the independent one, the only one without: that one is refused.
    pub fn initial(&self) -> Initial {
        let default = || default_initial(self.causality, self.variability);
        self.initial.or_else(default).unwrap_or(Initial::Calculated)
    }
}

/// `name` follows the standard's "structured" naming convention: identifiers joined by dots, or
/// `der(...)` of that.
#[cfg(feature = "export")]
pub(super) fn is_structured(name: &str) -> bool {
    let inner = name.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')')).unwrap_or(name);
    inner.split('.').all(|part| {
        part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    })
}

#[cfg(all(test, feature = "export"))]
mod tests {
    use super::*;

    #[test]
    fn structured_names_are_told_from_flat_ones() {
        for name in ["omega", "coulomb.T_c", "der(omega)", "_a.b2"] {
            assert!(is_structured(name), "{name}");
        }
        for name in ["", "2a", "a b", "a..b", "der(omega", "a-b"] {
            assert!(!is_structured(name), "{name}");
        }
    }
}
