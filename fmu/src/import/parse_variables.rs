//! The variables of a model description: `<ScalarVariable><Real/>` in FMI 2.0, `<Float64/>` in 3.0.

use roxmltree::Node;

use super::description::*;
use crate::position::DocumentProblem;
use crate::vocabulary::{Word, default_initial, default_variability};
use crate::xml::read::{Positions, Value, child, children, problem, required, text, value};

type Parsed<T> = Result<T, DocumentProblem>;

/// The variables in the order of the file; an alias (FMI 3.0) follows the variable it names.
pub(super) fn read(root: Node, fmi: Version, types: &[TypeDefinition]) -> Parsed<Vec<Variable>> {
    let list = child(root, "ModelVariables");
    let list = list.ok_or_else(|| problem(root, "there is no <ModelVariables>"))?;
    let mut positions = Positions::new(root.document().input_text());
    let mut variables = Vec::new();
    for node in list.children().filter(Node::is_element) {
        let place = positions.of(node);
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
    fmi: Version,
    types: &[TypeDefinition],
    place: Position,
) -> Parsed<Variable> {
    // In FMI 2.0 the type's attributes are on a child element, in FMI 3.0 on the variable itself.
    let body = match fmi {
        Version::Two => node
            .children()
            .find(|child| child.is_element() && child.tag_name().name() != "Annotations"),
        Version::Three => Some(node),
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

fn kind(body: Node, fmi: Version) -> Parsed<Type> {
    let name = body.tag_name().name();
    let unknown = || problem(body, format!("<{name}> is no type of a variable"));
    Type::read(name, fmi).ok_or_else(unknown)
}

fn starts(body: Node, kind: Type, fmi: Version) -> Parsed<Vec<String>> {
    if fmi == Version::Three && matches!(kind, Type::String | Type::Binary) {
        return children(body, "Start")
            .map(|node| Ok(required(node, "value")?.to_owned()))
            .collect();
    }
    Ok(match body.attribute("start") {
        None => Vec::new(),
        Some(start) if fmi == Version::Two => vec![start.to_owned()],
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
