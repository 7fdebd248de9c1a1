//! The next experiment: among scripted inputs the one that tells a confusion set apart best.
//!
//! For each pair of models a, b with d the change that a law makes in the outputs beside the
//! base parameters, |d_a|^2 (1 - cos^2(d_a, d_b)) is the squared error (in units of the noise)
//! that would remain if b were fitted where a is true. The input with the largest worst pair wins.

use std::f64::consts::TAU;

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::grid::Spans;
use drivescope_recording::{Clock, NoiseGain};
use serde::Serialize;

use super::columns::{Columns, FittedDrive};
use super::refit::Model;
use crate::case::Setting;
use crate::driving::Driving;
use crate::estimate::{Evidence, Fit};
use crate::measured::{Channel, Measured};
use crate::observer::Observer;
use crate::projection::beside;
use crate::start::Start;

/// Length of a scripted experiment, s, and its sampling time.
const LENGTH_S: f64 = 8.0;

/// What to record next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextExperiment {
    /// Name of the scripted input.
    pub input: &'static str,
    /// What to apply, in words.
    pub description: String,
    /// Greatest magnitude of u, in its unit.
    pub amplitude: f64,
    /// The effects that it tells apart.
    pub separates: Vec<String>,
    /// Squared error, in units of the noise, that the wrong one of the worst pair would leave.
    pub discrimination: f64,
    /// The same for every scripted input, best first.
    pub compared: Vec<(&'static str, f64)>,
}

/// A scripted input: its name, how to describe it, and u over the amplitude at a time.
type Script = (&'static str, &'static str, fn(f64) -> f64);

const SCRIPTS: [Script; 5] = [
    ("steps", "steps both ways, each held for 0.25 s", |t| {
        [0.6, -0.9, 0.3, 0.0, -0.4, 1.0, 0.15, -0.25][(t / 0.25) as usize % 8]
    }),
    ("staircase", "a staircase up, down through zero and back, 0.4 s a stair", |t| {
        let stair = (t / 0.4) as i32 % 20;
        f64::from(if stair < 5 {
            stair + 1
        } else if stair < 15 {
            9 - stair
        } else {
            stair - 19
        }) / 5.0
    }),
    ("slow reversals", "a slow wave of 0.25 Hz through zero speed", |t| {
        0.35 * (TAU * 0.25 * t).sin()
    }),
    ("fast sine", "a sine of 8 Hz", |t| 0.8 * (TAU * 8.0 * t).sin()),
    ("chirp", "a chirp from 0.5 to 40 Hz", |t| {
        let growth = (40.0_f64 / 0.5).ln() / LENGTH_S;
        0.7 * (TAU * 0.5 * (growth * t).exp_m1() / growth).sin()
    }),
];

/// The input that tells these models apart best; nothing for fewer than two.
pub(crate) fn next(
    base: &Model,
    models: &[(String, &Model)],
    estimation: &Evidence,
    spans: &Spans,
) -> Option<NextExperiment> {
    if models.len() < 2 {
        return None;
    }
    let mut compared: Vec<(&Script, f64)> = SCRIPTS
        .iter()
        .map(|script| (script, worst_pair(base, models, estimation, spans, script).unwrap_or(0.0)))
        .collect();
    compared.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (best, discrimination) = compared[0];
    Some(NextExperiment {
        input: best.0,
        description: format!("{}, at most {:.3} in u, for {LENGTH_S} s", best.1, spans.voltage),
        amplitude: spans.voltage,
        separates: models.iter().map(|(id, _)| id.clone()).collect(),
        discrimination,
        compared: compared.iter().map(|(script, value)| (script.0, *value)).collect(),
    })
}

fn squared(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

fn worst_pair(
    base: &Model,
    models: &[(String, &Model)],
    estimation: &Evidence,
    spans: &Spans,
    script: &Script,
) -> Option<f64> {
    let of = estimation.recordings.first()?;
    let evidence = Evidence {
        recordings: vec![scripted(of, spans.voltage, script.2)],
        noise: vec![estimation.noise[0].clone()],
    };
    let outputs = |model: &Model, names: &[String]| {
        let fit = Fit { own: vec![], starts: vec![Start::REST], squares: Default::default() };
        let fits = [fit];
        let drive: &Drive = &model.fitted.drive;
        // Nothing is measured, so nothing can correct the run.
        let setting = Setting { observer: Observer::NONE, ..model.setting };
        let at = FittedDrive { drive, fits: &fits, evidence: &evidence, setting: &setting };
        Columns::base(&at, names)
    };
    let plain = outputs(base, &base.names());
    let changes: Vec<Vec<f64>> = models
        .iter()
        .map(|(_, model)| {
            let with = outputs(model, &[]);
            // Residuals against zero: their difference is that of the outputs.
            let change: Vec<f64> =
                plain.residual.iter().zip(&with.residual).map(|(a, b)| a - b).collect();
            beside(&plain.columns, &change)
        })
        .collect();
    let mut worst = f64::INFINITY;
    for (k, a) in changes.iter().enumerate() {
        for b in &changes[..k] {
            let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            let (aa, bb) = (squared(a), squared(b));
            let apart = |own: f64, other: f64| {
                if other > 0.0 { own - dot * dot / other } else { own }
            };
            worst = worst.min(apart(aa, bb)).min(apart(bb, aa));
        }
    }
    worst.is_finite().then_some(worst)
}

/// A recording of zeros under a scripted input, with the outputs of another.
fn scripted(of: &Measured, amplitude: f64, script: fn(f64) -> f64) -> Measured {
    let samples = (LENGTH_S / of.period_s).round() as usize;
    let zeros = vec![0.0; samples];
    let outputs = of.outputs.iter().map(|one| Channel { values: zeros.clone(), ..one.clone() });
    Measured {
        name: "scripted".to_owned(),
        clock: Clock { start_s: 0.0, period_s: of.period_s, breaks: Vec::new() },
        period_s: of.period_s,
        driving: Driving::Input,
        u: (0..samples).map(|k| amplitude * script(k as f64 * of.period_s)).collect(),
        load: None,
        outputs: outputs.collect(),
        angle: None,
        pieces: std::iter::once(0..samples).collect(),
        by_load: false,
        noise_gain: NoiseGain::NONE,
        remarks: Vec::new(),
    }
}
