//! The standard's rules for the model structure (FMI 2.0 section 2.2.8, FMI 3.0 section 2.4.8).

use std::collections::HashSet;

use super::description::*;
use super::finding::Finding;

pub(super) fn check(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    let structure = &description.structure;
    let lists = [
        ("outputs", &structure.outputs),
        ("derivatives", &structure.derivatives),
        ("initial unknowns", &structure.initial_unknowns),
    ];
    for (what, list) in lists {
        findings.extend(unknowns(what, list));
    }
    let outputs = description.variables.iter().enumerate().filter(|(_, variable)| {
        variable.causality == Causality::Output
            && variable.alias_of.is_none()
            && variable.kind != Type::Clock
    });
    let outputs: HashSet<usize> = outputs.map(|(at, _)| at).collect();
    findings.extend(same_set(description, "outputs", &structure.outputs, &outputs));
    findings.extend(derivatives(description));
    let expected = initial_unknowns(description);
    findings.extend(same_set(
        description,
        "initial unknowns",
        &structure.initial_unknowns,
        &expected,
    ));
    let states = description.model_exchange.is_some() && structure.derivatives.is_empty();
    if states && structure.event_indicators > 0 && description.fmi == Version::Two {
        let text = "there are event indicators but no continuous states";
        findings.push(Finding::warning(None, text));
    }
    findings
}

/// References that exist, once each, with as many kinds as dependencies.
fn unknowns(what: &str, list: &[Unknown]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut seen = HashSet::new();
    for unknown in list {
        let mut error = |text: String| findings.push(Finding::error(unknown.place, text));
        match unknown.variable {
            None => error(format!("one of the {what} is no variable of the FMU")),
            Some(variable) if !seen.insert(variable) => {
                error(format!("one of the {what} is listed twice"));
            }
            Some(_) => {}
        }
        let dependencies = unknown.dependencies.as_ref();
        if dependencies.is_some_and(|list| list.iter().any(Option::is_none)) {
            error(format!("one of the {what} depends on what is no variable of the FMU"));
        }
        match (dependencies.map(Vec::len), unknown.kinds) {
            (Some(count), Some(kinds)) if count != kinds => {
                error(format!("{count} dependencies, but {kinds} kinds of dependency"));
            }
            (None, Some(_)) => error("kinds of dependency without dependencies".to_owned()),
            _ => {}
        }
    }
    findings
}

/// A list that must hold just these variables.
fn same_set(
    description: &Description,
    what: &str,
    list: &[Unknown],
    expected: &HashSet<usize>,
) -> Vec<Finding> {
    let listed: HashSet<usize> = list.iter().filter_map(|unknown| unknown.variable).collect();
    let mut missing: Vec<usize> = expected.difference(&listed).copied().collect();
    let mut foreign: Vec<usize> = listed.difference(expected).copied().collect();
    missing.sort_unstable();
    foreign.sort_unstable();
    let finding = |at: usize, is: &str| {
        let variable = &description.variables[at];
        Finding::error(
            variable.place,
            format!("`{}` {is} the {what} of the model structure", variable.name),
        )
    };
    let missing = missing.into_iter().map(|at| finding(at, "is missing from"));
    missing.chain(foreign.into_iter().map(|at| finding(at, "does not belong to"))).collect()
}

/// The state whose derivative a variable is.
fn state_of(description: &Description, derivative: &Variable) -> Option<usize> {
    let reference = derivative.derivative?;
    match description.fmi {
        Version::Two => {
            (reference as usize).checked_sub(1).filter(|at| *at < description.variables.len())
        }
        Version::Three => description.variables.iter().position(|v| v.reference == reference),
    }
}

fn derivatives(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    for unknown in &description.structure.derivatives {
        let Some(at) = unknown.variable else { continue };
        let variable = &description.variables[at];
        let name = &variable.name;
        let mut error = |text: String| findings.push(Finding::error(variable.place, text));
        if !variable.kind.is_float() || variable.variability != Variability::Continuous {
            error(format!("the derivative `{name}` is not continuous"));
        }
        match (variable.derivative, state_of(description, variable)) {
            (None, _) => error(format!("`{name}` does not say whose derivative it is")),
            (Some(_), None) => error(format!("`{name}` is the derivative of what is no variable")),
            (Some(_), Some(state)) => {
                let state = &description.variables[state];
                let continuous = state.variability == Variability::Continuous;
                let causal = matches!(state.causality, Causality::Local | Causality::Output);
                if !(state.kind.is_float() && continuous && causal) {
                    error(format!(
                        "the state `{}` of `{name}` is no continuous local or output",
                        state.name
                    ));
                }
            }
        }
    }
    findings
}

/// Outputs, calculated parameters, states and derivatives that the initialisation computes.
fn initial_unknowns(description: &Description) -> HashSet<usize> {
    let computed = |variable: &Variable| {
        matches!(variable.initial, Some(Initial::Approx | Initial::Calculated))
    };
    let mut expected: HashSet<usize> = description
        .variables
        .iter()
        .enumerate()
        .filter(|(_, variable)| variable.alias_of.is_none() && variable.kind != Type::Clock)
        .filter(|(_, variable)| {
            variable.causality == Causality::CalculatedParameter
                || (variable.causality == Causality::Output && computed(variable))
        })
        .map(|(at, _)| at)
        .collect();
    for at in description.structure.derivatives.iter().filter_map(|unknown| unknown.variable) {
        let derivative = &description.variables[at];
        if computed(derivative) {
            expected.insert(at);
        }
        if let Some(state) = state_of(description, derivative)
            && computed(&description.variables[state])
        {
            expected.insert(state);
        }
    }
    expected
}
