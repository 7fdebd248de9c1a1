//! A Rust model as an FMU: one shared library for FMI 2.0 and 3.0, Co-Simulation and Model
//! Exchange.
//!
//! A crate of type `cdylib` implements [`Model`] (and [`Continuous`] where the importer may
//! integrate) and names it once:
//!
//! ```text
//! drivescope_fmu::export_model!(Drive);
//! ```
//!
//! (the crate's example `oscillator` is one)
//!
//! That emits every C function of both standards. A call flows
//!
//! ```text
//! C symbol -> abi: pointers become slices -> Instance: may this be called now, with this?
//!          -> Model: the answer -> abi: status, log message
//! ```
//!
//! The state machine, the checks and the FMU states live in [`Instance`] and are safe Rust; every
//! pointer is met in `abi` alone. A panic of the model ends the instance with `fmiXFatal`; it never
//! crosses the C boundary.
//!
//! Choices where the standards leave one:
//!
//! - A call refused because of its state or arguments has no effect, and the instance goes on.
//!   An error of the model itself ends the run: get, set FMU state, reset and free remain.
//! - In Continuous-Time Mode a discrete input or tunable parameter may be set to the value that it
//!   has; another value is not taken, with a warning (fmpy sets all inputs at every root search).
//! - FMI 3.0 Co-Simulation has no event mode, no early return and no intermediate update.

#[doc(hidden)]
pub mod abi;
mod derivatives;
mod exchange;
mod fmi2;
mod fmi3;
mod instance;
mod lifecycle;
mod location;
mod phase;
mod refusal;
mod saved;
mod snapshots;
mod stepping;
mod table;
mod values;

use std::path::Path;

pub use instance::Instance;
pub use phase::Phase;

pub use crate::vocabulary::Interface;
pub use refusal::{Refusal, Status};
pub use snapshots::SerializedError;

use crate::description::ModelDescription;

/// What an FMU computes. An instance's state is the value itself: FMI get and set state clone it.
///
/// Values of all types are `f64`; true is 1. References are checked against the
/// [description](Model::description) before they arrive here.
pub trait Model: Clone + Send + 'static {
    /// What can go wrong; its text and its sources reach the importer's log.
    type Error: std::error::Error;

    /// A new model with its start values. `resources` is the FMU's folder of that name, `None`
    /// where there is none: then the model is its own default or refuses.
    ///
    /// # Errors
    ///
    /// Resources that cannot be used.
    fn instantiate(resources: Option<&Path>) -> Result<Self, Self::Error>;

    /// What this model is; the same as in the FMU's `modelDescription.xml`, or the importer's
    /// token does not match. Called once an instance.
    fn description(&self) -> ModelDescription;

    /// A variable's value at the present time, states and inputs, also before
    /// [`Model::initialize`]. `None` if there is none.
    fn get(&self, reference: u32) -> Option<f64>;

    /// Sets a start value, parameter or input. The value is finite and within min and max.
    ///
    /// # Errors
    ///
    /// A value that the model cannot take; the model is then as before.
    fn set(&mut self, reference: u32, value: f64) -> Result<(), Self::Error>;

    /// Ends initialization: everything is consistent at time `start` \[s\].
    ///
    /// # Errors
    ///
    /// Start values that do not fit together.
    fn initialize(&mut self, start: f64) -> Result<(), Self::Error>;

    /// Co-Simulation: from communication point `t` to `t + h` \[s\], h > 0, inputs held.
    ///
    /// # Errors
    ///
    /// What stopped the integration.
    fn step(&mut self, t: f64, h: f64) -> Result<(), Self::Error>;

    /// Everything that [`Clone`] copies, as bytes that another process can read.
    fn serialize(&self) -> Vec<u8>;

    /// The inverse of [`Model::serialize`] on a model of the same description.
    ///
    /// # Errors
    ///
    /// Bytes that are not such a state.
    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// The Model Exchange side, if there is one.
    fn continuous(&mut self) -> Option<&mut dyn Continuous<Error = Self::Error>> {
        None
    }

    /// `sum over j of d unknowns[i] / d knowns[j] * seed[j]` for every i, at the present time and
    /// states; `None` if one of these is not offered.
    fn directional(&self, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Option<Vec<f64>> {
        let _ = (unknowns, knowns, seed);
        None
    }
}

/// The Model Exchange side of a [`Model`]. States, derivatives and indicators are in the order of
/// the description's structure; nominal values are the description's.
pub trait Continuous {
    /// The model's error.
    type Error: std::error::Error;

    /// The present time, s.
    fn set_time(&mut self, t: f64);

    /// The continuous states.
    fn states(&self) -> &[f64];

    /// Sets the continuous states; as many as there are, all finite.
    fn set_states(&mut self, states: &[f64]);

    /// Derivatives of the states at the present time, states and inputs. A value that is not
    /// finite makes the importer try a smaller step.
    ///
    /// # Errors
    ///
    /// What cannot be computed.
    fn derivatives(&mut self) -> Result<&[f64], Self::Error>;

    /// Event indicators; an event happens where one changes its sign.
    ///
    /// # Errors
    ///
    /// What cannot be computed.
    fn event_indicators(&mut self) -> Result<&[f64], Self::Error>;

    /// One event iteration: state and time events at the present time happen.
    ///
    /// # Errors
    ///
    /// What cannot be computed.
    fn update_discrete(&mut self) -> Result<DiscreteUpdate, Self::Error>;
}

/// What an event iteration did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiscreteUpdate {
    /// Another iteration is needed.
    pub again: bool,
    /// Continuous states were set anew.
    pub states_changed: bool,
    /// The next time event, s.
    pub next_event: Option<f64>,
}

/// Emits every C function of FMI 2.0 and 3.0 for a [`Model`], in the crate that is the shared
/// library. Once a library.
#[macro_export]
macro_rules! export_model {
    ($model:ty) => {
        // `no_mangle` is an unsafe attribute: nothing else may define these symbols.
        #[allow(unsafe_code, non_snake_case, clippy::too_many_arguments)]
        #[doc(hidden)]
        pub mod fmi_functions {
            use super::*;
            $crate::fmi2_functions!($model);
            $crate::fmi3_functions!($model);
        }
    };
}

#[cfg(test)]
mod tests;
