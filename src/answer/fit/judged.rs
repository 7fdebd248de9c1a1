//! Errors of a drive on some recordings.

use drivescope_discovery::{
    Estimate, Evaluated, Evidence, Fit, Fitted, OutputFits, Setting, USUAL_BAND_HZ, output_fits,
    relative_force_error, with_own,
};
use drivescope_plant::drive::Drive;

/// Errors of a drive on some recordings.
#[derive(Debug)]
pub(crate) struct Judged {
    pub(super) error: f64,
    pub(super) each: Vec<f64>,
    pub(super) own: Vec<Vec<Estimate>>,
    pub(super) force: Option<f64>,
    pub(super) fits: OutputFits,
}

impl Judged {
    pub(crate) fn new(
        drive: &Drive,
        evidence: &Evidence,
        setting: &Setting,
        judged: &Evaluated,
    ) -> Self {
        Self::of((drive, setting), evidence, judged.squares.error(), &judged.recordings)
    }

    pub(crate) fn of_fit(fitted: &Fitted, evidence: &Evidence, setting: &Setting) -> Self {
        Self::of((&fitted.drive, setting), evidence, fitted.squares.error(), &fitted.recordings)
    }

    fn of(
        (drive, setting): (&Drive, &Setting),
        evidence: &Evidence,
        error: f64,
        fits: &[Fit],
    ) -> Self {
        let pairs = evidence.recordings.iter().zip(fits);
        let forces: Option<Vec<f64>> = pairs
            .map(|(it, fit)| relative_force_error(&with_own(drive, fit), it, USUAL_BAND_HZ))
            .collect();
        Self {
            error,
            each: fits.iter().map(|fit| fit.squares.error()).collect(),
            own: fits.iter().map(|fit| fit.own.clone()).collect(),
            force: forces.map(|all| mean_square(&all)),
            fits: output_fits(drive, evidence, setting, fits),
        }
    }
}

pub(super) fn mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}
