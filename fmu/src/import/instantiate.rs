//! Instances made of an FMU.

use std::ffi::CString;
use std::sync::Arc;

use super::description::Interface;
use super::error::Error;
use super::fmu::Fmu;
use super::handle::{Handle, Making};
use super::instance::Instance;
use super::logging::Log;

/// How an instance is to be made.
#[derive(Debug, Clone)]
pub struct InstanceOptions {
    /// Name of the instance, as it appears in errors and in what the FMU logs.
    pub name: String,
    /// Whether the FMU should log in all its categories. Most FMUs log errors in any case.
    pub logging: bool,
}

impl Default for InstanceOptions {
    fn default() -> Self {
        InstanceOptions { name: "instance".to_owned(), logging: false }
    }
}

impl InstanceOptions {
    /// Options for an instance of this name.
    pub fn named(name: &str) -> Self {
        InstanceOptions { name: name.to_owned(), ..InstanceOptions::default() }
    }
}

impl Fmu {
    /// Makes an instance for Co-Simulation. Many may live at once, each in its own thread, unless
    /// the FMU says otherwise.
    ///
    /// # Errors
    /// The FMU has no Co-Simulation, no binary for this platform, allows no second instance, or
    /// refuses.
    pub fn co_simulation(&self, options: &InstanceOptions) -> Result<Instance, Error> {
        self.instantiate(Interface::CoSimulation, options)
    }

    /// Makes an instance for Model Exchange, which [`Instance::step`] integrates.
    ///
    /// # Errors
    /// As [`co_simulation`](Fmu::co_simulation).
    pub fn model_exchange(&self, options: &InstanceOptions) -> Result<Instance, Error> {
        self.instantiate(Interface::ModelExchange, options)
    }

    /// Makes an instance of either interface type.
    ///
    /// # Errors
    /// As [`co_simulation`](Fmu::co_simulation).
    pub fn instantiate(
        &self,
        kind: Interface,
        options: &InstanceOptions,
    ) -> Result<Instance, Error> {
        let fmu = || self.inner.name.clone();
        let binary = self.binary(kind)?;
        let missing = binary.functions.missing_to_run(kind);
        if !missing.is_empty() {
            return Err(Error::Symbols { fmu: fmu(), missing });
        }
        let once = self.take(kind)?;
        let log = Arc::new(Log::default());
        let refused = || Error::Instantiate {
            fmu: fmu(),
            instance: options.name.clone(),
            messages: log.take(),
        };
        let text = |text: &str| CString::new(text).map_err(|_| refused());
        let (name, token) = (text(&options.name)?, text(&self.inner.description.token)?);
        let resources = self.resource_location().as_deref().map(text).transpose()?;
        let making = Making {
            kind,
            name: &name,
            token: &token,
            resources: resources.as_deref(),
            logging: options.logging,
        };
        let handle = Handle::instantiate(binary, Arc::clone(&log), making).ok_or_else(refused)?;
        Ok(Instance::new(handle, self.clone(), kind, options.name.clone(), log, once))
    }
}
