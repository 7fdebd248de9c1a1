//! Reads `modelDescription.xml` of FMI 2.0 and 3.0. Lenient where an FMU can be run all the same:
//! the rules of the standard are checked by [`validate`](super::validate), which reports all of them.

use roxmltree::Node;

use super::description::*;
use super::error::Error;
use super::parse_structure;
use super::parse_variables;
use crate::position::DocumentProblem;
use crate::xml::read::{self as xml, child, children, problem, required, text, value};

type Parsed<T> = Result<T, DocumentProblem>;

/// Reads a model description.
///
/// # Errors
/// Malformed XML, an unsupported FMI version, or something missing without which the FMU cannot run.
pub(crate) fn read(document: &str, fmu: &str) -> Result<Description, Error> {
    let wrong = |place| Error::Description { fmu: fmu.to_owned(), place: Box::new(place) };
    let document = xml::parse(document).map_err(wrong)?;
    let root = document.root_element();
    if root.tag_name().name() != "fmiModelDescription" {
        let name = root.tag_name().name();
        return Err(wrong(problem(
            root,
            format!("the top element is <{name}>, not <fmiModelDescription>"),
        )));
    }
    let version = required(root, "fmiVersion").map_err(wrong)?;
    let fmi = match version.split('.').next() {
        Some("2") => Version::Two,
        Some("3") => Version::Three,
        _ => return Err(Error::Version { fmu: fmu.to_owned(), version: version.to_owned() }),
    };
    description(root, fmi, version).map_err(wrong)
}

fn description(root: Node, fmi: Version, version: &str) -> Parsed<Description> {
    let token = if fmi == Version::Two { "guid" } else { "instantiationToken" };
    let types = read_types(root, fmi)?;
    let variables = parse_variables::read(root, fmi, &types)?;
    let structure = parse_structure::read(root, fmi, &variables)?;
    Ok(Description {
        fmi,
        fmi_version: version.to_owned(),
        model_name: required(root, "modelName")?.to_owned(),
        token: required(root, token)?.to_owned(),
        description: text(root, "description"),
        author: text(root, "author"),
        version: text(root, "version"),
        generation_tool: text(root, "generationTool"),
        structured_names: root.attribute("variableNamingConvention") == Some("structured"),
        default_experiment: child(root, "DefaultExperiment")
            .map(DefaultExperiment::read)
            .transpose()?
            .unwrap_or_default(),
        co_simulation: child(root, "CoSimulation")
            .map(|node| capabilities(node, fmi))
            .transpose()?,
        model_exchange: child(root, "ModelExchange")
            .map(|node| capabilities(node, fmi))
            .transpose()?,
        log_categories: child(root, "LogCategories")
            .into_iter()
            .flat_map(|node| children(node, "Category"))
            .filter_map(|node| text(node, "name"))
            .collect(),
        units: child(root, "UnitDefinitions")
            .into_iter()
            .flat_map(|node| children(node, "Unit"))
            .map(Unit::read)
            .collect::<Parsed<_>>()?,
        types,
        variables,
        structure,
    })
}

fn capabilities(node: Node, fmi: Version) -> Parsed<Capabilities> {
    let flag = |two: &str, three: &str| -> Parsed<bool> {
        let name = if fmi == Version::Two { two } else { three };
        Ok(value(node, name)?.unwrap_or(false))
    };
    let announced = match fmi {
        Version::Two => !value(node, "completedIntegratorStepNotNeeded")?.unwrap_or(false),
        Version::Three => value(node, "needsCompletedIntegratorStep")?.unwrap_or(false),
    };
    Ok(Capabilities {
        model_identifier: required(node, "modelIdentifier")?.to_owned(),
        needs_execution_tool: flag("needsExecutionTool", "needsExecutionTool")?,
        only_once_per_process: flag(
            "canBeInstantiatedOnlyOncePerProcess",
            "canBeInstantiatedOnlyOncePerProcess",
        )?,
        state: flag("canGetAndSetFMUstate", "canGetAndSetFMUState")?,
        serialize_state: flag("canSerializeFMUstate", "canSerializeFMUState")?,
        directional_derivatives: flag(
            "providesDirectionalDerivative",
            "providesDirectionalDerivatives",
        )?,
        variable_step: flag(
            "canHandleVariableCommunicationStepSize",
            "canHandleVariableCommunicationStepSize",
        )?,
        fixed_step: value(node, "fixedInternalStepSize")?,
        event_mode: flag("", "hasEventMode")?,
        needs_completed_step: announced,
    })
}

fn read_types(root: Node, fmi: Version) -> Parsed<Vec<TypeDefinition>> {
    let Some(list) = child(root, "TypeDefinitions") else { return Ok(Vec::new()) };
    list.children()
        .filter(Node::is_element)
        .map(|node| {
            // FMI 2.0 wraps the type in <SimpleType>, FMI 3.0 says <Float64Type>.
            let body = match fmi {
                Version::Two => node.children().find(Node::is_element).unwrap_or(node),
                Version::Three => node,
            };
            let item = |item: Node| -> Parsed<(String, i64)> {
                let number = value(item, "value")?;
                let number =
                    number.ok_or_else(|| problem(item, "<Item> has no attribute `value`"))?;
                Ok((required(item, "name")?.to_owned(), number))
            };
            Ok(TypeDefinition {
                name: required(node, "name")?.to_owned(),
                unit: text(body, "unit"),
                nominal: value(body, "nominal")?,
                range: (value(body, "min")?, value(body, "max")?),
                items: children(body, "Item").map(item).collect::<Parsed<_>>()?,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{1}" numberOfEventIndicators="2">
  <ModelExchange modelIdentifier="m" completedIntegratorStepNotNeeded="true"/>
  <CoSimulation modelIdentifier="mc" canGetAndSetFMUstate="1"/>
  <UnitDefinitions><Unit name="rpm"><BaseUnit s="-1" rad="1" factor="0.1047"/></Unit></UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="A"><Real unit="V"/></SimpleType>
    <SimpleType name="Speed"><Real unit="rpm" nominal="3000"/></SimpleType>
  </TypeDefinitions>
  <DefaultExperiment stopTime="2.5"/>
  <ModelVariables>
    <ScalarVariable name="n" valueReference="7" causality="output"><Real declaredType="Speed"/></ScalarVariable>
    <ScalarVariable name="x" valueReference="1"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="der(x)" valueReference="2"><Real derivative="2"/></ScalarVariable>
    <ScalarVariable name="s" valueReference="1" causality="parameter" variability="fixed"><String start="a b"/></ScalarVariable>
    <ScalarVariable name="on" valueReference="1" causality="input"><Boolean start="true"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1" dependencies="2 5" dependenciesKind="dependent fixed"/></Outputs>
    <Derivatives><Unknown index="3"/></Derivatives>
  </ModelStructure>
</fmiModelDescription>"#;

    #[test]
    fn fmi_2_is_read() {
        let d = read(TWO, "m.fmu").unwrap();
        assert_eq!((d.fmi, d.token.as_str()), (Version::Two, "{1}"));
        assert_eq!(d.interfaces(), [Interface::CoSimulation, Interface::ModelExchange]);
        assert!(!d.model_exchange.as_ref().unwrap().needs_completed_step);
        assert!(d.co_simulation.as_ref().unwrap().state);
        assert_eq!(d.default_experiment.stop, Some(2.5));
        assert_eq!(d.units[0].base.unwrap().powers, [0, 0, -1, 0, 0, 0, 0, 1]);
        let n = d.variable("n").unwrap();
        assert_eq!((n.unit.as_deref(), n.nominal, n.place.line), (Some("rpm"), Some(3000.0), 12));
        assert_eq!(n.initial, Some(Initial::Calculated));
        assert_eq!(d.variable("s").unwrap().start, ["a b"]);
        assert_eq!(d.variable("on").unwrap().variability, Variability::Discrete);
        assert_eq!(d.structure.event_indicators, 2);
        assert_eq!(d.structure.outputs[0].dependencies, Some(vec![Some(1), Some(4)]));
        assert_eq!(d.structure.derivatives[0].variable, Some(2));
        assert_eq!(d.structure.derivatives[0].dependencies, None);
    }

    const THREE: &str = r#"<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="t">
  <CoSimulation modelIdentifier="m" hasEventMode="true" fixedInternalStepSize="0.01"/>
  <TypeDefinitions><EnumerationType name="E"><Item name="a" value="3"/></EnumerationType></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <UInt64 name="size" valueReference="1" causality="structuralParameter" variability="tunable" start="3"/>
    <Float64 name="v" valueReference="2" causality="input" start="1 2 3"><Dimension valueReference="1"/><Alias name="w"/></Float64>
    <String name="s" valueReference="3" causality="parameter"><Start value="a b"/></String>
    <Int8 name="k" valueReference="4" causality="output"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="4" dependencies=""/><EventIndicator valueReference="4"/></ModelStructure>
</fmiModelDescription>"#;

    #[test]
    fn fmi_3_is_read() {
        let d = read(THREE, "m.fmu").unwrap();
        let v = d.variable("v").unwrap();
        assert_eq!((v.start.len(), d.elements(v)), (3, 3));
        assert_eq!(d.variable("w").unwrap().alias_of.as_deref(), Some("v"));
        assert_eq!(d.variable("time").unwrap().initial, None);
        assert_eq!(d.variable("k").unwrap().variability, Variability::Discrete);
        assert_eq!(d.types[0].items, [("a".to_owned(), 3)]);
        let cs = d.co_simulation.as_ref().unwrap();
        assert!(cs.event_mode && cs.fixed_step == Some(0.01));
        assert_eq!(d.structure.outputs[0].dependencies, Some(vec![]));
        assert_eq!((d.structure.outputs[0].variable, d.structure.event_indicators), (Some(5), 1));
    }

    #[test]
    fn what_cannot_be_read_is_named_with_its_place() {
        let message = |text: &str| read(text, "m.fmu").unwrap_err().to_string();
        assert!(message(&TWO.replace("\"2.0\"", "\"1.0\"")).contains("FMI version `1.0`"));
        let bad = message(&TWO.replace("valueReference=\"7\"", "valueReference=\"seven\""));
        assert!(bad.contains("m.fmu: modelDescription.xml:12:5: "), "{bad}");
        let bad = message(&TWO.replace("</ModelVariables>", ""));
        assert!(bad.contains("modelDescription.xml:22:1"), "{bad}");
        let bad = message(&TWO.replace("causality=\"output\"", "causality=\"exit\""));
        assert!(bad.contains("`exit`"), "{bad}");
        assert!(message("<html/>").contains("<html>"));
    }
}
