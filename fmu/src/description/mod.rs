//! What an FMU tells an importer about itself: variables, units, structure, capabilities.
//!
//! One [`ModelDescription`] becomes the `modelDescription.xml` of FMI 2.0 and of FMI 3.0
//! ([`ModelDescription::to_xml`]), and the running FMU answers from the same value, so that the
//! file and the library cannot disagree. Terms are those of the FMI standard 2.0.4 and 3.0.2.

mod check;
#[cfg(feature = "export")]
mod common;
#[cfg(feature = "export")]
mod fmi2;
#[cfg(feature = "export")]
mod fmi3;
mod variable;

pub use check::DescriptionError;
pub use drivescope_units::UnitError;
pub use variable::Variable;

pub use crate::vocabulary::{
    Causality, DefaultExperiment, Initial, Type, Unit, Variability, Version,
};

/// Value reference of the independent variable `time` \[s\], which every description has without
/// listing it. The model's own references start at 1.
pub const TIME: u32 = 0;

/// Everything that the two model description files say.
///
/// The order of [`Structure::derivatives`] is the order of the continuous states.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDescription {
    /// Name shown to users (`modelName`).
    pub name: String,
    /// File name of the shared library without extension; a C identifier (`modelIdentifier`).
    pub identifier: String,
    /// One sentence for users.
    pub description: String,
    /// Version of the model.
    pub version: String,
    /// The tool that made the FMU, with its version.
    pub generation_tool: String,
    /// Interfaces and optional functions.
    pub capabilities: Capabilities,
    /// All variables but `time`, in the order in which they are shown.
    pub variables: Vec<Variable>,
    /// Outputs, derivatives, event indicators, initial unknowns and what they depend on.
    pub structure: Structure,
    /// What an importer simulates when it is told nothing.
    pub default_experiment: DefaultExperiment,
}

/// Interfaces and optional functions of an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// The FMU integrates itself.
    pub co_simulation: bool,
    /// The importer integrates.
    pub model_exchange: bool,
    /// Directional derivatives (and with them adjoint derivatives) are answered.
    pub directional_derivatives: bool,
    /// Communication steps may differ from the default experiment's step.
    pub variable_step: bool,
}

/// The model structure: unknowns in order, each with what it depends on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Structure {
    /// Every variable with causality output.
    pub outputs: Vec<Unknown>,
    /// Derivatives of the continuous states.
    pub derivatives: Vec<Unknown>,
    pub event_indicators: Vec<Unknown>,
    /// What initialization computes: outputs, states and derivatives whose initial is not exact,
    /// and calculated parameters.
    pub initial_unknowns: Vec<Unknown>,
}

/// An unknown of the model structure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Value reference of the unknown.
    pub reference: u32,
    /// Value references of the knowns on which it directly depends: inputs, states and (for
    /// initial unknowns) parameters and exact variables; [`TIME`] where it depends on time.
    pub dependencies: Vec<u32>,
}

/// Log categories of every FMU of ours, with the standard's names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LogCategory {
    /// Events, time events and changes of mode.
    Events,
    /// Calls answered with a warning.
    StatusWarning,
    /// Calls answered with discard.
    StatusDiscard,
    /// Calls answered with an error.
    StatusError,
    /// Calls that ended the instance.
    StatusFatal,
    /// All of these.
    All,
}

impl LogCategory {
    /// Every category, in the order of the model description.
    pub const ALL: [Self; 6] = [
        Self::Events,
        Self::StatusWarning,
        Self::StatusDiscard,
        Self::StatusError,
        Self::StatusFatal,
        Self::All,
    ];

    /// The standard's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Events => "logEvents",
            Self::StatusWarning => "logStatusWarning",
            Self::StatusDiscard => "logStatusDiscard",
            Self::StatusError => "logStatusError",
            Self::StatusFatal => "logStatusFatal",
            Self::All => "logAll",
        }
    }

    /// What is logged under it, for users.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Events => "Events, event iterations and changes of mode",
            Self::StatusWarning => "Calls answered with a warning",
            Self::StatusDiscard => "Calls answered with discard",
            Self::StatusError => "Calls answered with an error",
            Self::StatusFatal => "Calls that ended the instance",
            Self::All => "All messages",
        }
    }
}

impl ModelDescription {
    /// The variable with this value reference; `None` for [`TIME`] and unknown references.
    pub fn variable(&self, reference: u32) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.reference == reference)
    }

    /// Value references of the continuous states, in the order of the derivatives.
    pub fn states(&self) -> Vec<u32> {
        let derivatives = self.structure.derivatives.iter();
        derivatives.filter_map(|unknown| self.variable(unknown.reference)?.derivative_of).collect()
    }
}

#[cfg(feature = "export")]
impl ModelDescription {
    /// The `modelDescription.xml` of one version, UTF-8.
    ///
    /// # Errors
    ///
    /// What the standard does not allow, with the variable's name.
    pub fn to_xml(&self, version: Version) -> Result<String, DescriptionError> {
        self.check()?;
        Ok(self.document(version, &self.token()))
    }

    /// The GUID of FMI 2.0 and instantiation token of FMI 3.0: an RFC 9562 version 5 UUID of the
    /// description's content. The library computes it from the model that it made and refuses to
    /// run under any other description.
    pub fn token(&self) -> String {
        let content = self.document(Version::Three, "");
        format!("{{{}}}", uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, content.as_bytes()))
    }

    /// Whether every name is a "structured" one of the standard (`coulomb.T_c`, `der(omega)`).
    fn names_are_structured(&self) -> bool {
        self.variables.iter().all(|variable| variable::is_structured(&variable.name))
    }

    fn document(&self, version: Version, token: &str) -> String {
        match version {
            Version::Two => fmi2::document(self, token),
            Version::Three => fmi3::document(self, token),
        }
        .to_xml()
    }
}

#[cfg(all(test, feature = "export"))]
pub(crate) mod tests;
