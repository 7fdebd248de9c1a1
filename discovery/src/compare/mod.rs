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
//! Nothing is fitted but the starts. What a change of the base's own parameters could explain is
//! taken out to first order, so a drive that was fitted and one that was not are judged alike;
//! [`Comparison::by_parameters`] says how much that was.

mod angles;
mod beside_load;
mod columns;
mod curve;
mod drive_motion;
mod finding;
mod layout;
mod residual;
mod score;
mod seen;
mod series;
mod shape;
mod span;
mod whitening;

use std::sync::OnceLock;

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::info::Variable;
use drivescope_recording::rounded;
use serde::Serialize;
use thiserror::Error;

pub use curve::Curve;
pub use residual::Correlation;
pub use seen::{OutputComparison, RecordingComparison};
pub use span::Span;

use crate::case::{Case, Setting};
use crate::estimate::{Evidence, at_its_balances, evaluate, with_own};
use crate::measured::Output;
use crate::response::Linearised;
use beside_load::BesideLoad;
use columns::Builder;
use drive_motion::{DriveMotion, Scales};
use finding::{Data, Found, hypotheses};
use layout::Layout;
use score::{basis, outside};
use seen::Seen;
use shape::Shape;
use whitening::Whitening;

/// Blocks of the tests, s: the residual's own memory times this, within these limits.
const BLOCK_MEMORIES: f64 = 5.0;
const BLOCK_S: (f64, f64) = (0.2, 0.5);
/// Share of the excess that the base's own parameters may explain before the drive counts as not
/// fitted to these recordings.
const UNFITTED: f64 = 0.05;

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
    /// Error that would be left if the drive's own parameters were fitted, to first order.
    pub error_if_fitted: f64,
    /// Share of the squared error above the floor that they would explain.
    pub by_parameters: f64,
    /// Whether the drive explains its balances as well as least squares on them: values that
    /// follow the observed motion closer explain them no better.
    pub by_balances: bool,
    /// Where it fails, most telling first.
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
        self.parameters_matter() && !self.by_balances
    }

    /// Whether other values of the drive's own parameters would take away much of the error.
    pub fn parameters_matter(&self) -> bool {
        self.by_parameters > UNFITTED && self.error > 1.02 * self.error_if_fitted
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
    alike(evidence)?;
    let judged = evaluate(drive, evidence, setting, true)?;
    let drives: Vec<Drive> = judged.recordings.iter().map(|fit| with_own(drive, fit)).collect();
    let cases: Vec<Case<'_>> = (0..drives.len())
        .map(|k| Case {
            drive: &drives[k],
            measured: &evidence.recordings[k],
            noise: &evidence.noise[k],
            starts: &judged.recordings[k].starts,
            setting,
        })
        .collect();
    let layout = Layout::new(&cases);
    let paths: Vec<DriveMotion> =
        cases.iter().enumerate().map(|(k, case)| DriveMotion::new(case, k)).collect();
    let scales = Scales::new(&paths, drive.motor.j);
    let limit = drive.amplifier.as_ref().and_then(|it| it.limit);
    let linearised: Vec<Option<Linearised>> = cases.iter().map(Linearised::of).collect();
    let builder = Builder {
        cases: &cases,
        linearised: &linearised,
        paths: &paths,
        scales: &scales,
        layout: &layout,
        limit,
    };
    let floors = evidence.recordings.iter().map(|it| setting.observer.floor(it).powi(2));
    let floor = floors.sum::<f64>() / evidence.recordings.len().max(1) as f64;
    let (shared, own): (Vec<_>, Vec<_>) = drive
        .fitted()
        .into_iter()
        .map(|it| it.name)
        .partition(|name| !drive.per_recording.contains(name));
    let (residual, base) = columns::base(&cases, &layout, &shared, &own);
    let known = basis(base.iter().map(Vec::as_slice), layout.rows());
    let remainder = outside(&known, &residual);
    let memory_s = (0..layout.outputs)
        .map(|j| {
            let of: Vec<f64> = remainder.iter().skip(j).step_by(layout.outputs).copied().collect();
            residual::memory_s(&of, layout.group_s)
        })
        .fold(0.0, f64::max);
    let block_s = (BLOCK_MEMORIES * memory_s).clamp(BLOCK_S.0, BLOCK_S.1);
    let waves = angles::wave_numbers(&builder, base.iter().map(Vec::as_slice), &residual);
    let shapes = shapes(&builder, &waves.kept);
    let columns = builder.shapes(&shapes);
    let hypotheses = hypotheses(&shapes, waves.looked_at);
    let (blocks, white_blocks) = (layout.blocks(block_s), layout.blocks(BLOCK_S.0));
    let filtered = OnceLock::new();
    let beside_load = |known: &[Shape], shape: Shape| {
        let make = || BesideLoad::of(drive, setting, evidence, &judged.recordings, limit);
        filtered.get_or_init(make).as_ref()?.p_value(known, shape)
    };
    let data = Data {
        beside_load: &beside_load,
        layout: &layout,
        residual,
        base,
        shapes,
        columns,
        blocks,
        white_blocks,
        floor,
        hypotheses,
    };
    let found = data.search();
    let excess = |sum: f64| (sum - floor * layout.values()).max(0.0);
    let (now, after) = (data.residual.iter().map(|e| e * e).sum::<f64>(), remainder.norm_squared());
    let by_parameters = if excess(now) > 0.0 { 1.0 - excess(after) / excess(now) } else { 0.0 };
    let curves = if options.curves {
        let wave = found.iter().find_map(|it| it.shape.wave_number()).unwrap_or_else(|| {
            let first = data.shapes.iter().find_map(|it| it.wave_number());
            first.unwrap_or(1.0)
        });
        let evidence = curve::Evidence {
            known: &known,
            residual: &data.residual,
            blocks: (&data.blocks.0, data.blocks.1),
            seed: options.seed,
        };
        curve::curves(&builder, &evidence, wave)
    } else {
        Vec::new()
    };
    let whitening = Whitening::fit(&data.residual, &layout);
    let one_step = whitening.one_step(&data.residual, &layout);
    let view = Seen { builder: &builder, one_step: &one_step, floor, explained: !found.is_empty() };
    let recordings = (0..cases.len()).map(|k| view.recording(k)).collect();
    let rms = |sum: f64| (sum / layout.values()).sqrt();
    Ok(Comparison {
        observer_hz: setting.observer.hz,
        floor: floor.sqrt(),
        error: judged.squares.error(),
        error_if_fitted: judged.squares.error() * rms(after) / rms(now),
        by_parameters,
        by_balances: setting.observer.follows() && at_its_balances(drive, evidence),
        findings: found.iter().map(finding).collect(),
        tested: data.shapes.len(),
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

/// The shapes that make sense for these recordings.
fn shapes(builder: &Builder<'_>, waves: &[f64]) -> Vec<Shape> {
    let Some(case) = builder.cases.first() else { return Vec::new() };
    let mut shapes = vec![
        Shape::TorqueOverSpeed,
        Shape::DragOverSpeed,
        Shape::FrictionNearRest,
        Shape::TorqueAfterReversal,
        Shape::FluxOverSpeed,
        Shape::TorqueByDirection,
        Shape::FrictionOverCurrent,
        Shape::FluxOverCurrent,
        Shape::Resonances,
        Shape::LateInput,
    ];
    if case.drive.motor.input == Input::Voltage {
        shapes.extend([Shape::VoltageOverCurrent, Shape::ResistanceOverHeat]);
    }
    if builder.limit.is_some() {
        shapes.push(Shape::AtLimit);
    }
    if case.measured.output(Output::Current).is_some() {
        shapes.push(Shape::CurrentOffset);
    }
    for place in 0..builder.cases.len() {
        shapes.extend([Shape::FrictionOverTime(place), Shape::FrictionDrift(place)]);
    }
    let speed = case.measured.output(Output::Speed).is_some();
    if speed {
        shapes.push(Shape::SpeedShownLate);
    }
    for (place, wave) in waves.iter().enumerate() {
        shapes.extend([Shape::TorqueOverAngle(*wave), Shape::FluxOverAngle(*wave)]);
        // A bent shaft or an eccentric tachometer repeats with the revolution or half of it.
        if place < 2 {
            shapes.push(Shape::FrictionOverAngle(*wave));
            shapes.extend(speed.then_some(Shape::SpeedShownOverAngle(*wave)));
        }
    }
    shapes
}

fn finding(found: &Found) -> Finding {
    let variable: Variable = found.shape.variable();
    let period = found.shape.wave_number().map(|wave| std::f64::consts::TAU / wave);
    Finding {
        variable: variable.name(),
        p_value: found.p_value,
        share: found.share,
        balance: found.shape.acts_on().name(),
        words: found.shape.words().to_owned(),
        period,
    }
}
