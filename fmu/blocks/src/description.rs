//! The model description of a drive, from the unit's own list of variables.

use std::collections::HashMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use drivescope_fmu::description::{
    Capabilities, Causality, DefaultExperiment, Initial, ModelDescription, Structure, Variability,
    Variable,
};
use drivescope_plant::unit::{self, Role, Unit};

use crate::reference::reference;
use crate::structure::structure;

/// Length of the default experiment, s, and its communication step without a controller, s.
const STOP_S: f64 = 5.0;
const STEP_S: f64 = 1e-3;
/// Tolerance of the default experiment.
const TOLERANCE: f64 = 1e-9;

/// The model description of the unit's drive.
pub(crate) fn describe(unit: &Unit) -> ModelDescription {
    let drive = unit.drive();
    let loop_is = if unit.controlled() { "speed control closed" } else { "open loop" };
    ModelDescription {
        name: drive.name.clone(),
        identifier: "drivescope".to_owned(),
        description: format!("Electric drive {}, {loop_is}", drive.name),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        generation_tool: concat!("drivescope ", env!("CARGO_PKG_VERSION")).to_owned(),
        capabilities: Capabilities {
            co_simulation: true,
            model_exchange: true,
            directional_derivatives: true,
            variable_step: true,
        },
        variables: unit.variables().iter().enumerate().map(variable).collect(),
        structure: known_structure(unit),
        default_experiment: DefaultExperiment {
            start: Some(0.0),
            stop: Some(STOP_S),
            tolerance: Some(TOLERANCE),
            step: Some(unit.period().unwrap_or(STEP_S)),
        },
    }
}

fn variable((place, of): (usize, &unit::Variable)) -> Variable {
    let (causality, variability, initial) = match of.role {
        Role::Input => (Causality::Input, Variability::Discrete, None),
        Role::Parameter => (Causality::Parameter, Variability::Tunable, None),
        role => {
            let causality = if role == Role::Output { Causality::Output } else { Causality::Local };
            let variability =
                if of.continuous { Variability::Continuous } else { Variability::Discrete };
            let initial = if of.start.is_some() { Initial::Exact } else { Initial::Calculated };
            (causality, variability, Some(initial))
        }
    };
    let bound = |limit: f64| Some(limit).filter(|limit| limit.is_finite());
    let mut variable = Variable::new(reference(place), &of.name, causality, variability)
        .described(&of.description);
    // A unit that the standard cannot express is left out, never guessed.
    variable = variable.clone().in_unit(&of.unit).unwrap_or(variable);
    variable.initial = initial;
    variable.start = of.start;
    variable.min = bound(of.range.0);
    variable.max = bound(of.range.1);
    variable.nominal = Some(of.nominal.abs()).filter(|nominal| *nominal > 0.0);
    variable.derivative_of = of.derivative_of.map(reference);
    variable.reinit = of.continuous && of.start.is_some();
    variable
}

/// The structure, found once a drive and process: every instance asks for the description.
fn known_structure(unit: &Unit) -> Structure {
    static KNOWN: OnceLock<Mutex<HashMap<(String, bool), Structure>>> = OnceLock::new();
    let known = KNOWN.get_or_init(Mutex::default);
    let key = (unit.drive().to_toml(), unit.controlled());
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    known.entry(key).or_insert_with(|| structure(unit)).clone()
}
