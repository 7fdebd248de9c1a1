//! A drive along its recordings, with what belongs to each of them estimated.

use drivescope_plant::drive::Drive;

use crate::case::{Case, Setting};
use crate::error::Error;
use crate::estimate::{Evidence, Fit, Options, evaluate, fit, with_own};

/// Starts of a fit that only shows where the drive fails: the balances' values and its own.
const STARTS: usize = 2;

pub(super) struct Judged {
    pub(super) drive: Drive,
    /// Estimates of each recording.
    pub(super) recordings: Vec<Fit>,
    /// Root of the mean squared error of all recordings, in units of the noise.
    pub(super) error: f64,
    /// The drive as it is in each recording.
    drives: Vec<Drive>,
}

impl Judged {
    /// The drive as it is.
    pub(super) fn of(drive: &Drive, evidence: &Evidence, setting: &Setting) -> Result<Self, Error> {
        let judged = evaluate(drive, evidence, setting, true)?;
        let error = judged.squares.error();
        let drives = judged.recordings.iter().map(|it| with_own(drive, it)).collect();
        Ok(Self { drive: drive.clone(), recordings: judged.recordings, error, drives })
    }

    /// The drive fitted to these recordings; nothing where it overflows.
    pub(super) fn fitted(drive: &Drive, evidence: &Evidence, setting: &Setting) -> Option<Self> {
        let options = Options { starts: STARTS, ..Options::default() };
        let fitted = fit(drive, evidence, setting, &options).ok()?;
        Self::of(&fitted.drive, evidence, setting).ok()
    }

    pub(super) fn cases<'a>(
        &'a self,
        evidence: &'a Evidence,
        setting: &'a Setting,
    ) -> Vec<Case<'a>> {
        let case = |(place, drive): (usize, &'a Drive)| Case {
            drive,
            measured: &evidence.recordings[place],
            noise: &evidence.noise[place],
            starts: &self.recordings[place].starts,
            setting,
        };
        self.drives.iter().enumerate().map(case).collect()
    }
}
