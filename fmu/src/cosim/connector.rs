//! What a system description says about a component's ports, held against the FMU itself: SSP lets a
//! file declare connectors with direction, type and unit, and whoever reads the file trusts them.

use roxmltree::Node;

use crate::import::{Causality, Conversion, Description, Type, Unit, Variable, convert};
use crate::xml::read::{self as xml, required};

use crate::position::{DocumentProblem, Position};

/// A connector as the file declares it.
#[derive(Debug, Clone)]
pub(super) struct ConnectorEntry {
    pub(super) name: String,
    /// `input`, `output`, ... as written.
    pub(super) kind: String,
    /// Element of its type, `Real` and the like, and the unit; none where the FMU's own holds.
    pub(super) declared: Option<(String, Option<Unit>)>,
    pub(super) place: Position,
}

impl ConnectorEntry {
    /// Reads a `<Connector>`; units are looked up among those that the file defines.
    pub(super) fn read(node: Node, units: &[Unit]) -> Result<ConnectorEntry, DocumentProblem> {
        let of_type = |child: &Node| {
            child.is_element()
                && !matches!(child.tag_name().name(), "ConnectorGeometry" | "Annotations")
        };
        let declared = node.children().find(of_type).map(|body| {
            let unit = body.attribute("unit").map(|name| named(name, units));
            (body.tag_name().name().to_owned(), unit)
        });
        Ok(ConnectorEntry {
            name: required(node, "name")?.to_owned(),
            kind: required(node, "kind")?.to_owned(),
            declared,
            place: xml::position(node),
        })
    }

    /// Whether the FMU's variable is what the file says it is; if not, what is wrong.
    pub(super) fn check(&self, fmu: &Description) -> Result<(), String> {
        let Self { name, kind, .. } = self;
        let variable = fmu.variable(name).ok_or_else(|| {
            format!("connector `{name}`: the FMU has no such variable; name one that it has")
        })?;
        if !self.fits_causality(variable.causality) {
            let causality = format!("{:?}", variable.causality).to_lowercase();
            return Err(format!(
                "connector `{name}` is declared as {kind}, and is {causality} in the FMU"
            ));
        }
        self.fits_type(variable)?;
        match self.units(variable, fmu) {
            Some((unit, own)) if convert(Some(unit), Some(&own)) != Some(Conversion::IDENTITY) => {
                Err(format!(
                    "connector `{name}` is declared in `{}`, and the FMU has it in `{}`; declare the \
                     FMU's unit: values are converted where ports are connected",
                    unit.name, own.name
                ))
            }
            _ => Ok(()),
        }
    }

    fn fits_causality(&self, causality: Causality) -> bool {
        match self.kind.as_str() {
            "input" => causality == Causality::Input,
            "output" => causality == Causality::Output,
            "inout" => matches!(causality, Causality::Input | Causality::Output),
            "parameter" => {
                matches!(causality, Causality::Parameter | Causality::StructuralParameter)
            }
            "calculatedParameter" => causality == Causality::CalculatedParameter,
            "local" => causality == Causality::Local,
            _ => false,
        }
    }

    /// Whether an output of the system can show that variable; if not, what is wrong.
    pub(super) fn shows(&self, variable: &Variable, fmu: &Description) -> Result<(), String> {
        let name = &self.name;
        if self.kind != "output" {
            return Err(format!("connector `{name}` is driven, and is declared as {}", self.kind));
        }
        self.fits_type(variable)?;
        match self.units(variable, fmu) {
            Some((unit, own)) if convert(Some(&own), Some(unit)).is_none() => Err(format!(
                "connector `{name}` is declared in `{}`, and shows `{}` of an FMU, which is in `{}`: \
                 these do not convert",
                unit.name, variable.name, own.name
            )),
            _ => Ok(()),
        }
    }

    fn fits_type(&self, variable: &Variable) -> Result<(), String> {
        match &self.declared {
            Some((declared, _)) if !is_of_type(variable.kind, declared) => Err(format!(
                "connector `{}` is declared as {declared}, and is of type {} in the FMU",
                self.name,
                variable.kind.name()
            )),
            _ => Ok(()),
        }
    }

    /// The declared unit and the FMU's own, where both state one.
    fn units(&self, variable: &Variable, fmu: &Description) -> Option<(&Unit, Unit)> {
        let declared = self.declared.as_ref()?.1.as_ref()?;
        Some((declared, fmu.unit_of_name(variable.unit.as_ref()?)))
    }
}

/// The unit of that name among those that a file defines, or the bare name.
pub(super) fn named(name: &str, units: &[Unit]) -> Unit {
    let found = units.iter().find(|unit| unit.name == name).cloned();
    found.unwrap_or_else(|| Unit { name: name.to_owned(), base: None })
}

/// SSP 1.0 names five types, SSP 2.0 those of FMI 3.0.
fn is_of_type(kind: Type, declared: &str) -> bool {
    match declared {
        "Real" => kind.is_float(),
        "Integer" => {
            kind.is_numeric()
                && !kind.is_float()
                && !matches!(kind, Type::Boolean | Type::Enumeration)
        }
        other => kind.name() == other,
    }
}
