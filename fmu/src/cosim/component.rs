//! What takes part in a co-simulation.

use crate::import::{self, Progress, Unit};

/// What kind of value a port carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortKind {
    /// A floating-point number, with a unit.
    Float,
    /// A whole number.
    Integer,
    /// 0 or 1.
    Boolean,
    /// The value of an enumeration's item.
    Enumeration,
}

/// One input or output of a component.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Name, unique among the component's inputs or outputs.
    pub name: String,
    /// Kind of its values.
    pub kind: PortKind,
    /// Unit of its values, if stated.
    pub unit: Option<Unit>,
}

/// The inputs and outputs of a component.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ports {
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    /// Inputs and outputs that are no scalar numbers, each with what it is: nothing connects them.
    pub others: Vec<(String, String)>,
    /// For each output the inputs that act on it at once; `None` if unknown (then: all of them).
    pub feedthrough: Vec<Option<Vec<usize>>>,
    /// Units that the component can convert from, beside those of its ports.
    pub units: Vec<Unit>,
}

/// The time of a run, all in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start time.
    pub start: f64,
    /// Stop time.
    pub stop: f64,
    /// Relative tolerance for what a component solves itself, if stated.
    pub tolerance: Option<f64>,
}

/// The three parts of the initialisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    /// It begins: back to the start state.
    Enter(Window),
    /// Inputs have changed: compute the outputs at the start. Any number of times.
    Update,
    /// Inputs are final: compute the outputs, get ready to step.
    Exit,
}

/// Why a component failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// An FMU did.
    #[error(transparent)]
    Fmu(Box<import::Error>),
    /// Another participant did, for a reason of its own.
    #[error(transparent)]
    Participant(#[from] Box<dyn std::error::Error + Send + Sync>),
}

impl From<import::Error> for Failure {
    fn from(error: import::Error) -> Failure {
        Failure::Fmu(Box::new(error))
    }
}

/// A participant of a co-simulation.
///
/// `inputs` and `outputs` are always those that were selected, in the order of the selection.
pub trait Component: Send {
    /// The ports that there are.
    fn ports(&self) -> Ports;

    /// Says once, before the run, which ports (by position) will be transferred.
    ///
    /// # Errors
    /// Ports that cannot be transferred.
    fn select(&mut self, inputs: &[usize], outputs: &[usize]) -> Result<(), Failure>;

    /// One part of the initialisation.
    ///
    /// # Errors
    /// There is no start with these inputs.
    fn initialize(
        &mut self,
        phase: Phase,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), Failure>;

    /// Steps from `time` to `time + step` (s) with inputs held, and computes the outputs there.
    ///
    /// # Errors
    /// The step failed; an FMU may have discarded it.
    fn step(
        &mut self,
        time: f64,
        step: f64,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<Progress, Failure>;

    /// Saves the state, in the place of an earlier one; whether this is possible.
    ///
    /// # Errors
    /// It is possible, but failed.
    fn save(&mut self) -> Result<bool, Failure> {
        Ok(false)
    }

    /// Goes back to the saved state.
    ///
    /// # Errors
    /// It failed.
    fn restore(&mut self) -> Result<(), Failure> {
        Ok(())
    }
}

/// A component that is borrowed for the run, so that its owner can look into it afterwards.
impl<C: Component + ?Sized> Component for &mut C {
    fn ports(&self) -> Ports {
        (**self).ports()
    }

    fn select(&mut self, inputs: &[usize], outputs: &[usize]) -> Result<(), Failure> {
        (**self).select(inputs, outputs)
    }

    fn initialize(
        &mut self,
        phase: Phase,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), Failure> {
        (**self).initialize(phase, inputs, outputs)
    }

    fn step(
        &mut self,
        time: f64,
        step: f64,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<Progress, Failure> {
        (**self).step(time, step, inputs, outputs)
    }

    fn save(&mut self) -> Result<bool, Failure> {
        (**self).save()
    }

    fn restore(&mut self) -> Result<(), Failure> {
        (**self).restore()
    }
}
