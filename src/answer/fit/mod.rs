//! What `fit` answers.

mod blocks;
mod judged;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::PathBuf;

use drivescope_discovery::signals::SignalFinding;
use drivescope_discovery::{
    BothUnexplained, Estimate, Fitted, NotIdentifiable, OutputFits, Setting, USUAL_BAND_HZ,
    unexplained,
};
use drivescope_plant::drive::{Drive, Motion};
use serde::Serialize;

use crate::evidence::Gathered;
use crate::read_evidence::KnownNoise;

pub(crate) use judged::Judged;
use judged::mean_square;

/// Correlation from which on two parameters are named together.
const STRONG: f64 = 0.9;

/// The errors of the drive as it was given.
#[derive(Debug, Serialize)]
struct Before {
    error: Option<f64>,
    validation_error: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Correlation {
    names: Vec<String>,
    matrix: Vec<Vec<f64>>,
    /// Pairs that can hardly be told apart.
    strong: Vec<(String, String, f64)>,
}

/// Of a force-driven drive: |K_m u - inverse dynamics| / |K_m u|.
#[derive(Debug, Serialize)]
struct ForceError {
    band_hz: f64,
    before: Option<f64>,
    after: f64,
    validation_before: Option<f64>,
    validation_after: Option<f64>,
}

/// Something of the drive as it was given and fitted, on the recordings of the fit and on those
/// that judge.
#[derive(Debug, Serialize)]
struct BeforeAndAfter<T> {
    before: T,
    after: T,
    validation_before: T,
    validation_after: T,
}

#[derive(Debug, Serialize)]
struct OfRecording {
    file: String,
    /// Whether it served to judge and not to fit.
    held_out: bool,
    values: usize,
    error: f64,
    noise: Vec<KnownNoise>,
    /// Parameters of this recording alone.
    own: Vec<Estimate>,
}

/// The answer of `fit`.
#[derive(Debug, Serialize)]
pub(crate) struct FitAnswer {
    drive: String,
    #[serde(skip)]
    motion: Motion,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<PathBuf>,
    parameters: BTreeMap<String, Estimate>,
    #[serde(skip)]
    order: Vec<String>,
    correlation: Correlation,
    not_identifiable: Vec<String>,
    kept: Vec<NotIdentifiable>,
    error: f64,
    validation_error: f64,
    before: Before,
    /// What the balances leave unexplained.
    unexplained: BeforeAndAfter<BothUnexplained>,
    /// Fit of each output, %; nothing of a drive that overflows.
    fit_percent: BeforeAndAfter<OutputFits>,
    /// Noise of the first recording, by output; each recording has its own below.
    noise: BTreeMap<&'static str, f64>,
    noise_source: BTreeMap<&'static str, drivescope_discovery::NoiseSource>,
    recordings: Vec<OfRecording>,
    split: String,
    /// What is wrong with the signals of the recordings, the gravest first.
    signals: Vec<SignalFinding>,
    doubts: Vec<String>,
    observer_hz: f64,
    noise_floor: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_force_error: Option<ForceError>,
    block_s: f64,
    starts: usize,
    /// Whether the values are those of least squares on the balances.
    by_balances: bool,
    seed: u64,
}

impl FitAnswer {
    pub(crate) fn new(
        base: &Drive,
        output: Option<PathBuf>,
        gathered: &Gathered,
        fitted: &Fitted,
        setting: &Setting,
        (before, after): ([Option<Judged>; 2], [Judged; 2]),
        seed: u64,
    ) -> Self {
        let [validated, fitted_to] = [&after[1].fits, &after[0].fits].map(Clone::clone);
        let fits = |judged: &Option<Judged>| {
            judged.as_ref().map(|judged| judged.fits.clone()).unwrap_or_default()
        };
        let fit_percent = BeforeAndAfter {
            before: fits(&before[0]),
            after: fitted_to,
            validation_before: fits(&before[1]),
            validation_after: validated,
        };
        let error = |judged: &Option<Judged>| judged.as_ref().map(|judged| judged.error);
        let force = |judged: &Option<Judged>| judged.as_ref().and_then(|judged| judged.force);
        let relative_force_error = after[0].force.map(|now| ForceError {
            band_hz: USUAL_BAND_HZ,
            before: force(&before[0]),
            after: now,
            validation_before: force(&before[1]),
            validation_after: after[1].force,
        });
        let evidence = [&gathered.estimation, &gathered.validation];
        let all = base.parameters();
        // Also where the fitted drive was judged: before is what the user gave.
        let own = |own: &[Estimate]| {
            let given = |it: &Estimate| all.iter().find(|p| p.name == it.name).map(|p| p.value);
            own.iter()
                .map(|it| Estimate { before: given(it).unwrap_or(it.before), ..it.clone() })
                .collect()
        };
        let mut recordings = Vec::new();
        for (held_out, (evidence, judged)) in
            [false, true].into_iter().zip(evidence.into_iter().zip(&after))
        {
            for (k, measured) in evidence.recordings.iter().enumerate() {
                recordings.push(OfRecording {
                    file: measured.name.clone(),
                    held_out,
                    values: measured.values(),
                    error: judged.each[k],
                    noise: gathered.noise[recordings.len()].clone(),
                    own: own(&judged.own[k]),
                });
            }
        }
        let floors = gathered.estimation.recordings.iter().map(|it| setting.observer.floor(it));
        let of = |it: &Estimate| (it.name.clone(), it.clone());
        Self {
            drive: base.name.clone(),
            motion: base.motion,
            output,
            parameters: fitted.parameters.iter().map(of).collect(),
            order: fitted.parameters.iter().map(|it| it.name.clone()).collect(),
            correlation: correlation(fitted),
            not_identifiable: fitted
                .not_identifiable
                .iter()
                .map(|it| it.parameter.clone())
                .collect(),
            kept: fitted.not_identifiable.clone(),
            error: after[0].error,
            validation_error: after[1].error,
            before: Before { error: error(&before[0]), validation_error: error(&before[1]) },
            unexplained: BeforeAndAfter {
                before: unexplained(base, &gathered.estimation).into(),
                after: unexplained(&fitted.drive, &gathered.estimation).into(),
                validation_before: unexplained(base, &gathered.validation).into(),
                validation_after: unexplained(&fitted.drive, &gathered.validation).into(),
            },
            fit_percent,
            noise: gathered.noise[0].iter().map(|noise| (noise.name, noise.sd)).collect(),
            noise_source: gathered.noise[0]
                .iter()
                .map(|noise| (noise.name, noise.source))
                .collect(),
            recordings,
            split: gathered.split.clone(),
            signals: gathered.signals.clone(),
            doubts: gathered.doubts.clone(),
            observer_hz: setting.observer.hz,
            noise_floor: mean_square(&floors.collect::<Vec<_>>()),
            relative_force_error,
            block_s: fitted.block_s,
            starts: fitted.starts_tried,
            by_balances: fitted.by_balances,
            seed,
        }
    }
}

fn correlation(fitted: &Fitted) -> Correlation {
    let names: Vec<String> = fitted.parameters.iter().map(|it| it.name.clone()).collect();
    let matrix: Vec<Vec<f64>> =
        fitted.correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    let mut strong = Vec::new();
    for (j, row) in matrix.iter().enumerate() {
        for (k, rho) in row.iter().enumerate().take(j) {
            if rho.abs() >= STRONG {
                strong.push((names[k].clone(), names[j].clone(), *rho));
            }
        }
    }
    Correlation { names, matrix, strong }
}
