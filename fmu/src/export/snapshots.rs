//! The FMU states that an instance keeps.

use std::collections::HashMap;

use super::phase::Run;

/// A run at one moment: a deep copy of the model and of where it stands.
#[derive(Debug)]
pub(super) struct Snapshot<M> {
    pub(super) model: M,
    pub(super) run: Run,
}

/// The FMU states of one instance.
#[derive(Debug)]
pub(super) struct SavedStates<M> {
    pub(super) states: HashMap<usize, Snapshot<M>>,
    pub(super) last_key: usize,
}

impl<M> Default for SavedStates<M> {
    fn default() -> Self {
        Self { states: HashMap::new(), last_key: 0 }
    }
}

/// Bytes that are not an FMU state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SerializedError {
    /// They do not begin as one.
    #[error("these {0} bytes are not one")]
    NotOne(usize),
    /// They come from another model.
    #[error("it belongs to another model description")]
    OtherModel,
    /// They come from the other interface.
    #[error("it belongs to the other interface type")]
    OtherInterface,
}
