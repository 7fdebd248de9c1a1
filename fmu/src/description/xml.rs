//! A small element tree, written with quick-xml's escaping, and what both versions share.

use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use quick_xml::writer::Writer;

use super::{BaseUnit, Causality, LogCategory, ModelDescription, Variable};
use crate::vocabulary::Word;

/// An XML element with its attributes in the order in which they were added.
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    pub(super) fn new(name: &'static str) -> Self {
        Self { name, attributes: Vec::new(), children: Vec::new() }
    }

    pub(super) fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// An attribute where there is a value.
    pub(super) fn maybe(self, name: &'static str, value: Option<impl ToString>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// An attribute whose empty value says nothing.
    pub(super) fn text(self, name: &'static str, value: &str) -> Self {
        self.maybe(name, (!value.is_empty()).then_some(value))
    }

    /// An attribute that is false where it is absent.
    pub(super) fn flag(self, name: &'static str, value: bool) -> Self {
        self.maybe(name, value.then_some("true"))
    }

    pub(super) fn child(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    pub(super) fn children(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// A child only where it would not be empty.
    pub(super) fn list(self, list: Element) -> Self {
        if list.children.is_empty() { self } else { self.child(list) }
    }

    /// The document, UTF-8.
    pub(super) fn to_xml(&self) -> String {
        let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
        let declared = writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
        declared.and_then(|()| self.write(&mut writer)).expect("a Vec takes all that is written");
        let mut text = String::from_utf8(writer.into_inner()).expect("names and texts are UTF-8");
        text.push('\n');
        text
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) -> std::io::Result<()> {
        let mut start = BytesStart::new(self.name);
        for (name, value) in &self.attributes {
            start.push_attribute((*name, value.as_str()));
        }
        if self.children.is_empty() {
            return writer.write_event(Event::Empty(start));
        }
        writer.write_event(Event::Start(start))?;
        for child in &self.children {
            child.write(writer)?;
        }
        writer.write_event(Event::End(BytesEnd::new(self.name)))
    }
}

/// The shortest decimal that reads back as the same double; `xs:double` knows exponents.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

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
    Element::new("UnitDefinitions").children(units.into_iter().map(|unit| {
        let BaseUnit { powers, factor, offset } = unit.base;
        let mut base = Element::new("BaseUnit");
        for (name, power) in BaseUnit::NAMES.into_iter().zip(powers) {
            base = base.maybe(name, (power != 0).then_some(power));
        }
        base = base.maybe("factor", (factor != 1.0).then(|| number(factor)));
        base = base.maybe("offset", (offset != 0.0).then(|| number(offset)));
        Element::new("Unit").with("name", &unit.name).child(base)
    }))
}

pub(super) fn log_categories() -> Element {
    Element::new("LogCategories").children(LogCategory::ALL.map(|category| {
        Element::new("Category")
            .with("name", category.name())
            .with("description", category.description())
    }))
}

pub(super) fn default_experiment(description: &ModelDescription) -> Element {
    let experiment = &description.default_experiment;
    Element::new("DefaultExperiment")
        .with("startTime", number(experiment.start))
        .with("stopTime", number(experiment.stop))
        .with("tolerance", number(experiment.tolerance))
        .with("stepSize", number(experiment.step))
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
