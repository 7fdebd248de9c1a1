//! What detectors of the residual look at of a diagnoser.

use crate::constant_threshold::ConstantThreshold;
use crate::gmdh::RobustGmdh;
use crate::interface::Interface;
use crate::model::Model;
use crate::stored_error::ModelError;

/// The parts of a diagnoser that have keys of their own in its file.
#[derive(Debug, Clone, Copy)]
pub struct Parts<'a> {
    /// The signals that it was trained on.
    pub interface: &'a Interface,
    /// Model of the output, whose residual is watched.
    pub model: &'a Model,
    /// Thresholds of the plain residual.
    pub constant: &'a ConstantThreshold,
    /// ARX model of what that model gets wrong.
    pub model_error: &'a ModelError,
    /// The same by a recurrent network.
    pub recurrent_error: Option<&'a ModelError>,
    /// Another model of the output, with bounded parameters.
    pub gmdh: Option<&'a RobustGmdh>,
}
