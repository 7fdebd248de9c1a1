//! `<ModelStructure>`: FMI 2.0 counts variables from 1, FMI 3.0 names them by value reference. Both
//! become positions in the list of variables.

use std::collections::HashMap;

use roxmltree::Node;

use super::description::*;
use crate::position::DocumentProblem;
use crate::xml::read::{Positions, Value, child, children, problem, value};

type Parsed<T> = Result<T, DocumentProblem>;

pub(super) fn read(root: Node, fmi: Version, variables: &[Variable]) -> Parsed<Structure> {
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
        Version::Two => {
            (number as usize).checked_sub(1).filter(|position| *position < variables.len())
        }
        Version::Three => by_reference.get(&number).copied(),
    };
    let list = |two: &'static str, three: &'static str| -> Parsed<Vec<Unknown>> {
        let nodes: Vec<Node> = match fmi {
            Version::Two => {
                child(node, two).into_iter().flat_map(|list| children(list, "Unknown")).collect()
            }
            Version::Three => children(node, three).collect(),
        };
        let mut positions = Positions::new(root.document().input_text());
        nodes.into_iter().map(|node| unknown(node, fmi, &position, positions.of(node))).collect()
    };
    let event_indicators = match fmi {
        Version::Two => value(root, "numberOfEventIndicators")?.unwrap_or(0),
        Version::Three => children(node, "EventIndicator").count(),
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
    fmi: Version,
    position: &impl Fn(u32) -> Option<usize>,
    place: Position,
) -> Parsed<Unknown> {
    let name = if fmi == Version::Two { "index" } else { "valueReference" };
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
