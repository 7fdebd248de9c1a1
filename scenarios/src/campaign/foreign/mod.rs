//! A foreign FMU as the machine of a campaign: the closed loop of another tool, run scenario by scenario.
//!
//! Noise, faults and reference enter it under the names that an exported drive has for them, or under
//! its own where the plan says so; C_m, T and I_m come out. What it does to the process that runs it is
//! not in our hands: the command `campaign` runs it in processes of their own.

mod entering;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use drivescope_fmu::import::{Conversion, Fmu, Interface};
use drivescope_recording::{Recording, Signal};

use crate::cosimulated::{RunError, foreign_loop};
use crate::experiment::Experiment;
pub(super) use entering::Entering;

/// What comes out of the machine: names of an exported drive.
pub(super) const SHOWN: [&str; 3] = ["C_m", "T", "I_m"];

/// Units of [`SHOWN`] in a campaign on that drive.
pub(super) fn units(experiment: &Experiment) -> [&'static str; SHOWN.len()] {
    ["V", experiment.tacho_unit(), "A"]
}

/// An FMU in place of the drive.
#[derive(Debug, Clone)]
pub struct ForeignPlant {
    pub(super) fmu: Fmu,
    /// Its file as the plan names it.
    pub(super) file: String,
    /// How long a scenario of it may take.
    pub(super) time_limit: Duration,
    /// Hexadecimal digest of its file.
    pub(super) digest: String,
    /// Its names of variables, where they are not those of an exported drive.
    pub(super) names: BTreeMap<String, String>,
    /// Each parameter that the plan changes: its name there, and how values in SI become its own;
    /// nothing for noise, which is drawn outside.
    pub(super) parameters: Vec<Option<(String, Conversion)>>,
    /// How [`SHOWN`] become V, the unit of T and A.
    pub(super) shown: [Conversion; SHOWN.len()],
    /// Held by the run of an FMU of which a process may have one instance.
    pub(super) turn: Arc<Mutex<()>>,
}

impl ForeignPlant {
    /// Its file as the plan names it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// How long a scenario of it may take.
    pub fn time_limit(&self) -> Duration {
        self.time_limit
    }

    /// The FMU's own name of a variable.
    pub(super) fn own_name<'a>(&'a self, name: &'a str) -> &'a str {
        self.names.get(name).map_or(name, String::as_str)
    }

    /// Runs it over inputs in our names with those values of the plan's parameters, SI; a signal for
    /// each of [`SHOWN`], in the units of the campaign.
    ///
    /// # Errors
    /// It refuses a value or a step, or ends before its time.
    pub(super) fn run(
        &self,
        mut inputs: Recording,
        values: &[f64],
        experiment: &Experiment,
    ) -> Result<Recording, RunError> {
        for signal in &mut inputs.signals {
            signal.name = self.own_name(&signal.name).to_owned();
        }
        let set = self.parameters.iter().zip(values).filter_map(|(parameter, value)| {
            parameter.as_ref().map(|(name, to)| (name.as_str(), to.apply(*value)))
        });
        let shown = SHOWN.map(|name| self.own_name(name));
        let _turn = self.turn();
        let mut ran = foreign_loop(&self.fmu, &inputs, &shown, &set.collect::<Vec<_>>())?;
        let signals =
            ran.signals.into_iter().zip(self.shown).zip(SHOWN.iter().zip(units(experiment)));
        ran.signals = signals
            .map(|((signal, to), (name, unit))| Signal {
                name: (*name).to_owned(),
                unit: unit.to_owned(),
                values: signal.values.into_iter().map(|value| to.apply(value)).collect(),
            })
            .collect();
        Ok(ran)
    }

    fn turn(&self) -> Option<MutexGuard<'_, ()>> {
        let about = self.fmu.description().capabilities(Interface::CoSimulation);
        let alone = about.is_some_and(|can| can.only_once_per_process);
        alone.then(|| self.turn.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
