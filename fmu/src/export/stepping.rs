//! Co-Simulation: one communication step after the other
//! (FMI 2.0.4 section 4.2.2, FMI 3.0.2 section 4.2.1).

use super::Model;
use super::exchange::finite;
use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;
use crate::vocabulary::Interface;

/// Rounding that `t0 + k h` and a sum of steps may differ by, relative to the larger of the time
/// and the step: a step that begins elsewhere is off by a step, a million times more.
const SAME_TIME: f64 = 1e-9;

const STEPPING: &[Phase] = &[Phase::Step];
const ASKED: &[Phase] = &[Phase::Step, Phase::Terminated, Phase::Failed];

impl<M: Model> Instance<M> {
    /// One step from `t` to `t + h`.
    pub fn do_step(&mut self, t: f64, h: f64) -> Result<(), Refusal> {
        self.require_interface(Interface::CoSimulation)?;
        self.require(STEPPING)?;
        finite("the communication point", t)?;
        finite("the communication step size", h)?;
        if h <= 0.0 {
            return Err(Refusal::StepSize(h));
        }
        let slack = SAME_TIME * t.abs().max(h);
        if (t - self.run.time).abs() > slack {
            return Err(Refusal::CommunicationPoint { given: t, own: self.run.time });
        }
        let end = t + h;
        if let Some(stop) = self.run.stop.filter(|stop| end > stop + slack) {
            return Err(Refusal::BeyondStop { end, stop });
        }
        self.model.step(t, h).map_err(|error| Refusal::ending("step", &error))?;
        self.run.time = end;
        Ok(())
    }

    /// The present time, s.
    pub fn time(&self) -> f64 {
        self.run.time
    }

    /// FMI 2.0 status information, which is about asynchronous steps and rejected ones: a step of
    /// ours is done when it returns, so only `lastSuccessfulTime` and `terminated` have a value.
    pub fn last_successful_time(&self, kind: i32) -> Result<f64, Refusal> {
        self.status_asked()?;
        if kind == LAST_SUCCESSFUL_TIME { Ok(self.run.time) } else { Err(Refusal::NoStatus(kind)) }
    }

    /// Whether the FMU wants the simulation to end may be asked; it never does.
    pub fn never_terminates(&self, kind: i32) -> Result<(), Refusal> {
        self.status_asked()?;
        if kind == TERMINATED { Ok(()) } else { Err(Refusal::NoStatus(kind)) }
    }

    /// Every other status information.
    pub fn no_status(&self, kind: i32) -> Result<(), Refusal> {
        self.status_asked()?;
        Err(Refusal::NoStatus(kind))
    }

    fn status_asked(&self) -> Result<(), Refusal> {
        self.require_interface(Interface::CoSimulation)?;
        self.require(ASKED)
    }
}

/// `fmi2LastSuccessfulTime` of `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: i32 = 2;
/// `fmi2Terminated` of `fmi2StatusKind`.
const TERMINATED: i32 = 3;
