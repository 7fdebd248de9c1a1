//! The variables of a model description: `<ScalarVariable><Real/>` in FMI 2.0, `<Float64/>` in 3.0.

use roxmltree::Node;

use super::description::*;
use super::problem::XmlProblem;
use super::xml::{Places, Value, child, children, problem, required, text, value};
use crate::vocabulary::{Word, default_initial, default_variability};

type Parsed<T> = Result<T, XmlProblem>;

/// The variables in the order of the file; an alias (FMI 3.0) follows the variable it names.
pub(super) fn read(root: Node, fmi: FmiVersion, types: &[TypeDefinition]) -> Parsed<Vec<Variable>> {
    let list = child(root, "ModelVariables");
    let list = list.ok_or_else(|| problem(root, "there is no <ModelVariables>"))?;
    let mut places = Places::new(root.document().input_text());
    let mut variables = Vec::new();
    for node in list.children().filter(Node::is_element) {
        let place = places.of(node);
        let variable = variable(node, fmi, types, place)?;
        let aliases = children(node, "Alias").map(|alias| -> Parsed<Variable> {
            Ok(Variable {
                name: required(alias, "name")?.to_owned(),
                description: text(alias, "description"),
                alias_of: Some(variable.name.clone()),
                ..variable.clone()
            })
        });
        let aliases = aliases.collect::<Parsed<Vec<_>>>()?;
        variables.push(variable);
        variables.extend(aliases);
    }
    Ok(variables)
}

fn variable(
    node: Node,
    fmi: FmiVersion,
    types: &[TypeDefinition],
    place: Place,
) -> Parsed<Variable> {
    // In FMI 2.0 the type's attributes are on a child element, in FMI 3.0 on the variable itself.
    let body = match fmi {
        FmiVersion::V2 => node
            .children()
            .find(|child| child.is_element() && child.tag_name().name() != "Annotations"),
        FmiVersion::V3 => Some(node),
    };
    let body = body.ok_or_else(|| problem(node, "the variable has no type"))?;
    let kind = kind(body, fmi)?;
    let causality = choice(node, "causality")?.unwrap_or(Causality::Local);
    let variability = match choice(node, "variability")? {
        Some(stated) => stated,
        None => default_variability(causality, kind.is_float()),
    };
    let initial = choice(node, "initial")?;
    let declared_type = text(body, "declaredType");
    let declared = declared_type.as_ref().and_then(|name| types.iter().find(|t| t.name == *name));
    // A range is only checked, so one that the type cannot hold must not stop the FMU.
    let bound = |name| body.attribute(name).and_then(f64::read);
    Ok(Variable {
        name: required(node, "name")?.to_owned(),
        reference: value(node, "valueReference")?
            .ok_or_else(|| problem(node, "the variable has no attribute `valueReference`"))?,
        kind,
        causality,
        variability,
        initial: initial.or(default_initial(causality, variability)),
        initial_stated: initial.is_some(),
        unit: text(body, "unit").or_else(|| declared.and_then(|t| t.unit.clone())),
        start: starts(body, kind, fmi)?,
        nominal: value(body, "nominal")?.or(declared.and_then(|t| t.nominal)),
        range: (
            bound("min").or(declared.and_then(|t| t.range.0)),
            bound("max").or(declared.and_then(|t| t.range.1)),
        ),
        declared_type,
        dimensions: children(body, "Dimension").map(dimension).collect::<Parsed<_>>()?,
        derivative: value(body, "derivative")?,
        description: text(node, "description"),
        alias_of: None,
        place,
    })
}

fn kind(body: Node, fmi: FmiVersion) -> Parsed<Type> {
    let name = body.tag_name().name();
    let kind = match (fmi, name) {
        (FmiVersion::V2, "Real") => Type::Float64,
        (FmiVersion::V2, "Integer") => Type::Int32,
        (FmiVersion::V3, "Float64") => Type::Float64,
        (FmiVersion::V3, "Float32") => Type::Float32,
        (FmiVersion::V3, "Int8") => Type::Int8,
        (FmiVersion::V3, "UInt8") => Type::UInt8,
        (FmiVersion::V3, "Int16") => Type::Int16,
        (FmiVersion::V3, "UInt16") => Type::UInt16,
        (FmiVersion::V3, "Int32") => Type::Int32,
        (FmiVersion::V3, "UInt32") => Type::UInt32,
        (FmiVersion::V3, "Int64") => Type::Int64,
        (FmiVersion::V3, "UInt64") => Type::UInt64,
        (FmiVersion::V3, "Binary") => Type::Binary,
        (FmiVersion::V3, "Clock") => Type::Clock,
        (_, "Boolean") => Type::Boolean,
        (_, "Enumeration") => Type::Enumeration,
        (_, "String") => Type::String,
        _ => return Err(problem(body, format!("<{name}> is no type of a variable"))),
    };
    Ok(kind)
}

fn starts(body: Node, kind: Type, fmi: FmiVersion) -> Parsed<Vec<String>> {
    if fmi == FmiVersion::V3 && matches!(kind, Type::String | Type::Binary) {
        return children(body, "Start")
            .map(|node| Ok(required(node, "value")?.to_owned()))
            .collect();
    }
    Ok(match body.attribute("start") {
        None => Vec::new(),
        Some(start) if fmi == FmiVersion::V2 => vec![start.to_owned()],
        Some(start) => start.split_whitespace().map(str::to_owned).collect(),
    })
}

fn dimension(node: Node) -> Parsed<Dimension> {
    match (value(node, "start")?, value(node, "valueReference")?) {
        (Some(size), _) => Ok(Dimension::Fixed(size)),
        (None, Some(reference)) => Ok(Dimension::Structural(reference)),
        (None, None) => Err(problem(node, "<Dimension> has neither `start` nor `valueReference`")),
    }
}

fn choice<T: Word>(node: Node, name: &str) -> Parsed<Option<T>> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let wrong = || {
        let words: Vec<_> = T::WORDS.iter().map(|(word, _)| *word).collect();
        problem(node, format!("`{name}` is `{text}`, not one of {}", words.join(", ")))
    };
    T::read(text).map(Some).ok_or_else(wrong)
}
