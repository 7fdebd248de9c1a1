//! What the description files of both versions share.

use super::{Causality, LogCategory, ModelDescription, Variable, Version};
use crate::vocabulary::Word;
use crate::xml::element::{Element, number};

/// `initial`, which the standard forbids for inputs.
pub(super) fn initial(variable: &Variable) -> Option<&'static str> {
    (variable.causality != Causality::Input).then(|| variable.initial().word())
}

pub(super) fn naming(description: &ModelDescription) -> &'static str {
    if description.names_are_structured() { "structured" } else { "flat" }
}

/// Every unit in use, seconds first, each once, in the order of the variables.
pub(super) fn units(description: &ModelDescription) -> Element {
    let second = super::Unit::parse("s").expect("s is a known symbol");
    let mut units = vec![&second];
    for unit in description.variables.iter().filter_map(|variable| variable.unit.as_ref()) {
        if !units.iter().any(|known| known.name == unit.name) {
            units.push(unit);
        }
    }
    Element::new("UnitDefinitions").children(units.into_iter().map(super::Unit::element))
}

pub(super) fn log_categories() -> Element {
    Element::new("LogCategories").children(LogCategory::ALL.map(|category| {
        Element::new("Category")
            .with("name", category.name())
            .with("description", category.description())
    }))
}

/// The element of a variable's type; [`ModelDescription::check`] lets no other types through.
pub(super) fn element_name(variable: &Variable, version: Version) -> &'static str {
    variable.kind.name_in(version).expect("a type that both versions have")
}

/// Attributes of a number's value; start is written by the caller, whose types differ.
pub(super) fn real_attributes(element: Element, variable: &Variable) -> Element {
    element
        .maybe("unit", variable.unit.as_ref().map(|unit| &unit.name))
        .maybe("min", variable.min.map(number))
        .maybe("max", variable.max.map(number))
        .maybe("nominal", variable.nominal.map(number))
}

/// References or indices as a list of the standard.
pub(super) fn joined(numbers: impl Iterator<Item = u32>) -> String {
    numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(" ")
}
