//! `<ModelStructure>`: FMI 2.0 counts variables from 1, FMI 3.0 names them by value reference. Both
//! become positions in the list of variables.

use std::collections::HashMap;

use roxmltree::Node;

use super::description::*;
use super::problem::XmlProblem;
use super::xml::{Places, Value, child, children, problem, value};

type Parsed<T> = Result<T, XmlProblem>;

pub(super) fn read(root: Node, fmi: FmiVersion, variables: &[Variable]) -> Parsed<Structure> {
    let Some(node) = child(root, "ModelStructure") else {
        return Err(problem(root, "there is no <ModelStructure>"));
    };
    let by_reference: HashMap<u32, usize> = variables
        .iter()
        .enumerate()
        .filter(|(_, variable)| variable.alias_of.is_none())
        .map(|(position, variable)| (variable.reference, position))
        .collect();
    let position = |number: u32| match fmi {
        FmiVersion::V2 => {
            (number as usize).checked_sub(1).filter(|position| *position < variables.len())
        }
        FmiVersion::V3 => by_reference.get(&number).copied(),
    };
    let list = |two: &'static str, three: &'static str| -> Parsed<Vec<Unknown>> {
        let nodes: Vec<Node> = match fmi {
            FmiVersion::V2 => {
                child(node, two).into_iter().flat_map(|list| children(list, "Unknown")).collect()
            }
            FmiVersion::V3 => children(node, three).collect(),
        };
        let mut places = Places::new(root.document().input_text());
        nodes.into_iter().map(|node| unknown(node, fmi, &position, places.of(node))).collect()
    };
    let event_indicators = match fmi {
        FmiVersion::V2 => value(root, "numberOfEventIndicators")?.unwrap_or(0),
        FmiVersion::V3 => children(node, "EventIndicator").count(),
    };
    Ok(Structure {
        outputs: list("Outputs", "Output")?,
        derivatives: list("Derivatives", "ContinuousStateDerivative")?,
        initial_unknowns: list("InitialUnknowns", "InitialUnknown")?,
        event_indicators,
    })
}

fn unknown(
    node: Node,
    fmi: FmiVersion,
    position: &impl Fn(u32) -> Option<usize>,
    place: Place,
) -> Parsed<Unknown> {
    let name = if fmi == FmiVersion::V2 { "index" } else { "valueReference" };
    let missing = || problem(node, format!("the unknown has no attribute `{name}`"));
    let number = value(node, name)?.ok_or_else(missing)?;
    let dependencies = match node.attribute("dependencies") {
        None => None,
        Some(text) => {
            let numbers = text.split_whitespace().map(|word| {
                let wrong = || problem(node, format!("`dependencies` holds `{word}`"));
                u32::read(word).map(position).ok_or_else(wrong)
            });
            Some(numbers.collect::<Parsed<Vec<_>>>()?)
        }
    };
    let kinds = node.attribute("dependenciesKind").map(|text| text.split_whitespace().count());
    Ok(Unknown { variable: position(number), dependencies, kinds, place })
}
