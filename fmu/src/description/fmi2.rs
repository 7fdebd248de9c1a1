//! `modelDescription.xml` of FMI 2.0 (standard 2.0.4, section 2.2).
//!
//! Variables are numbered from 1 in the order of `ModelVariables`, `time` first; the model
//! structure and derivatives refer to these numbers, not to value references.

use std::collections::HashMap;

use super::{
    Causality, ModelDescription, TIME, Type, Unknown, Variability, Variable, Version, common,
};
use crate::vocabulary::Word;
use crate::xml::element::{Element, number};

pub(super) fn document(description: &ModelDescription, token: &str) -> Element {
    let indicators = description.structure.event_indicators.len();
    let capabilities = description.capabilities;
    let mut root = Element::new("fmiModelDescription")
        .with("fmiVersion", "2.0")
        .with("modelName", &description.name)
        .with("guid", token)
        .text("description", &description.description)
        .text("version", &description.version)
        .text("generationTool", &description.generation_tool)
        .with("variableNamingConvention", common::naming(description))
        .with("numberOfEventIndicators", indicators);
    if capabilities.model_exchange {
        let exchange = Element::new("ModelExchange")
            .with("modelIdentifier", &description.identifier)
            .flag("completedIntegratorStepNotNeeded", true);
        root = root.child(interface(exchange, description));
    }
    if capabilities.co_simulation {
        let simulation = Element::new("CoSimulation")
            .with("modelIdentifier", &description.identifier)
            .flag("canHandleVariableCommunicationStepSize", capabilities.variable_step);
        root = root.child(interface(simulation, description));
    }
    let index = indices(description);
    let derivative = |variable: &Variable| index[&variable.derivative_of.unwrap_or(TIME)];
    let variables = description.variables.iter().map(|v| scalar(v, derivative(v)));
    root.child(common::units(description))
        .child(common::log_categories())
        .child(description.default_experiment.element())
        .child(Element::new("ModelVariables").child(time()).children(variables))
        .child(structure(description, &index))
}

fn interface(element: Element, description: &ModelDescription) -> Element {
    element
        .flag("canNotUseMemoryManagementFunctions", true)
        .flag("canGetAndSetFMUstate", true)
        .flag("canSerializeFMUstate", true)
        .flag("providesDirectionalDerivative", description.capabilities.directional_derivatives)
}

/// Value reference to index in `ModelVariables`.
fn indices(description: &ModelDescription) -> HashMap<u32, u32> {
    let references = description.variables.iter().map(|variable| variable.reference);
    [TIME].into_iter().chain(references).zip(1..).collect()
}

fn time() -> Element {
    Element::new("ScalarVariable")
        .with("name", "time")
        .with("valueReference", TIME)
        .with("description", "Simulation time")
        .with("causality", Causality::Independent.word())
        .with("variability", Variability::Continuous.word())
        .child(Element::new("Real").with("unit", "s"))
}

fn scalar(variable: &Variable, state: u32) -> Element {
    let value = Element::new(common::element_name(variable, Version::Two));
    let value = match variable.kind {
        Type::Float64 => common::real_attributes(value, variable)
            .maybe("start", variable.start.map(number))
            .maybe("derivative", variable.derivative_of.map(|_| state))
            .flag("reinit", variable.reinit),
        Type::Int32 => value
            .maybe("min", variable.min)
            .maybe("max", variable.max)
            .maybe("start", variable.start),
        _ => value.maybe("start", variable.start.map(|value| value != 0.0)),
    };
    Element::new("ScalarVariable")
        .with("name", &variable.name)
        .with("valueReference", variable.reference)
        .text("description", &variable.description)
        .with("causality", variable.causality.word())
        .with("variability", variable.variability.word())
        .maybe("initial", common::initial(variable))
        .child(value)
}

fn structure(description: &ModelDescription, index: &HashMap<u32, u32>) -> Element {
    let unknown = |unknown: &Unknown| {
        let mut known: Vec<u32> = unknown.dependencies.iter().map(|known| index[known]).collect();
        known.sort_unstable();
        Element::new("Unknown")
            .with("index", index[&unknown.reference])
            .with("dependencies", common::joined(known.into_iter()))
    };
    // The standard wants initial unknowns by ascending index; the other lists have their order.
    let mut initial: Vec<&Unknown> = description.structure.initial_unknowns.iter().collect();
    initial.sort_by_key(|unknown| index[&unknown.reference]);
    let outputs = description.structure.outputs.iter().map(unknown);
    let derivatives = description.structure.derivatives.iter().map(unknown);
    Element::new("ModelStructure")
        .list(Element::new("Outputs").children(outputs))
        .list(Element::new("Derivatives").children(derivatives))
        .list(Element::new("InitialUnknowns").children(initial.into_iter().map(unknown)))
}
