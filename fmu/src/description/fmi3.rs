//! `modelDescription.xml` of FMI 3.0 (standard 3.0.2, section 2.4).
//!
//! The model structure and derivatives refer to value references; event indicators are variables.

use super::{
    Causality, ModelDescription, TIME, Type, Unknown, Variability, Variable, Version, common,
};
use crate::vocabulary::Word;
use crate::xml::element::{Element, number};

pub(super) fn document(description: &ModelDescription, token: &str) -> Element {
    let capabilities = description.capabilities;
    let mut root = Element::new("fmiModelDescription")
        .with("fmiVersion", "3.0")
        .with("modelName", &description.name)
        .with("instantiationToken", token)
        .text("description", &description.description)
        .text("version", &description.version)
        .text("generationTool", &description.generation_tool)
        .with("variableNamingConvention", common::naming(description));
    if capabilities.model_exchange {
        let exchange = Element::new("ModelExchange");
        root = root.child(interface(exchange, description));
    }
    if capabilities.co_simulation {
        let simulation = Element::new("CoSimulation")
            .flag("canHandleVariableCommunicationStepSize", capabilities.variable_step);
        root = root.child(interface(simulation, description));
    }
    let structure = &description.structure;
    let listed = |name: &'static str, unknowns: &[Unknown]| {
        unknowns.iter().map(|unknown| element(name, unknown)).collect::<Vec<_>>()
    };
    root.child(common::units(description))
        .child(common::log_categories())
        .child(description.default_experiment.element())
        .child(
            Element::new("ModelVariables")
                .child(time())
                .children(description.variables.iter().map(variable)),
        )
        .child(
            Element::new("ModelStructure")
                .children(listed("Output", &structure.outputs))
                .children(listed("ContinuousStateDerivative", &structure.derivatives))
                .children(listed("InitialUnknown", &structure.initial_unknowns))
                .children(listed("EventIndicator", &structure.event_indicators)),
        )
}

fn interface(element: Element, description: &ModelDescription) -> Element {
    let derivatives = description.capabilities.directional_derivatives;
    element
        .with("modelIdentifier", &description.identifier)
        .flag("canGetAndSetFMUState", true)
        .flag("canSerializeFMUState", true)
        .flag("providesDirectionalDerivatives", derivatives)
        .flag("providesAdjointDerivatives", derivatives)
}

fn time() -> Element {
    Element::new("Float64")
        .with("name", "time")
        .with("valueReference", TIME)
        .with("description", "Simulation time")
        .with("causality", Causality::Independent.word())
        .with("variability", Variability::Continuous.word())
        .with("unit", "s")
}

fn variable(variable: &Variable) -> Element {
    let element = Element::new(common::element_name(variable, Version::Three))
        .with("name", &variable.name)
        .with("valueReference", variable.reference)
        .text("description", &variable.description)
        .with("causality", variable.causality.word())
        .with("variability", variable.variability.word())
        .maybe("initial", common::initial(variable));
    match variable.kind {
        Type::Float64 => common::real_attributes(element, variable)
            .maybe("start", variable.start.map(number))
            .maybe("derivative", variable.derivative_of)
            .flag("reinit", variable.reinit),
        Type::Int32 => element
            .maybe("min", variable.min)
            .maybe("max", variable.max)
            .maybe("start", variable.start),
        _ => element.maybe("start", variable.start.map(|value| value != 0.0)),
    }
}

fn element(name: &'static str, unknown: &Unknown) -> Element {
    Element::new(name)
        .with("valueReference", unknown.reference)
        .with("dependencies", common::joined(unknown.dependencies.iter().copied()))
}
