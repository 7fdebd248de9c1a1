//! What is wrong with a part of a diagnoser, wherever it was read from.

use thiserror::Error;

use crate::gmdh::BoundError;
use crate::model::Model;

/// What is wrong with a part of a diagnoser.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Flaw {
    /// The parts of a model do not fit together or not the interface.
    #[error("the {which} does not fit the {inputs} inputs and one output of the interface")]
    Shape {
        /// Which model.
        which: &'static str,
        /// Inputs of the interface.
        inputs: usize,
    },
    /// A model explodes in free run.
    #[error("the {which} is unstable in free run: train the diagnoser again")]
    Unstable {
        /// Which model.
        which: &'static str,
    },
    /// Parameter sets of the GMDH network that are none.
    #[error("GMDH network: {0}")]
    Bounds(#[from] BoundError),
    /// A number without meaning.
    #[error("{key} = {value} must be {must}")]
    Value {
        /// Where it stands.
        key: &'static str,
        value: f64,
        /// What it must be.
        must: &'static str,
    },
}

impl Flaw {
    /// Refuses a model that does not take `inputs` inputs to one output, or explodes.
    pub(crate) fn of_model(which: &'static str, model: &Model, inputs: usize) -> Result<(), Self> {
        if inputs == 0 || model.signals() != Some((inputs, 1)) {
            return Err(Self::Shape { which, inputs });
        }
        if model.is_stable() { Ok(()) } else { Err(Self::Unstable { which }) }
    }

    /// Refuses a number that is not positive.
    pub(crate) fn unless_positive(key: &'static str, value: f64) -> Result<(), Self> {
        let fits = value.is_finite() && value > 0.0;
        if fits { Ok(()) } else { Err(Self::Value { key, value, must: "positive" }) }
    }

    /// Refuses NaN and infinity.
    pub(crate) fn unless_finite(key: &'static str, value: f64) -> Result<(), Self> {
        if value.is_finite() { Ok(()) } else { Err(Self::Value { key, value, must: "finite" }) }
    }
}
