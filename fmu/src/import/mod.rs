//! The import side: any Co-Simulation or Model Exchange FMU of FMI 2.0 or 3.0, of any tool.
//!
//! [`Fmu::open`] unpacks and describes; [`Fmu::co_simulation`] and [`Fmu::model_exchange`] make
//! instances, which [`Instance::step`] moves through time; [`run`] does all of it for one experiment,
//! and [`validate`] checks an FMU against the standard's rules and tries it.
//!
//! ```no_run
//! use drivescope_fmu::import::{Fmu, InstanceOptions};
//! let fmu = Fmu::open("motor.fmu")?;
//! let mut motor = fmu.co_simulation(&InstanceOptions::named("motor"))?;
//! motor.initialize(0.0, Some(1.0), None)?;
//! let (voltage, speed) = (fmu.variable("u")?.reference, fmu.variable("omega")?.reference);
//! let mut omega = [0.0];
//! for k in 0..100 {
//!     motor.set(&[voltage], &[12.0])?;
//!     motor.step(f64::from(k) * 0.01, 0.01)?;
//!     motor.get(&[speed], &mut omega)?;
//! }
//! # Ok::<(), drivescope_fmu::import::Error>(())
//! ```
//!
//! Why not a crate. `fmi-rs` 0.3.4 comes nearest, and its source shows what is missing: errors of a
//! description name no line, an archive is unpacked without a bound on its size, entries that lead out
//! of the folder are passed over in silence. `fmi` 0.8 needs libclang to build, refuses the valid
//! Reference FMU Roberts and knows no FMU state.
//!
//! Data flow: archive -> `modelDescription.xml` -> [`Description`]; binary -> function table -> handle
//! -> [`Instance`]. All foreign code is reached through `binding.rs`.

mod access;
mod archive;
mod binary;
mod binding;
mod boolean;
mod bytes;
mod description;
mod elements;
mod error;
mod experiment;
mod finding;
mod fmu;
mod functions;
mod handle;
mod held;
mod instance;
mod instantiate;
mod integrator;
mod logging;
mod mode;
mod native;
mod parse;
mod parse_structure;
mod parse_variables;
mod problem;
mod python;
mod recorder;
mod rules;
mod rules_structure;
mod run;
mod saving;
mod solver;
mod state;
mod status;
mod unpacked;
mod validate;
mod values;

pub use drivescope_units::{BaseUnit, Conversion};

pub use access::Group;
pub use archive::Limits;
pub(crate) use archive::unpack;
pub use description::{
    Capabilities, Description, Dimension, Structure, TypeDefinition, Unknown, Variable,
};
pub use error::Error;
pub(crate) use experiment::{recordable, steps};
pub use finding::{Finding, Severity};
pub use fmu::Fmu;
pub(crate) use held::{Held, from_recorded};
pub use instance::{Instance, Progress};
pub use instantiate::InstanceOptions;
pub use logging::Message;
pub use problem::{ExperimentProblem, IntegrationProblem, UnsafeEntry, VariableProblem};
pub use run::{Ran, RunOptions, run};
pub use state::State;
pub use status::Status;
pub(crate) use unpacked::Unpacked;
pub use unpacked::remove_unpacked;
pub use validate::validate;
pub use values::Value;
pub(crate) use values::nearest;

pub use crate::position::{DocumentProblem, Position};
pub use crate::vocabulary::{
    Causality, DefaultExperiment, Initial, Interface, Type, Unit, Variability, Version, convert,
};

/// A description as it is read, for the tests of those that write one.
#[cfg(all(test, feature = "export"))]
pub(crate) fn parsed(xml: &str) -> Result<Description, Error> {
    parse::read(xml, "written.fmu")
}

/// What of that is against the standard.
#[cfg(all(test, feature = "export"))]
pub(crate) fn against_rules(description: &Description) -> Vec<Finding> {
    [rules::check(description), rules_structure::check(description)].concat()
}
