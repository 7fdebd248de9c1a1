//! Instantiation, initialization, terminate, reset and the choice of log categories
//! (FMI 2.0.4 sections 2.1.5 to 2.1.6, FMI 3.0.2 sections 2.3.1 to 2.3.4).

use std::path::Path;

use super::Model;
use super::instance::{Instance, Logging};
use super::phase::{Phase, Run};
use super::refusal::{Refusal, Status};
use super::snapshots::SavedStates;
use super::table::Table;
use crate::description::{LogCategory, Version};
use crate::vocabulary::Interface;

/// What an importer tells about the run.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    tolerance: Option<f64>,
    start: f64,
    stop: Option<f64>,
}

impl Experiment {
    /// Relative tolerance and stop time \[s\] as far as defined, start time \[s\].
    pub fn new(tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Self {
        Self { tolerance, start, stop }
    }
}

const BEFORE: &[Phase] = &[Phase::Instantiated];
const INITIALIZING: &[Phase] = &[Phase::Initialization];
const RUNNING: &[Phase] = &[Phase::Event, Phase::Continuous, Phase::Step];

impl<M: Model> Instance<M> {
    /// A new instance in state Instantiated.
    pub fn new(
        version: Version,
        interface: Interface,
        name: &str,
        token: &str,
        resources: Option<&Path>,
        logging: bool,
    ) -> Result<Self, Refusal> {
        if name.trim().is_empty() {
            return Err(Refusal::EmptyName);
        }
        let model = M::instantiate(resources).map_err(|e| Refusal::model("instantiate", &e))?;
        let description = model.description();
        let offered = match interface {
            Interface::CoSimulation => description.capabilities.co_simulation,
            Interface::ModelExchange => description.capabilities.model_exchange,
        };
        let table = Table::new(description)?;
        if token != table.token {
            return Err(Refusal::Token { given: token.to_owned(), own: table.token });
        }
        if !offered {
            return Err(Refusal::NotOffered(match interface {
                Interface::CoSimulation => "Co-Simulation",
                Interface::ModelExchange => "Model Exchange",
            }));
        }
        Ok(Self {
            version,
            interface,
            table,
            pristine: model.clone(),
            model,
            run: Run::NEW,
            saved: SavedStates::default(),
            logging: Logging::initial(logging),
            messages: Vec::new(),
        })
    }

    /// Start and stop time of the run.
    pub fn setup_experiment(&mut self, experiment: Experiment) -> Result<(), Refusal> {
        self.require(BEFORE)?;
        let Experiment { tolerance, start, stop } = experiment;
        let sound = start.is_finite()
            && stop.is_none_or(|stop| stop >= start)
            && tolerance.is_none_or(|tolerance| tolerance > 0.0 && tolerance.is_finite());
        if !sound {
            return Err(Refusal::Experiment { start, stop, tolerance });
        }
        self.run.time = start;
        self.run.stop = stop;
        self.run.has_experiment = true;
        Ok(())
    }

    /// From Instantiated to Initialization Mode.
    pub fn enter_initialization(&mut self) -> Result<(), Refusal> {
        self.require(BEFORE)?;
        if !self.run.has_experiment {
            return Err(Refusal::NoExperiment);
        }
        self.run.phase = Phase::Initialization;
        Ok(())
    }

    /// To Event Mode (Model Exchange) or Step Mode (Co-Simulation).
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.require(INITIALIZING)?;
        let start = self.run.time;
        self.model.initialize(start).map_err(|error| Refusal::ending("initialize", &error))?;
        self.run.phase = match self.interface {
            Interface::ModelExchange => Phase::Event,
            Interface::CoSimulation => Phase::Step,
        };
        self.log(Status::Ok, || format!("initialized at {start} s"));
        Ok(())
    }

    /// Ends the run; values can still be read.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.require(RUNNING)?;
        self.run.phase = Phase::Terminated;
        let time = self.run.time;
        self.log(Status::Ok, || format!("terminated at {time} s"));
        Ok(())
    }

    /// Back to Instantiated with all start values.
    pub fn reset(&mut self) -> Result<(), Refusal> {
        self.model = self.pristine.clone();
        self.run = Run::NEW;
        self.log(Status::Ok, || "reset to the start values".to_owned());
        Ok(())
    }

    /// On with names: only these are on. Off with names: these are off. Without names: all.
    pub fn set_debug_logging(&mut self, on: bool, names: &[&str]) -> Result<(), Refusal> {
        let known = |name: &&str| {
            let category = LogCategory::ALL.into_iter().find(|category| category.name() == *name);
            category.ok_or_else(|| Refusal::UnknownCategory((*name).to_owned()))
        };
        let categories = names.iter().map(known).collect::<Result<Vec<_>, _>>()?;
        if on || categories.is_empty() {
            self.logging = Logging::all(on && categories.is_empty());
        }
        for category in categories {
            self.logging.switch(category, on);
        }
        Ok(())
    }
}
