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
//! Data flow: archive -> `modelDescription.xml` -> [`Description`]; binary -> function table -> handle
//! -> [`Instance`]. All foreign code is reached through `binding.rs`.

mod access;
mod archive;
mod binary;
mod binding;
mod bytes;
mod description;
mod elements;
mod error;
mod experiment;
mod fmu;
mod functions;
mod handle;
mod held;
mod instance;
mod integrator;
mod logging;
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
mod solver;
mod state;
mod status;
mod units;
mod unpacked;
mod validate;
mod values;
pub(crate) mod xml;

pub use access::Group;
pub use archive::Limits;
pub(crate) use archive::unpack;
pub use description::{
    Capabilities, Causality, DefaultExperiment, Description, Dimension, FmiVersion, Initial, Kind,
    Place, Structure, Type, TypeDefinition, Unknown, Variability, Variable,
};
pub use error::Error;
pub(crate) use experiment::{recordable, steps};
pub use fmu::{Fmu, InstanceOptions};
pub(crate) use held::{Held, from_recorded};
pub use instance::{Instance, Progress};
pub use logging::Message;
pub(crate) use parse::read_unit;
pub use problem::{
    ExperimentProblem, IntegrationProblem, UnsafeEntry, VariableProblem, XmlProblem,
};
pub use run::{Ran, RunOptions, run};
pub use state::State;
pub use status::Status;
pub use units::{BaseUnit, Conversion, Unit, convert};
pub(crate) use unpacked::Unpacked;
pub use unpacked::remove_unpacked;
pub use validate::{Finding, Severity, validate};
pub use values::Value;
pub(crate) use values::nearest;
