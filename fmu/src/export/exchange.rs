//! Model Exchange: modes, time, states, derivatives, event indicators
//! (FMI 2.0.4 section 3.2, FMI 3.0.2 section 3.2).

use super::instance::Instance;
use super::phase::Phase;
use super::refusal::same_length;
use super::refusal::{Refusal, Status};
use super::{Continuous, DiscreteUpdate, Model};
use crate::vocabulary::Interface;

const EVENT: &[Phase] = &[Phase::Event];
const CONTINUOUS: &[Phase] = &[Phase::Continuous];
const EVALUATED: &[Phase] = &[Phase::Event, Phase::Continuous];
const READABLE: &[Phase] =
    &[Phase::Initialization, Phase::Event, Phase::Continuous, Phase::Terminated, Phase::Failed];

impl<M: Model> Instance<M> {
    /// To Event Mode.
    pub fn enter_event_mode(&mut self) -> Result<(), Refusal> {
        self.exchange(EVALUATED)?;
        self.run.phase = Phase::Event;
        let time = self.run.time;
        self.log(Status::Ok, || format!("event mode at {time} s"));
        Ok(())
    }

    /// One event iteration.
    pub fn update_discrete(&mut self) -> Result<DiscreteUpdate, Refusal> {
        let update = self.exchange(EVENT)?.update_discrete();
        let update = update.map_err(|error| Refusal::ending("event iteration", &error))?;
        let time = self.run.time;
        self.log(Status::Ok, || {
            let DiscreteUpdate { again, states_changed, next_event } = update;
            let next = next_event.map_or("no time event".into(), |t| format!("time event at {t} s"));
            format!("event iteration at {time} s: again {again}, states changed {states_changed}, {next}")
        });
        Ok(update)
    }

    /// To Continuous-Time Mode.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), Refusal> {
        self.exchange(EVENT)?;
        self.run.phase = Phase::Continuous;
        Ok(())
    }

    /// No step ever asks for event mode: that flag of the description says so.
    pub fn completed_integrator_step(&mut self) -> Result<(), Refusal> {
        self.exchange(CONTINUOUS).map(|_| ())
    }

    /// Sets the time, s.
    pub fn set_time(&mut self, time: f64) -> Result<(), Refusal> {
        let model = self.exchange(EVALUATED)?;
        finite("time", time)?;
        model.set_time(time);
        self.run.time = time;
        Ok(())
    }

    /// Sets the continuous states.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Refusal> {
        let expected = self.table.nominals.len();
        let model = self.exchange(CONTINUOUS)?;
        same_length(states.len(), expected)?;
        for state in states {
            finite("a continuous state", *state)?;
        }
        model.set_states(states);
        Ok(())
    }

    /// The continuous states.
    pub fn states(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        copy(self.exchange(READABLE)?.states(), values)
    }

    /// Nominal values of the continuous states.
    pub fn nominals(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        self.exchange(READABLE)?;
        copy(&self.table.nominals, values)
    }

    /// Derivatives of the continuous states.
    pub fn derivatives(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        let derivatives = self.exchange(READABLE)?.derivatives();
        copy(derivatives.map_err(|error| Refusal::model("derivatives", &error))?, values)?;
        all_finite("a derivative", values)
    }

    /// Event indicators.
    pub fn event_indicators(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        let indicators = self.exchange(READABLE)?.event_indicators();
        copy(indicators.map_err(|error| Refusal::model("event indicators", &error))?, values)?;
        all_finite("an event indicator", values)
    }

    /// Numbers of continuous states and of event indicators.
    pub fn counts(&self) -> Result<(usize, usize), Refusal> {
        self.require_interface(Interface::ModelExchange)?;
        Ok((self.table.nominals.len(), self.table.indicators))
    }

    fn exchange(
        &mut self,
        allowed: &'static [Phase],
    ) -> Result<&mut dyn Continuous<Error = M::Error>, Refusal> {
        self.require_interface(Interface::ModelExchange)?;
        self.require(allowed)?;
        self.model.continuous().ok_or(Refusal::NotOffered("Model Exchange"))
    }
}

fn copy(from: &[f64], to: &mut [f64]) -> Result<(), Refusal> {
    same_length(to.len(), from.len())?;
    to.copy_from_slice(from);
    Ok(())
}

pub(super) fn finite(what: &str, value: f64) -> Result<(), Refusal> {
    if value.is_finite() { Ok(()) } else { Err(Refusal::Value { what: what.to_owned(), value }) }
}

fn all_finite(what: &'static str, values: &[f64]) -> Result<(), Refusal> {
    if values.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(Refusal::NotFinite(what))
}
