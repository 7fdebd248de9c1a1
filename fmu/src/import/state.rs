//! FMU states that an instance has given out.

use std::sync::{Arc, Mutex, PoisonError};

use super::binding::Saved;
use super::handle::Handle;
use super::integrator::Integrator;
use super::mode::Mode;

/// A saved state of one instance. Its memory in the FMU is given back when it is dropped.
#[derive(Debug)]
pub struct State {
    pub(super) saved: Saved,
    pub(super) integrator: Option<Box<Integrator>>,
    pub(super) mode: Mode,
    pub(super) time: f64,
    /// The instance's list of states to be freed, which also says whose state this is.
    pub(super) dropped: Arc<Mutex<Vec<Saved>>>,
}

impl Drop for State {
    fn drop(&mut self) {
        // Only the instance may call the FMU, so it frees the memory the next time it is called.
        self.dropped.lock().unwrap_or_else(PoisonError::into_inner).push(self.saved);
    }
}

/// The states that an instance has given out.
#[derive(Debug, Default)]
pub(super) struct States {
    pub(super) live: Vec<Saved>,
    pub(super) dropped: Arc<Mutex<Vec<Saved>>>,
}

impl States {
    /// Whether the run may be taken back to an earlier time.
    pub(super) fn in_use(&self) -> bool {
        !self.live.is_empty()
    }

    pub(super) fn free_dropped(&mut self, handle: &mut Handle) {
        let dropped: Vec<_> =
            self.dropped.lock().unwrap_or_else(PoisonError::into_inner).drain(..).collect();
        for saved in dropped {
            if let Some(at) = self.live.iter().position(|live| *live == saved) {
                self.live.swap_remove(at);
                handle.free_saved(saved);
            }
        }
    }

    pub(super) fn free_all(&mut self, handle: &mut Handle) {
        for saved in self.live.drain(..) {
            handle.free_saved(saved);
        }
    }
}
