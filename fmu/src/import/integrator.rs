//! Integrates a Model Exchange instance over a communication step: Dormand-Prince 5(4) from
//! `ode_solvers` between events, time events at their time, state events located by bisection
//! (FMI 2.0 section 3.2, FMI 3.0 section 3.2).
//!
//! A time event that falls on a communication point is handled at the start of the next step, after
//! the inputs have been set: a sampled controller then sees the inputs of its sampling time.

use super::bytes::{Reader, Writer};
use super::description::{Description, Interface};
use super::handle::Handle;
use super::problem::IntegrationProblem;
use super::solver::{self, Failure, Reached, SAME_TIME_ULPS, Start};
use super::status::Status;

/// Relative tolerance if nobody states one.
const TOLERANCE: f64 = 1e-6;
/// Updates of the discrete states at one event; a proper model needs a few.
const UPDATES: usize = 1000;
/// Events in a row, each closer to the one before than [`CLOSE`] of the communication step.
const ZENO: usize = 1000;
/// Share of the communication step below which two events do not count as progress.
const CLOSE: f64 = 1e-9;

/// The state of the integration that the FMU does not hold.
#[derive(Debug, Clone)]
pub(super) struct Integrator {
    tolerance: f64,
    announces: bool,
    event_mode: bool,
    /// Event mode was entered for new inputs, and the update is still due.
    update_due: bool,
    next_event: Option<f64>,
    states: Vec<f64>,
    nominals: Vec<f64>,
    /// Event indicators after the last event.
    indicators: Vec<f64>,
    /// The solver's last step size, s: the first guess for the next step.
    guess: f64,
    ends: bool,
}

impl Integrator {
    pub(super) fn new(description: &Description) -> Integrator {
        let structure = &description.structure;
        let capabilities = description.capabilities(Interface::ModelExchange);
        Integrator {
            tolerance: description.default_experiment.tolerance.unwrap_or(TOLERANCE),
            announces: capabilities.is_some_and(|c| c.needs_completed_step),
            event_mode: false,
            update_due: false,
            next_event: None,
            states: vec![0.0; structure.derivatives.len()],
            nominals: vec![1.0; structure.derivatives.len()],
            indicators: vec![0.0; structure.event_indicators],
            guess: 0.0,
            ends: false,
        }
    }

    pub(super) fn write(&self, out: &mut Writer) {
        out.number(self.tolerance);
        for flag in [self.announces, self.event_mode, self.update_due, self.ends] {
            out.flag(flag);
        }
        out.option(self.next_event);
        out.number(self.guess);
        for numbers in [&self.states, &self.nominals, &self.indicators] {
            out.numbers(numbers);
        }
    }

    pub(super) fn read(bytes: &mut Reader) -> Option<Integrator> {
        Some(Integrator {
            tolerance: bytes.number()?,
            announces: bytes.flag()?,
            event_mode: bytes.flag()?,
            update_due: bytes.flag()?,
            ends: bytes.flag()?,
            next_event: bytes.option()?,
            guess: bytes.number()?,
            states: bytes.numbers()?,
            nominals: bytes.numbers()?,
            indicators: bytes.numbers()?,
        })
    }

    /// Whether both integrate the same FMU, as far as can be told.
    pub(super) fn fits(&self, other: &Integrator) -> bool {
        self.states.len() == other.states.len()
            && self.nominals.len() == other.nominals.len()
            && self.indicators.len() == other.indicators.len()
    }

    pub(super) fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
    }

    /// After the initialisation: the FMU is in event mode, and its first update is due.
    pub(super) fn start(&mut self, fmu: &mut Handle) -> Result<(), Failure> {
        if let Some((states, indicators)) = fmu.sizes() {
            self.states.resize(states, 0.0);
            self.nominals.resize(states, 1.0);
            self.indicators.resize(indicators, 0.0);
        }
        self.event_mode = true;
        self.update_due = true;
        good("GetNominalsOfContinuousStates", self.read_nominals(fmu))
    }

    /// Enters event mode at the present time, for inputs that are about to change.
    pub(super) fn enter_event_mode(&mut self, fmu: &mut Handle) -> Status {
        self.update_due = true;
        if self.event_mode {
            return Status::Ok;
        }
        let status = fmu.enter_event_mode();
        self.event_mode = status.is_good();
        status
    }

    /// Whether an event is due at that time: one in time, or that of the start.
    pub(super) fn is_due(&self, now: f64) -> bool {
        let resolution = SAME_TIME_ULPS * f64::EPSILON * now.abs();
        self.update_due || self.next_event.is_some_and(|event| event <= now + resolution)
    }

    /// Lets the events happen that are due at that time; whether the FMU asks to end the simulation.
    pub(super) fn settle(&mut self, fmu: &mut Handle, now: f64) -> Result<bool, Failure> {
        if self.is_due(now) {
            good("SetTime", if self.event_mode { Status::Ok } else { fmu.set_time(now) })?;
            self.handle_event(fmu, now)?;
        }
        Ok(self.ends)
    }

    /// Integrates from `time` to `end`; whether the FMU asks to end the simulation, and the time
    /// reached.
    pub(super) fn advance(
        &mut self,
        fmu: &mut Handle,
        time: f64,
        end: f64,
    ) -> Result<(bool, f64), Failure> {
        let resolution = SAME_TIME_ULPS * f64::EPSILON * time.abs().max(end.abs());
        let mut now = time;
        if self.update_due || self.next_event.is_some_and(|event| event <= now + resolution) {
            good("SetTime", if self.event_mode { Status::Ok } else { fmu.set_time(now) })?;
            self.handle_event(fmu, now)?;
        }
        let mut stuck = 0;
        while now < end - resolution && !self.ends {
            let stop = self.next_event.map_or(end, |event| event.min(end));
            let (reached, state_event) = self.integrate(fmu, now, stop)?;
            stuck = if reached > now + CLOSE * (end - time) { 0 } else { stuck + 1 };
            if stuck > ZENO {
                return Err(Failure::Problem(now, IntegrationProblem::Zeno(stuck)));
            }
            now = reached;
            let time_event = self.next_event.is_some_and(|event| event <= now + resolution);
            if state_event || (time_event && now < end - resolution) {
                self.handle_event(fmu, now)?;
            }
        }
        Ok((self.ends, if self.ends { now } else { end }))
    }

    /// Event mode: updates until the discrete states settle, then back to continuous time.
    fn handle_event(&mut self, fmu: &mut Handle, now: f64) -> Result<(), Failure> {
        if !self.event_mode {
            good("EnterEventMode", fmu.enter_event_mode())?;
        }
        let (mut nominals_changed, mut updates) = (false, 0);
        loop {
            let (status, info) = fmu.update_discrete_states();
            good("UpdateDiscreteStates", status)?;
            nominals_changed |= info.nominals_changed != 0;
            self.next_event = (info.next_time_defined != 0).then_some(info.next_time);
            self.ends |= info.terminate != 0;
            updates += 1;
            if info.again == 0 || self.ends {
                break;
            }
            if updates == UPDATES {
                return Err(Failure::Problem(now, IntegrationProblem::EventIteration(updates)));
            }
        }
        good("EnterContinuousTimeMode", fmu.enter_continuous_time_mode())?;
        (self.event_mode, self.update_due) = (false, false);
        good("GetContinuousStates", self.read_states(fmu))?;
        if nominals_changed {
            good("GetNominalsOfContinuousStates", self.read_nominals(fmu))?;
        }
        good("GetEventIndicators", self.read_indicators(fmu))
    }

    /// Integrates to `stop` or to the first event before it; the time reached, and whether an event
    /// (of an indicator or asked for by the FMU) is due there.
    fn integrate(&mut self, fmu: &mut Handle, now: f64, stop: f64) -> Result<(f64, bool), Failure> {
        let from = Start {
            time: now,
            states: &self.states,
            nominals: &self.nominals,
            indicators: &self.indicators,
            announces: self.announces,
            tolerance: self.tolerance,
            guess: self.guess,
        };
        let Reached { time, states, step, event, ends } = solver::solve_until(fmu, &from, stop)?;
        (self.states, self.guess) = (states, step);
        self.ends |= ends;
        Ok((time, event))
    }

    fn read_states(&mut self, fmu: &mut Handle) -> Status {
        if self.states.is_empty() { Status::Ok } else { fmu.continuous_states(&mut self.states) }
    }

    fn read_nominals(&mut self, fmu: &mut Handle) -> Status {
        if self.nominals.is_empty() {
            return Status::Ok;
        }
        let status = fmu.nominals(&mut self.nominals);
        // A nominal of zero or worse would make the solver's scaling meaningless.
        for nominal in &mut self.nominals {
            *nominal = nominal.abs();
            if !(nominal.is_finite() && *nominal > 0.0) {
                *nominal = 1.0;
            }
        }
        status
    }

    fn read_indicators(&mut self, fmu: &mut Handle) -> Status {
        if self.indicators.is_empty() {
            Status::Ok
        } else {
            fmu.event_indicators(&mut self.indicators)
        }
    }
}

pub(super) fn good(function: &'static str, status: Status) -> Result<(), Failure> {
    if status.is_good() { Ok(()) } else { Err(Failure::Call(function, status)) }
}
