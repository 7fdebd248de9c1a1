//! Compare: where, and in what way, a model fails on recordings of its drive.
//!
//! ```text
//!  drive, recordings ─> starts (estimated) ─> cases ─> residual r in units of the noise
//!  motion ─> shape ─> series ─> columns: what each possible law would do to the outputs, exactly
//!  residual, base columns, shapes ─> finding: which variables it depends on (score, whitening), and
//!                                    whether a random load leaves as much (beside_load)
//!                                ─> curve: what is missing over each variable, with bands
//!                                ─> residual: is it white, does it know the input
//!                                ─> span: when it fails, in words
//! ```
//!
//! What a change of the base's own parameters could explain is taken out to first order;
//! [`Comparison::by_parameters`] says how much that was. Where it is much, a drive is fitted to see where
//! it fails ([`Options::fit`]), so that one that was fitted and one that was not are judged alike. Its
//! errors, outputs and spans are those of the drive as it is.

mod angles;
mod beside_load;
mod columns;
mod curve;
mod drive_motion;
mod finding;
mod layout;
mod on_recordings;
mod residual;
mod residuals;
mod score;
mod seen;
mod series;
mod shape;
mod span;
mod whitening;

use drivescope_plant::drive::Drive;
use drivescope_recording::rounded;
use serde::Serialize;
use thiserror::Error;

pub use curve::Curve;
pub use residual::Correlation;
pub use seen::{OutputComparison, RecordingComparison};
pub use span::Span;

use crate::case::Setting;
use crate::estimate::{Evidence, at_its_balances};
pub(crate) use beside_load::Load;
use finding::LEVEL;
use on_recordings::OnRecordings;
use residuals::{Residuals, Shown};

/// Share of the excess that the base's own parameters may explain before the drive counts as not
/// fitted to these recordings.
const UNFITTED: f64 = 0.05;
/// Factor by which the error must be above that of a fit for that.
const LOWER: f64 = 1.02;

/// Why recordings cannot be compared with a drive.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CompareError {
    /// The model cannot be run along a recording.
    #[error(transparent)]
    Run(#[from] crate::Error),
    /// Recordings of different signals or sampling times.
    #[error(
        "{other} has {found}, but {first} has {expected}: compare recordings of the same signals \
         and sampling time together, or one at a time"
    )]
    Unequal {
        /// The first recording.
        first: String,
        /// What it has.
        expected: String,
        /// The recording that differs.
        other: String,
        /// What that one has.
        found: String,
    },
}

/// What else to compute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Whether curves are drawn.
    pub curves: bool,
    /// Seed of the bands' draws.
    pub seed: u64,
    /// Whether a drive whose own parameters explain much of the error is fitted first, to see where
    /// it fails: beside what they explain to first order a law is hardly seen.
    pub fit: bool,
}

/// A variable over which the model fails.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// `omega`, `omega_sign`, `i`, `theta`, `time`, `acceleration`, `temperature` or `limits`.
    pub variable: &'static str,
    /// Probability of as much by chance, corrected for the number of shapes, conditional on the
    /// findings before.
    pub p_value: f64,
    /// Share of the squared error above the noise floor that it explains.
    pub share: f64,
    /// Where it acts: `torque`, `voltage` or `sensor`.
    pub balance: &'static str,
    /// What it looks like, in words.
    pub words: String,
    /// Period over the angle, rad (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period: Option<f64>,
}

/// A drive against recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Bandwidth of the observer, Hz; 0: the model ran free.
    pub observer_hz: f64,
    /// Error of a perfect model, in units of the noise.
    pub floor: f64,
    /// Root of the mean squared error of all recordings, in units of the noise.
    pub error: f64,
    /// Error that is left where the drive's own parameters are fitted: after the fit where one was made,
    /// else to first order.
    pub error_if_fitted: f64,
    /// Share of the squared error above the floor that they would explain.
    pub by_parameters: f64,
    /// Whether that is much, and more than chance explains.
    pub parameters_matter: bool,
    /// Whether the drive explains its balances as well as least squares on them: values that
    /// follow the observed motion closer explain them no better.
    pub by_balances: bool,
    /// Where it fails whatever its own parameters are, most telling first.
    #[serde(rename = "where")]
    pub findings: Vec<Finding>,
    /// Shapes that were tested.
    pub tested: usize,
    /// Length of the tests' blocks, s.
    pub block_s: f64,
    pub recordings: Vec<RecordingComparison>,
    /// What is missing over each variable.
    pub curves: Vec<Curve>,
}

impl Comparison {
    /// Whether the model fails: something was found.
    pub fn fails(&self) -> bool {
        !self.findings.is_empty()
    }

    /// Whether a fit of the drive's own parameters would take away much of the error.
    pub fn is_unfitted(&self) -> bool {
        self.parameters_matter && !self.by_balances
    }
}

/// Compares the drive with recordings of it.
///
/// # Errors
/// [`CompareError::Run`] if the model overflows, [`CompareError::Unequal`] if the recordings have
/// different signals or sampling times.
pub fn compare(
    drive: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    options: &Options,
) -> Result<Comparison, CompareError> {
    compare_under(Load::Sought, drive, evidence, setting, options)
}

/// As [`compare`], with what is known of the random load.
///
/// # Errors
/// As [`compare`].
pub(crate) fn compare_under(
    load: Load<'_>,
    drive: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    options: &Options,
) -> Result<Comparison, CompareError> {
    alike(evidence)?;
    let own = OnRecordings::of(drive, evidence, setting)?;
    let cases = own.cases(evidence, setting);
    let view = Residuals::of(drive, &cases);
    let excess = view.excess(own.error);
    let share = |after: f64| if excess > 0.0 { 1.0 - view.excess(after) / excess } else { 0.0 };
    let much = |after: f64| share(after) > UNFITTED && own.error > LOWER * after;
    let by_chance = || view.p_value_of_parameters() > LEVEL;
    let at_first = own.error * view.left();
    let by_balances = setting.observer.follows() && at_its_balances(drive, evidence);
    let parameters_matter = much(at_first) && !by_chance();
    let fitted = (options.fit && parameters_matter && !by_balances)
        .then(|| OnRecordings::fitted(drive, evidence, setting))
        .flatten()
        .filter(|it| it.error < own.error);
    let seed = options.curves.then_some(options.seed);
    let shown = match &fitted {
        Some(fitted) => {
            let cases = fitted.cases(evidence, setting);
            Residuals::of(&fitted.drive, &cases).shown(
                fitted,
                evidence,
                setting,
                (Load::Sought, seed),
            )
        }
        None => view.shown(&own, evidence, setting, (load, seed)),
    };
    let error_if_fitted = fitted.map_or(at_first, |it| it.error);
    let recordings = view.recordings(!shown.findings.is_empty());
    let Shown { findings, tested, block_s, curves } = shown;
    Ok(Comparison {
        observer_hz: setting.observer.hz,
        floor: view.floor.sqrt(),
        error: own.error,
        error_if_fitted,
        by_parameters: share(error_if_fitted),
        parameters_matter: parameters_matter && much(error_if_fitted),
        by_balances,
        findings,
        tested,
        block_s,
        recordings,
        curves,
    })
}

fn alike(evidence: &Evidence) -> Result<(), CompareError> {
    let says = |k: usize| {
        let one = &evidence.recordings[k];
        let names: Vec<&str> = one.outputs.iter().map(|it| it.name).collect();
        format!("{} every {} s", names.join(", "), rounded(one.period_s))
    };
    for k in 1..evidence.recordings.len() {
        let close = (evidence.recordings[k].period_s / evidence.recordings[0].period_s - 1.0).abs();
        let names = |k: usize| evidence.recordings[k].outputs.iter().map(|it| it.name);
        if close > 1e-3 || !names(k).eq(names(0)) {
            let name = |k: usize| evidence.recordings[k].name.clone();
            let (first, other) = (name(0), name(k));
            return Err(CompareError::Unequal { first, expected: says(0), other, found: says(k) });
        }
    }
    Ok(())
}
