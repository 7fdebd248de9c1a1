//! What an FMU says about itself, in plain types that are the same for FMI 2.0 and 3.0.

pub(super) use crate::position::Position;
pub(super) use crate::vocabulary::{
    Causality, DefaultExperiment, Initial, Interface, Type, Unit, Variability, Version,
};

/// One dimension of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A fixed number of elements.
    Fixed(usize),
    /// As many as the structural parameter with this value reference says.
    Structural(u32),
}

/// One variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Unique name.
    pub name: String,
    /// The handle by which the binary knows it; in FMI 2.0 unique only within its type.
    pub reference: u32,
    /// Type of its value.
    pub kind: Type,
    /// What it is for.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// How it gets its first value; `None` for the independent variable.
    pub initial: Option<Initial>,
    /// Whether the description states `initial`, or the standard's default was taken.
    pub initial_stated: bool,
    /// Unit, its own or that of its declared type.
    pub unit: Option<String>,
    /// Name of its type definition.
    pub declared_type: Option<String>,
    /// Start values as written, one an element.
    pub start: Vec<String>,
    /// Typical size, its own or that of its declared type.
    pub nominal: Option<f64>,
    /// Smallest and largest allowed value, if stated.
    pub range: (Option<f64>, Option<f64>),
    /// Dimensions of an array; empty for a scalar.
    pub dimensions: Vec<Dimension>,
    /// FMI 2.0: the index (from 1), FMI 3.0: the value reference of the state whose derivative it is.
    pub derivative: Option<u32>,
    /// What it means.
    pub description: Option<String>,
    /// The variable whose second name this is (FMI 3.0).
    pub alias_of: Option<String>,
    /// Where it is described.
    pub place: Position,
}

/// One type definition.
#[derive(Debug, Clone, PartialEq)]
pub struct TypeDefinition {
    /// Unique name.
    pub name: String,
    /// Unit of its values.
    pub unit: Option<String>,
    /// Typical size.
    pub nominal: Option<f64>,
    /// Smallest and largest allowed value, if stated.
    pub range: (Option<f64>, Option<f64>),
    /// The items of an enumeration: name and value.
    pub items: Vec<(String, i64)>,
}

/// What an FMU can do in one interface type.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Capabilities {
    /// Base name of the binary.
    pub model_identifier: String,
    /// Whether a tool must be installed.
    pub needs_execution_tool: bool,
    /// Whether a process may hold only one instance.
    pub only_once_per_process: bool,
    /// Whether the FMU state can be read and restored.
    pub state: bool,
    /// Whether the FMU state can be turned into bytes.
    pub serialize_state: bool,
    /// Whether directional derivatives are computed.
    pub directional_derivatives: bool,
    /// Co-Simulation: whether the communication step size may vary.
    pub variable_step: bool,
    /// Co-Simulation, FMI 3.0: the only step size that is possible, s.
    pub fixed_step: Option<f64>,
    /// Co-Simulation, FMI 3.0: whether event mode can be used.
    pub event_mode: bool,
    /// Model Exchange: whether each accepted integrator step must be announced.
    pub needs_completed_step: bool,
}

/// One unknown of the model structure.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// Position in [`Description::variables`]; `None` if no such variable exists.
    pub variable: Option<usize>,
    /// What it depends on, as positions; `None` if the FMU does not say (then: on everything).
    pub dependencies: Option<Vec<Option<usize>>>,
    /// How many kinds of dependency are stated.
    pub kinds: Option<usize>,
    /// Where it is described.
    pub place: Position,
}

/// Which variables are outputs, states and unknowns of the initialisation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Structure {
    pub outputs: Vec<Unknown>,
    /// Derivatives of the continuous states, in the order of the state vector.
    pub derivatives: Vec<Unknown>,
    /// Unknowns of the initialisation.
    pub initial_unknowns: Vec<Unknown>,
    /// Number of event indicators.
    pub event_indicators: usize,
}

/// What an FMU says about itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Major version of the standard.
    pub fmi: Version,
    /// The version as written (`2.0`, `3.0`).
    pub fmi_version: String,
    pub model_name: String,
    /// The token that must match the binary (FMI 2.0: the GUID).
    pub token: String,
    /// What the model is.
    pub description: Option<String>,
    /// Who made it.
    pub author: Option<String>,
    /// The model's version.
    pub version: Option<String>,
    /// The tool that exported it.
    pub generation_tool: Option<String>,
    /// Whether names follow the structured naming convention.
    pub structured_names: bool,
    /// The proposed experiment.
    pub default_experiment: DefaultExperiment,
    /// Co-Simulation, if offered.
    pub co_simulation: Option<Capabilities>,
    /// Model Exchange, if offered.
    pub model_exchange: Option<Capabilities>,
    pub log_categories: Vec<String>,
    pub units: Vec<Unit>,
    /// Type definitions.
    pub types: Vec<TypeDefinition>,
    /// Variables, in the order of the file.
    pub variables: Vec<Variable>,
    /// Model structure.
    pub structure: Structure,
}

impl Description {
    /// The variable of that name.
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name)
    }

    /// The unit definition of that name.
    pub fn unit(&self, name: &str) -> Option<&Unit> {
        self.units.iter().find(|unit| unit.name == name)
    }

    /// The unit that variables refer to by that name, defined or not: an undefined one still has a
    /// name to compare by.
    pub fn unit_of_name(&self, name: &str) -> Unit {
        let defined = self.unit(name).cloned();
        defined.unwrap_or_else(|| Unit { name: name.to_owned(), base: None })
    }

    /// The capabilities in one interface type.
    pub fn capabilities(&self, kind: Interface) -> Option<&Capabilities> {
        match kind {
            Interface::CoSimulation => self.co_simulation.as_ref(),
            Interface::ModelExchange => self.model_exchange.as_ref(),
        }
    }

    /// The interface types that are offered, Co-Simulation first.
    pub fn interfaces(&self) -> Vec<Interface> {
        let offered = |it: &Interface| self.capabilities(*it).is_some();
        [Interface::CoSimulation, Interface::ModelExchange].into_iter().filter(offered).collect()
    }

    /// The scalar numeric variables of one causality, in the order of the file.
    pub fn scalars(&self, causality: Causality) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(move |variable| {
            variable.causality == causality
                && variable.kind.is_numeric()
                && variable.dimensions.is_empty()
        })
    }

    /// Number of elements of a variable, with structural parameters at their start values.
    pub fn elements(&self, variable: &Variable) -> usize {
        self.sizes(variable).into_iter().product()
    }

    /// Sizes of its dimensions, none for a scalar; structural parameters at their start values.
    pub fn sizes(&self, variable: &Variable) -> Vec<usize> {
        let size = |dimension: &Dimension| match dimension {
            Dimension::Fixed(size) => *size,
            Dimension::Structural(reference) => self
                .variables
                .iter()
                .find(|other| other.reference == *reference)
                .and_then(|other| other.start.first())
                .and_then(|text| text.parse().ok())
                .unwrap_or(0),
        };
        variable.dimensions.iter().map(size).collect()
    }
}
