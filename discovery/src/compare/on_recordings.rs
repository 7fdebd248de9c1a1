//! A drive along its recordings, with what belongs to each of them estimated.

use drivescope_plant::drive::Drive;

use crate::case::{Case, Setting};
use crate::error::Error;
use crate::estimate::{Evidence, Fit, Options, evaluate, fit, with_own};

/// Starts of a fit that only shows where the drive fails: the balances' values and its own.
const STARTS: usize = 2;

pub(super) struct OnRecordings {
    pub(super) drive: Drive,
    /// Estimates of each recording.
    pub(super) recordings: Vec<Fit>,
    /// Root of the mean squared error of all recordings, in units of the noise.
    pub(super) error: f64,
    /// The drive as it is in each recording.
    drives: Vec<Drive>,
}

impl OnRecordings {
    /// The drive as it is.
    pub(super) fn of(drive: &Drive, evidence: &Evidence, setting: &Setting) -> Result<Self, Error> {
        let evaluated = evaluate(drive, evidence, setting, true)?;
        Ok(Self::new(drive.clone(), evaluated.recordings, evaluated.squares.error()))
    }

    /// The drive fitted to these recordings; nothing where it overflows.
    pub(super) fn fitted(drive: &Drive, evidence: &Evidence, setting: &Setting) -> Option<Self> {
        let options = Options { starts: STARTS, ..Options::default() };
        let fitted = fit(drive, evidence, setting, &options).ok()?;
        Some(Self::new(fitted.drive, fitted.recordings, fitted.squares.error()))
    }

    fn new(drive: Drive, recordings: Vec<Fit>, error: f64) -> Self {
        let drives = recordings.iter().map(|it| with_own(&drive, it)).collect();
        Self { drive, recordings, error, drives }
    }

    pub(super) fn cases<'a>(
        &'a self,
        evidence: &'a Evidence,
        setting: &'a Setting,
    ) -> Vec<Case<'a>> {
        let starts = self.recordings.iter().map(|it| it.starts.as_slice());
        let each = self.drives.iter().zip(starts).enumerate();
        each.map(|(place, (drive, starts))| evidence.case(place, drive, starts, setting)).collect()
    }
}
