//! An instance: the model, where it stands in the standard's state machine, and its log.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::Model;
use super::phase::{Phase, Run};
use super::refusal::{Refusal, Status};
use super::snapshots::SavedStates;
use super::table::Table;
use crate::description::{LogCategory, Version};
use crate::vocabulary::Interface;

/// A message for the importer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    /// Status of the call.
    pub(super) status: Status,
    /// Log category.
    pub(super) category: LogCategory,
    /// One line.
    pub(super) text: String,
}

/// Which log categories are on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Logging {
    on: [bool; LogCategory::ALL.len()],
}

impl Logging {
    /// All categories on or off.
    pub(super) fn all(on: bool) -> Self {
        Self { on: [on; LogCategory::ALL.len()] }
    }

    /// What an instance begins with: FMI's `loggingOn` is about debugging, and what went wrong is said
    /// in any case. A warning of every sample is not.
    pub(super) fn initial(on: bool) -> Self {
        let mut logging = Self::all(true);
        logging.switch(LogCategory::Events, on);
        logging.switch(LogCategory::StatusWarning, on);
        logging
    }

    pub(super) fn switch(&mut self, category: LogCategory, on: bool) {
        match category {
            LogCategory::All => *self = Self::all(on),
            one => self.on[one as usize] = on,
        }
    }

    pub(super) fn wants(self, category: LogCategory) -> bool {
        self.on[category as usize]
    }
}

/// An instance of an FMU.
#[derive(Debug)]
pub struct Instance<M: Model> {
    pub(super) version: Version,
    pub(super) interface: Interface,
    pub(super) table: Table,
    pub(super) model: M,
    /// As instantiated: what a reset returns to.
    pub(super) pristine: M,
    pub(super) run: Run,
    pub(super) saved: SavedStates<M>,
    pub(super) logging: Logging,
    pub(super) messages: Vec<Message>,
}

impl<M: Model> Instance<M> {
    /// Does one call's work and turns its outcome into a status and messages.
    pub(super) fn answer(
        &mut self,
        version: Version,
        function: &'static str,
        work: impl FnOnce(&mut Self) -> Result<(), Refusal>,
    ) -> Status {
        let outcome = if self.run.phase == Phase::Lost {
            Err(Refusal::Lost)
        } else if self.version != version {
            Err(Refusal::OtherVersion(self.version))
        } else {
            // A panic may leave the model half-changed: nothing but the free is allowed then.
            catch_unwind(AssertUnwindSafe(|| work(self))).unwrap_or_else(|panic| {
                self.run.phase = Phase::Lost;
                Err(Refusal::Panicked(panic_text(panic.as_ref())))
            })
        };
        let Err(refusal) = outcome else { return Status::Ok };
        if matches!(refusal, Refusal::Model { ends_run: true, .. }) {
            self.run.phase = Phase::Failed;
        }
        let status = refusal.status();
        self.log(status, || format!("{function}: {refusal}"));
        status
    }

    /// Messages since the last call of this.
    pub(super) fn take_messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.messages)
    }

    /// Records a message if its category is on.
    pub(super) fn log(&mut self, status: Status, text: impl FnOnce() -> String) {
        let category = status.category();
        if self.logging.wants(category) {
            self.messages.push(Message { status, category, text: text() });
        }
    }

    pub(super) fn require(&self, allowed: &'static [Phase]) -> Result<(), Refusal> {
        if allowed.contains(&self.run.phase) {
            return Ok(());
        }
        Err(Refusal::WrongPhase { now: self.run.phase, allowed })
    }

    pub(super) fn require_interface(&self, interface: Interface) -> Result<(), Refusal> {
        if self.interface == interface {
            return Ok(());
        }
        Err(Refusal::OtherInterface(self.interface))
    }
}

/// What a panic said.
pub(super) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("panic without a message")
        .to_owned()
}
