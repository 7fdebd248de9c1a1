//! A system description as a file says it, whichever form the file has, and the system made of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use drivescope_recording::Recording;

use crate::import::{
    Conversion, ExperimentProblem, Fmu, InstanceOptions, Interface, Unit, Unpacked, Value, convert,
};

use super::connector::ConnectorEntry;
use super::error::{Error, ReadError};
use super::fmu_component::FmuComponent;
use super::system::{Algorithm, Experiment, System};
use crate::position::{DocumentProblem, Position};

/// Steps of a run for which nobody states a step size.
const STEPS: f64 = 1000.0;

/// A system description. Fields may be changed before the system is built.
#[derive(Debug)]
pub struct Document {
    /// The file it was read from.
    pub path: PathBuf,
    /// Start time, s.
    pub start: Option<f64>,
    /// Stop time, s; without it the latest one that an FMU proposes.
    pub stop: Option<f64>,
    /// Communication step size, s; without it the smallest one that an FMU proposes, or a
    /// thousandth of the run.
    pub step: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// How values are exchanged.
    pub algorithm: Algorithm,
    /// Whether a discarded step takes all components back to its start.
    pub rollback: bool,
    pub(super) components: Vec<ComponentEntry>,
    pub(super) connections: Vec<ConnectionEntry>,
    pub(super) inputs: Vec<InputEntry>,
    pub(super) records: Vec<(String, Position)>,
    /// Outputs of the system: the port behind each, and what the file says about it.
    pub(super) outputs: Vec<(String, ConnectorEntry)>,
    /// The unpacked package of an `.ssp`, in which the FMUs are.
    pub(super) package: Option<Unpacked>,
}

#[derive(Debug)]
pub(super) struct ComponentEntry {
    pub(super) name: String,
    pub(super) fmu: PathBuf,
    /// Co-Simulation if it is offered, unless stated.
    pub(super) kind: Option<Interface>,
    pub(super) parameters: Vec<ParameterEntry>,
    /// What the file says about ports; empty where it says nothing.
    pub(super) connectors: Vec<ConnectorEntry>,
    pub(super) place: Position,
}

/// A value that is set before the run.
#[derive(Debug, PartialEq)]
pub(super) struct ParameterEntry {
    pub(super) name: String,
    pub(super) value: Value,
    /// The unit in which it is stated; none for that of the variable.
    pub(super) unit: Option<Unit>,
    pub(super) place: Position,
}

#[derive(Debug)]
pub(super) struct ConnectionEntry {
    pub(super) from: String,
    pub(super) to: String,
    pub(super) scaling: Conversion,
    /// Whether units are converted before the scaling.
    pub(super) converts: bool,
    pub(super) place: Position,
}

#[derive(Debug)]
pub(super) struct InputEntry {
    pub(super) recording: PathBuf,
    pub(super) signal: String,
    pub(super) to: String,
    pub(super) place: Position,
}

impl Document {
    pub(super) fn empty(path: &Path) -> Document {
        Document {
            path: path.to_owned(),
            start: None,
            stop: None,
            step: None,
            tolerance: None,
            algorithm: Algorithm::default(),
            rollback: false,
            components: Vec::new(),
            connections: Vec::new(),
            inputs: Vec::new(),
            records: Vec::new(),
            outputs: Vec::new(),
            package: None,
        }
    }

    /// Opens the FMUs and builds the system. `read` reads a recording. Where nothing is said about
    /// what to record, all outputs are recorded.
    ///
    /// # Errors
    /// An FMU or recording that cannot be used; a connection, parameter or experiment that is wrong,
    /// with line and column.
    pub fn build(
        &self,
        read: &dyn Fn(&Path) -> Result<Recording, ReadError>,
    ) -> Result<System<'static>, Error> {
        let mut fmus: Vec<(PathBuf, Fmu)> = Vec::new();
        let mut opened = Vec::new();
        for entry in &self.components {
            // Components of one FMU share the unpacked files and the loaded library.
            let known = fmus.iter().find(|(path, _)| *path == entry.fmu);
            let fmu = match known {
                Some((_, fmu)) => fmu.clone(),
                None => Fmu::open(&entry.fmu).map_err(|error| self.wrong(entry.place, error))?,
            };
            fmus.push((entry.fmu.clone(), fmu.clone()));
            opened.push(fmu);
        }
        let mut system = System::new(self.experiment(&opened)?);
        for (entry, fmu) in self.components.iter().zip(&opened) {
            let kinds = fmu.description().interfaces();
            let kind = entry.kind.or(kinds.first().copied()).unwrap_or(Interface::CoSimulation);
            let instance = fmu.instantiate(kind, &InstanceOptions::named(&entry.name));
            let mut instance = instance.map_err(|error| self.wrong(entry.place, error))?;
            for connector in &entry.connectors {
                let checked = connector.check(fmu.description());
                checked.map_err(|problem| self.wrong(connector.place, problem))?;
            }
            for parameter in &entry.parameters {
                let value = parameter.in_unit_of(fmu);
                let value = value.map_err(|problem| self.wrong(parameter.place, problem))?;
                let set = instance.set_value(&parameter.name, &value);
                set.map_err(|error| self.wrong(parameter.place, error))?;
            }
            let added = system.add(&entry.name, FmuComponent::new(instance));
            added.map_err(|error| self.wrong(entry.place, error))?;
        }
        for entry in &self.connections {
            let connected = if entry.converts {
                system.connect_scaled(&entry.from, &entry.to, entry.scaling)
            } else {
                system.connect_unconverted(&entry.from, &entry.to, entry.scaling)
            };
            connected.map_err(|error| self.wrong(entry.place, error))?;
        }
        let mut recordings: Vec<(PathBuf, Arc<Recording>)> = Vec::new();
        for entry in &self.inputs {
            let known = recordings.iter().find(|(path, _)| *path == entry.recording);
            let recording = match known {
                Some((_, recording)) => Arc::clone(recording),
                None => Arc::new(read(&entry.recording).map_err(|source| Error::Recording {
                    path: entry.recording.clone(),
                    source,
                })?),
            };
            recordings.push((entry.recording.clone(), Arc::clone(&recording)));
            let driven = system.input(&recording, &entry.signal, &entry.to);
            driven.map_err(|error| self.wrong(entry.place, error))?;
        }
        for (port, place) in &self.records {
            system.record(port).map_err(|error| self.wrong(*place, error))?;
        }
        for (port, connector) in &self.outputs {
            let found = self.components.iter().zip(&opened).find_map(|(entry, fmu)| {
                let variable = port.strip_prefix(&entry.name)?.strip_prefix('.')?;
                Some((fmu.description().variable(variable)?, fmu.description()))
            });
            if let Some((variable, fmu)) = found {
                let checked = connector.shows(variable, fmu);
                checked.map_err(|problem| self.wrong(connector.place, problem))?;
            }
        }
        if self.records.is_empty() {
            system.record_all();
        }
        Ok(system)
    }

    fn experiment(&self, fmus: &[Fmu]) -> Result<Experiment, Error> {
        let proposed = || fmus.iter().map(|fmu| fmu.description().default_experiment);
        let start = self.start.unwrap_or(0.0);
        let stop = self.stop.or_else(|| proposed().filter_map(|e| e.stop).reduce(f64::max));
        let stop = stop.ok_or(Error::Experiment { problem: ExperimentProblem::NoStop })?;
        let step = self.step.or_else(|| proposed().filter_map(|e| e.step).reduce(f64::min));
        let experiment = Experiment {
            tolerance: self.tolerance,
            algorithm: self.algorithm.clone(),
            rollback: self.rollback,
            ..Experiment::new(start, stop, step.unwrap_or((stop - start) / STEPS))
        };
        experiment.steps().map_err(|problem| Error::Experiment { problem })?;
        Ok(experiment)
    }

    pub(super) fn wrong(&self, place: Position, error: impl std::fmt::Display) -> Error {
        wrong(&self.path, place, error.to_string())
    }
}

impl ParameterEntry {
    /// The value in the unit of the FMU's variable; why it cannot be given in it.
    fn in_unit_of(&self, fmu: &Fmu) -> Result<Value, String> {
        let (Some(unit), Value::Number(number)) = (&self.unit, &self.value) else {
            return Ok(self.value.clone());
        };
        let variable = fmu.variable(&self.name).map_err(|error| error.to_string())?;
        let own = variable.unit.as_ref().map(|name| fmu.description().unit_of_name(name));
        let conversion = convert(Some(unit), own.as_ref()).ok_or_else(|| {
            format!(
                "parameter `{}` is given in `{}`, and the FMU's variable is in `{}`: these do not \
                 convert; give it in a unit of that quantity, or define the unit",
                self.name,
                unit.name,
                own.as_ref().map_or("1", |own| &own.name),
            )
        })?;
        Ok(Value::Number(conversion.apply(*number)))
    }
}

/// A problem at a position of a file.
pub(super) fn wrong(path: &Path, position: Position, text: String) -> Error {
    Error::Document { path: path.to_owned(), problem: DocumentProblem { position, text } }
}
