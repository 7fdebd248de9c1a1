//! What a session knows of diagnosing: recordings, a diagnoser, what it found in them.

use std::sync::Arc;

use drivescope_recording::Recording;

use crate::answer::diagnose::DiagnoseAnswer;
use crate::commands::Trained;

/// A recording and what it is for.
#[derive(Debug, Clone)]
pub(in crate::page) struct Material {
    pub(in crate::page) name: String,
    /// Its signals.
    pub(in crate::page) recording: Arc<Recording>,
    /// Whether the machine was healthy, so that it trains.
    pub(in crate::page) healthy: bool,
    /// What was found in it.
    pub(in crate::page) judged: Option<Arc<Judged>>,
}

/// A diagnoser that was trained here.
#[derive(Debug)]
pub(in crate::page) struct Ready {
    /// What the training came to.
    pub(in crate::page) trained: Trained,
    /// Names of the recordings that it was trained on.
    pub(in crate::page) healthy: Vec<String>,
    /// The step whose drive it knows.
    pub(in crate::page) step: Option<usize>,
}

/// What a diagnoser found in a recording.
#[derive(Debug)]
pub(in crate::page) struct Judged {
    /// The answer, or why there is none.
    pub(in crate::page) answer: Result<DiagnoseAnswer, String>,
    pub(in crate::page) figure: Option<String>,
}

/// What a session knows of diagnosing.
#[derive(Debug, Default)]
pub(in crate::page) struct Diagnosis {
    /// The recordings.
    pub(in crate::page) material: Vec<Material>,
    /// The step whose drive the diagnoser is to know.
    pub(in crate::page) step: Option<usize>,
    /// The diagnoser.
    pub(in crate::page) ready: Option<Arc<Ready>>,
    /// Counts the changes.
    pub(in crate::page) changes: u64,
}

impl Diagnosis {
    /// Takes a recording; the same name again replaces what was there.
    pub(in crate::page) fn take(&mut self, name: String, recording: Arc<Recording>, healthy: bool) {
        self.material.retain(|it| it.name != name);
        self.material.push(Material { name, recording, healthy, judged: None });
        self.changes += 1;
    }

    pub(in crate::page) fn find(&mut self, name: &str) -> Option<&mut Material> {
        self.changes += 1;
        self.material.iter_mut().find(|it| it.name == name)
    }
}
