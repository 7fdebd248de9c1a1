//! One instance of an FMU: initialised, stepped, reset and freed. Both interface types have the same
//! face: a Model Exchange instance is integrated by [`step`](Instance::step).

use std::sync::Arc;

use super::description::{Interface, Version};
use super::error::Error;
use super::fmu::{Fmu, Once};
use super::handle::Handle;
use super::integrator::Integrator;
use super::logging::{Log, Message};
use super::mode::Mode;
use super::solver::Failure;
use super::state::States;
use super::status::Status;

/// An instance of an FMU. It may be sent to another thread; it is freed when it is dropped.
pub struct Instance {
    // First, so that the instance is freed while its library, folder and log still exist.
    pub(super) handle: Handle,
    pub(super) integrator: Option<Box<Integrator>>,
    pub(super) states: States,
    pub(super) mode: Mode,
    /// Simulation time, s.
    pub(super) time: f64,
    pub(super) fmi: Version,
    pub(super) fmu: Fmu,
    name: String,
    log: Arc<Log>,
    _once: Option<Once>,
}

/// Whether a run goes on after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// It does.
    Continue,
    /// The FMU asks to end the simulation here.
    Terminate,
}

impl Instance {
    pub(super) fn new(
        handle: Handle,
        fmu: Fmu,
        kind: Interface,
        name: String,
        log: Arc<Log>,
        once: Option<Once>,
    ) -> Instance {
        let integrator = (kind == Interface::ModelExchange)
            .then(|| Box::new(Integrator::new(fmu.description())));
        Instance {
            handle,
            integrator,
            states: States::default(),
            mode: Mode::Instantiated,
            time: 0.0,
            fmi: fmu.description().fmi,
            fmu,
            name,
            log,
            _once: once,
        }
    }

    /// The instance's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The FMU it is an instance of.
    pub fn fmu(&self) -> &Fmu {
        &self.fmu
    }

    /// The interface type.
    pub fn interface(&self) -> Interface {
        if self.integrator.is_some() { Interface::ModelExchange } else { Interface::CoSimulation }
    }

    /// Simulation time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Takes what the FMU has logged since the last call, oldest first.
    pub fn messages(&mut self) -> Vec<Message> {
        self.log.take()
    }

    /// Initialises: [`enter_initialization`](Instance::enter_initialization) and
    /// [`exit_initialization`](Instance::exit_initialization).
    ///
    /// # Errors
    /// The FMU cannot be initialised with the values that were set.
    pub fn initialize(
        &mut self,
        start: f64,
        stop: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), Error> {
        self.enter_initialization(start, stop, tolerance)?;
        self.exit_initialization()
    }

    /// Enters initialisation mode at time `start` (s): inputs may be set and outputs read, repeatedly.
    /// `tolerance` is relative; a Model Exchange instance is integrated with it.
    ///
    /// # Errors
    /// The FMU refuses, or the instance is running already.
    pub fn enter_initialization(
        &mut self,
        start: f64,
        stop: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), Error> {
        self.expect("initialize", &[Mode::Instantiated])?;
        self.time = start;
        let status = self.handle.enter_initialization(tolerance, start, stop);
        self.check("EnterInitializationMode", status)?;
        if let (Some(integrator), Some(tolerance)) = (&mut self.integrator, tolerance) {
            integrator.set_tolerance(tolerance);
        }
        self.mode = Mode::Initialization;
        Ok(())
    }

    /// Ends initialisation mode: from now on the instance can be stepped.
    ///
    /// # Errors
    /// The FMU finds no consistent start.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        self.expect("exit_initialization", &[Mode::Initialization])?;
        let status = self.handle.exit_initialization();
        self.check("ExitInitializationMode", status)?;
        if let Some(integrator) = &mut self.integrator {
            let started = integrator.start(&mut self.handle);
            started.map_err(|failure| self.integration_failed(failure))?;
        }
        self.mode = Mode::Stepping;
        Ok(())
    }

    /// One communication step from `time` to `time + step` (s), with inputs held.
    ///
    /// # Errors
    /// The FMU discards the step (a smaller one may do) or fails, or the integration does.
    pub fn step(&mut self, time: f64, step: f64) -> Result<Progress, Error> {
        if self.mode != Mode::Stepping {
            self.expect("step", &[Mode::Stepping])?;
        }
        self.time = time;
        let end = time + step;
        let (ends, reached) = match &mut self.integrator {
            None => {
                let may_go_back = self.states.in_use();
                let (status, ends, reached) = self.handle.do_step(time, step, may_go_back);
                match status {
                    Status::Ok | Status::Warning if !ends => (false, end),
                    // Where it ended; an FMU that does not say has done the whole step.
                    Status::Ok | Status::Warning | Status::Discard if ends => {
                        (true, if reached >= time && reached < end { reached } else { end })
                    }
                    Status::Discard => return Err(self.discarded(step, reached)),
                    bad => return Err(self.failed("DoStep", bad)),
                }
            }
            Some(integrator) => integrator
                .advance(&mut self.handle, time, end)
                .map_err(|failure| self.integration_failed(failure))?,
        };
        self.time = reached;
        Ok(if ends { Progress::Terminate } else { Progress::Continue })
    }

    /// Whether a Model Exchange instance has an event now that its next step would begin with: values
    /// that are read before it are those from before the event. Set the inputs of this time, and then
    /// [`settle`](Instance::settle).
    pub fn event_is_due(&self) -> bool {
        self.mode == Mode::Stepping
            && self.integrator.as_ref().is_some_and(|integrator| integrator.is_due(self.time))
    }

    /// Lets the events happen that are due now; a Co-Simulation instance has none outside its steps.
    ///
    /// # Errors
    /// The FMU fails, or its events do not end.
    pub fn settle(&mut self) -> Result<Progress, Error> {
        self.expect("settle", &[Mode::Stepping])?;
        let Some(integrator) = &mut self.integrator else { return Ok(Progress::Continue) };
        let ends = integrator.settle(&mut self.handle, self.time);
        let ends = ends.map_err(|failure| self.integration_failed(failure))?;
        Ok(if ends { Progress::Terminate } else { Progress::Continue })
    }

    /// Back to the state after instantiation: start values, not initialised.
    ///
    /// # Errors
    /// The FMU cannot be reset.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.callable("reset")?;
        let status = self.handle.reset();
        self.check("Reset", status)?;
        if self.integrator.is_some() {
            self.integrator = Some(Box::new(Integrator::new(self.fmu.description())));
        }
        self.mode = Mode::Instantiated;
        self.time = 0.0;
        Ok(())
    }

    /// Ends the run. Dropping the instance does this too, without reporting an error.
    ///
    /// # Errors
    /// The FMU reports that something went wrong at the end.
    pub fn terminate(&mut self) -> Result<(), Error> {
        self.expect("terminate", &[Mode::Stepping])?;
        self.mode = Mode::Terminated;
        let status = self.handle.terminate();
        self.check("Terminate", status)
    }

    pub(super) fn expect(&self, call: &'static str, modes: &[Mode]) -> Result<(), Error> {
        if modes.contains(&self.mode) {
            return Ok(());
        }
        let (fmu, instance) = (self.fmu.name().to_owned(), self.name.clone());
        Err(Error::Order { fmu, instance, call, mode: self.mode.name() })
    }

    /// After a fatal error nothing may be called.
    #[inline]
    pub(super) fn callable(&self, call: &'static str) -> Result<(), Error> {
        if self.mode != Mode::Corrupt {
            return Ok(());
        }
        let (fmu, instance) = (self.fmu.name().to_owned(), self.name.clone());
        Err(Error::Order { fmu, instance, call, mode: self.mode.name() })
    }

    #[inline]
    pub(super) fn check(&mut self, function: &'static str, status: Status) -> Result<(), Error> {
        if status.is_good() { Ok(()) } else { Err(self.failed(function, status)) }
    }

    #[cold]
    pub(super) fn failed(&mut self, function: impl Into<String>, status: Status) -> Error {
        match status {
            Status::Fatal => {
                self.mode = Mode::Corrupt;
                self.handle.abandon();
            }
            Status::Error | Status::Undefined(_) => self.mode = Mode::Failed,
            _ => {}
        }
        Error::Call {
            fmu: self.fmu.name().to_owned(),
            instance: self.name.clone(),
            function: function.into(),
            status,
            time: self.time,
            messages: self.log.take(),
        }
    }

    #[cold]
    fn discarded(&mut self, step: f64, reached: f64) -> Error {
        Error::Discard {
            fmu: self.fmu.name().to_owned(),
            instance: self.name.clone(),
            time: self.time,
            target: self.time + step,
            reached,
            messages: self.log.take(),
        }
    }

    #[cold]
    fn integration_failed(&mut self, failure: Failure) -> Error {
        match failure {
            Failure::Call(function, status) => self.failed(function, status),
            Failure::Problem(time, problem) => Error::Integration {
                fmu: self.fmu.name().to_owned(),
                instance: self.name.clone(),
                time,
                problem,
            },
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if self.mode == Mode::Stepping {
            // Nobody is left to hear of an error.
            self.handle.terminate();
        }
        if !self.handle.is_abandoned() {
            self.states.free_all(&mut self.handle);
        }
    }
}

impl std::fmt::Debug for Instance {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        let mut out = out.debug_struct("Instance");
        out.field("fmu", &self.fmu.name()).field("name", &self.name).field("mode", &self.mode);
        out.finish_non_exhaustive()
    }
}
