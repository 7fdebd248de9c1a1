//! A drive with what its case borrows, for the tests of this crate.

use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use crate::{Case, Measured, Observer, Setting, Start};

/// What a [`Case`] borrows, the run beginning at rest.
pub(crate) struct Rig {
    pub(crate) drive: Drive,
    pub(crate) measured: Measured,
    pub(crate) noise: Vec<f64>,
    pub(crate) starts: Vec<Start>,
    pub(crate) setting: Setting,
}

impl Rig {
    /// The drive at the recording; `noise` is that of its outputs.
    pub(crate) fn new(drive: Drive, recording: &Recording, noise: &[f64], hz: f64) -> Self {
        let measured = Measured::new(&drive, recording).expect("it can be used");
        let starts = vec![Start::REST; measured.pieces.len()];
        let setting = Setting::new(&drive, Observer { hz });
        Self { drive, measured, noise: noise.to_vec(), starts, setting }
    }

    pub(crate) fn case(&self) -> Case<'_> {
        let Self { drive, measured, noise, starts, setting } = self;
        Case { drive, measured, noise, starts, setting }
    }
}
