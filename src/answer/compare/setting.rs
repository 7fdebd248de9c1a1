//! What a comparison rests on.

use drivescope_discovery::Evidence;
use drivescope_plant::drive::{Drive, Motion};
use drivescope_recording::Clock;

use crate::read_evidence::KnownNoise;

/// What a comparison rests on, beside the comparison itself.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    /// Name of the drive.
    pub(crate) drive: String,
    /// How it moves.
    pub(crate) motion: Motion,
    /// Noise of the first recording's outputs.
    pub(crate) noise: Vec<KnownNoise>,
    /// Error on the recordings that only judge, if there are any.
    pub(crate) validation_error: Option<f64>,
    /// The step of a search that it is, if it is one.
    pub(crate) step: Option<OfStep>,
    /// When the samples of each recording were taken.
    pub(crate) clocks: Vec<Clock>,
    /// What makes the recordings doubtful.
    pub(crate) doubts: Vec<String>,
    pub(crate) seed: u64,
}

/// A drive that was fitted to a part of the recordings that it is compared with: its error on that
/// part and on the rest are two figures, and the one over all of them is none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OfStep {
    /// Error on what it was fitted to.
    pub(crate) estimation_error: f64,
    /// Whether its parameters were estimated there, or typed.
    pub(crate) fitted: bool,
}

impl Setting {
    /// Of a drive on recordings, with the noise of the first one's outputs.
    pub(crate) fn new(
        drive: &Drive,
        evidence: &Evidence,
        noise: &[KnownNoise],
        validation_error: Option<f64>,
        doubts: &[String],
        seed: u64,
    ) -> Self {
        Self {
            drive: drive.name.clone(),
            motion: drive.motion,
            noise: noise.to_vec(),
            validation_error,
            step: None,
            clocks: evidence.recordings.iter().map(|it| it.clock.clone()).collect(),
            doubts: doubts.to_vec(),
            seed,
        }
    }
}
