//! What a session is doing.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde::Serialize;

/// What a session is doing.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Job {
    /// Its number in the session.
    #[serde(skip)]
    pub(super) number: u64,
    /// What it is for.
    pub(super) title: String,
    /// What it does now.
    pub(super) doing: String,
    /// Errors that the steps of its fits came to, in units of the noise.
    pub(super) errors: Vec<f64>,
    #[serde(skip)]
    pub(super) cancelled: Arc<AtomicBool>,
}

/// The user wants the work to end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cancelled")]
pub(super) struct Cancelled;
