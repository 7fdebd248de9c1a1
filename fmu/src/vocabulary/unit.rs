//! A unit by name, as descriptions define it.

use drivescope_units::{BaseUnit, UnitError};
#[cfg(feature = "import")]
use drivescope_units::{Conversion, Unit as Known};
#[cfg(feature = "import")]
use roxmltree::Node;

#[cfg(feature = "import")]
use crate::position::DocumentProblem;
#[cfg(feature = "export")]
use crate::xml::element::{Element, number};
#[cfg(feature = "import")]
use crate::xml::read::{child, required, value};

/// A unit that a description defines, or that variables refer to undefined.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// The name by which variables refer to it.
    pub name: String,
    /// What it is in SI base units, if stated.
    pub base: Option<BaseUnit>,
}

impl Unit {
    /// The unit of a name such as `N m s/rad`.
    ///
    /// # Errors
    ///
    /// The symbol or power that cannot be read.
    pub fn parse(name: &str) -> Result<Self, UnitError> {
        Ok(Self { name: name.to_owned(), base: Some(BaseUnit::parse(name)?) })
    }

    /// The `<Unit>` of a model description; powers of 0, a factor of 1 and an offset of 0 go unsaid.
    #[cfg(feature = "export")]
    pub(crate) fn element(&self) -> Element {
        let unit = Element::new("Unit").with("name", &self.name);
        let Some(BaseUnit { powers, factor, offset }) = self.base else { return unit };
        let mut base = Element::new("BaseUnit");
        for (name, power) in BaseUnit::NAMES.into_iter().zip(powers) {
            base = base.maybe(name, (power != 0).then_some(power));
        }
        base = base.maybe("factor", (factor != 1.0).then(|| number(factor)));
        base = base.maybe("offset", (offset != 0.0).then(|| number(offset)));
        unit.child(base)
    }
}

#[cfg(feature = "import")]
impl Unit {
    /// A `<Unit>` of a model description, or of an SSP file, which says it alike.
    pub(crate) fn read(node: Node) -> Result<Self, DocumentProblem> {
        let base = |node: Node| -> Result<BaseUnit, DocumentProblem> {
            let mut powers = [0; 8];
            for (power, name) in powers.iter_mut().zip(BaseUnit::NAMES) {
                *power = value(node, name)?.unwrap_or(0);
            }
            Ok(BaseUnit {
                powers,
                factor: value(node, "factor")?.unwrap_or(1.0),
                offset: value(node, "offset")?.unwrap_or(0.0),
            })
        };
        Ok(Self {
            name: required(node, "name")?.to_owned(),
            base: child(node, "BaseUnit").map(base).transpose()?,
        })
    }
}

/// How values in `from` become values in `to`; `None` if they measure different things. Units of the
/// same name are the same; where one side states no unit there is nothing to check. A unit that says
/// nothing of SI is taken for the known one of its name, if there is one.
#[cfg(feature = "import")]
pub fn convert(from: Option<&Unit>, to: Option<&Unit>) -> Option<Conversion> {
    let (Some(from), Some(to)) = (from, to) else { return Some(Conversion::IDENTITY) };
    if from.name == to.name {
        return Some(Conversion::IDENTITY);
    }
    let base = |unit: &Unit| unit.base.or_else(|| Known::parse(&unit.name).map(BaseUnit::from));
    base(from)?.to(base(to)?)
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;

    fn bare(name: &str) -> Unit {
        Unit { name: name.to_owned(), base: None }
    }

    fn defined(name: &str) -> Unit {
        Unit::parse(name).expect("known symbols")
    }

    #[test]
    fn a_unit_without_a_definition_is_the_known_one_of_its_name() {
        let speed = defined("rad/s");
        let there = convert(Some(&bare("rpm")), Some(&speed)).unwrap();
        assert!((there.apply(30.0) - std::f64::consts::PI).abs() < 1e-12);
        let there = convert(Some(&bare("degC")), Some(&defined("K"))).unwrap();
        assert!((there.apply(1.0) - 274.15).abs() < 1e-9);
        assert_eq!(convert(Some(&bare("A")), Some(&speed)), None);
    }

    #[test]
    fn units_of_different_quantities_do_not_convert() {
        let (speed, current, unknown) = (defined("rad/s"), defined("A"), bare("thing"));
        assert_eq!(convert(Some(&speed), Some(&current)), None);
        assert_eq!(convert(Some(&speed), Some(&unknown)), None);
        assert_eq!(convert(Some(&unknown), Some(&unknown)), Some(Conversion::IDENTITY));
        assert_eq!(convert(Some(&speed), None), Some(Conversion::IDENTITY));
    }
}
