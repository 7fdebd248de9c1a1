//! What a drive leaves of its recordings, and what of it depends on a variable.

use std::sync::OnceLock;

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::info::Variable;
use nalgebra::{DMatrix, DVector};

use super::beside_load::{BesideLoad, Load};
use super::columns::{self, Builder};
use super::curve::{self, Curve, curves};
use super::drive_motion::{DriveMotion, Scales};
use super::finding::{Data, Found, hypotheses};
use super::layout::Layout;
use super::on_recordings::OnRecordings;
use super::score::{Filtered, basis, outside};
use super::seen::{RecordingComparison, Seen};
use super::shape::Shape;
use super::whitening::Whitening;
use super::{Finding, angles, residual};
use crate::case::{Case, Setting};
use crate::estimate::Evidence;
use crate::measured::Output;
use crate::response::Linearised;

/// Blocks of the tests, s: the residual's own memory times this, within these limits.
const BLOCK_MEMORIES: f64 = 5.0;
const BLOCK_S: (f64, f64) = (0.2, 0.5);

/// Residuals, in units of the noise, with what the drive's own parameters would do to them.
pub(super) struct Residuals<'a> {
    cases: &'a [Case<'a>],
    layout: Layout,
    paths: Vec<DriveMotion>,
    scales: Scales,
    limit: Option<f64>,
    linearised: Vec<Option<Linearised>>,
    /// Squared error of a perfect model, per value.
    pub(super) floor: f64,
    residual: Vec<f64>,
    /// How many parameters of its own the drive has that all recordings share.
    parameters: usize,
    /// Their columns, then those of what belongs to a recording.
    base: Vec<Vec<f64>>,
    /// A basis of these.
    known: DMatrix<f64>,
    /// What they leave of the residual.
    remainder: DVector<f64>,
}

/// Where a drive fails.
pub(super) struct Shown {
    pub(super) findings: Vec<Finding>,
    /// Shapes that were tested.
    pub(super) tested: usize,
    /// Length of the tests' blocks, s.
    pub(super) block_s: f64,
    pub(super) curves: Vec<Curve>,
}

impl<'a> Residuals<'a> {
    pub(super) fn of(drive: &Drive, cases: &'a [Case<'a>]) -> Self {
        let layout = Layout::new(cases);
        let paths: Vec<DriveMotion> =
            cases.iter().enumerate().map(|(k, case)| DriveMotion::new(case, k)).collect();
        let scales = Scales::new(&paths, drive.motor.j);
        let floors = cases.iter().map(|it| it.setting.observer.floor(it.measured).powi(2));
        let floor = floors.sum::<f64>() / cases.len().max(1) as f64;
        let (shared, own): (Vec<_>, Vec<_>) = drive
            .fitted()
            .into_iter()
            .map(|it| it.name)
            .partition(|name| !drive.per_recording.contains(name));
        let (residual, base) = columns::base(cases, &layout, &shared, &own);
        let known = basis(base.iter().map(Vec::as_slice), layout.rows());
        let remainder = outside(&known, &residual);
        Self {
            cases,
            layout,
            paths,
            scales,
            limit: drive.amplifier.as_ref().and_then(|it| it.limit),
            linearised: cases.iter().map(Linearised::of).collect(),
            floor,
            residual,
            base,
            parameters: shared.len(),
            known,
            remainder,
        }
    }

    /// Squared error above that of a perfect model, where the error is that, in units of the noise.
    pub(super) fn excess(&self, error: f64) -> f64 {
        (error * error - self.floor).max(0.0)
    }

    /// Share of the error that the drive's own parameters leave, to first order.
    pub(super) fn left(&self) -> f64 {
        self.rms(self.remainder.as_slice()) / self.rms(&self.residual)
    }

    /// Probability by chance of as much as the drive's own parameters explain, to first order.
    pub(super) fn p_value_of_parameters(&self) -> f64 {
        let whitening = Whitening::fit(self.remainder.as_slice(), &self.layout);
        let filter = |column: &[f64]| whitening.apply(column, &self.layout);
        let (parameters, starts) = self.base.split_at(self.parameters);
        let starts = starts.iter().map(Vec::as_slice);
        Filtered::new(&self.residual, starts, &filter)
            .score(parameters, &self.layout.blocks(BLOCK_S.0))
            .map_or(1.0, |it| it.p_value)
    }

    fn rms(&self, residual: &[f64]) -> f64 {
        (residual.iter().map(|e| e * e).sum::<f64>() / self.layout.values()).sqrt()
    }

    fn builder(&self) -> Builder<'_> {
        Builder {
            cases: self.cases,
            linearised: &self.linearised,
            paths: &self.paths,
            scales: &self.scales,
            layout: &self.layout,
            limit: self.limit,
        }
    }

    /// Each recording beside the model; whether a cause was found.
    pub(super) fn recordings(&self, explained: bool) -> Vec<RecordingComparison> {
        let whitening = Whitening::fit(&self.residual, &self.layout);
        let one_step = whitening.one_step(&self.residual, &self.layout);
        let builder = self.builder();
        let view = Seen { builder: &builder, one_step: &one_step, floor: self.floor, explained };
        (0..self.cases.len()).map(|k| view.recording(k)).collect()
    }

    /// Where that drive fails, which these are the residuals of; the `seed` is that of the bands of the
    /// curves, without which none are drawn.
    pub(super) fn shown(
        &self,
        drive: &OnRecordings,
        evidence: &Evidence,
        setting: &Setting,
        (load, seed): (Load<'_>, Option<u64>),
    ) -> Shown {
        let (builder, layout) = (&self.builder(), &self.layout);
        let memory_s = (0..layout.outputs)
            .map(|j| {
                let remainder = self.remainder.iter().skip(j).step_by(layout.outputs);
                residual::memory_s(&remainder.copied().collect::<Vec<_>>(), layout.group_s)
            })
            .fold(0.0, f64::max);
        let block_s = (BLOCK_MEMORIES * memory_s).clamp(BLOCK_S.0, BLOCK_S.1);
        let base = || self.base.iter().map(Vec::as_slice);
        let waves = angles::wave_numbers(builder, base(), &self.residual);
        let shapes = shapes(builder, &waves.kept);
        let columns = builder.shapes(&shapes);
        let hypotheses = hypotheses(&shapes, waves.looked_at);
        let filtered = OnceLock::new();
        let beside_load = |known: &[Shape], shape: Shape| {
            let at = (evidence, drive.recordings.as_slice());
            let make = || BesideLoad::of(&drive.drive, setting, at, (load, self.limit));
            filtered.get_or_init(make).as_ref()?.p_value(known, shape)
        };
        let data = Data {
            beside_load: &beside_load,
            layout,
            residual: &self.residual,
            base: &self.base,
            shapes,
            columns,
            blocks: layout.blocks(block_s),
            white_blocks: layout.blocks(BLOCK_S.0),
            floor: self.floor,
            hypotheses,
        };
        let found = data.search();
        let drawn = |seed: u64| {
            let waves = || data.shapes.iter().find_map(|it| it.wave_number());
            let of_found = found.iter().find_map(|it| it.shape.wave_number());
            let evidence = curve::Evidence {
                known: &self.known,
                residual: &self.residual,
                blocks: (&data.blocks.0, data.blocks.1),
                seed,
            };
            curves(builder, &evidence, of_found.or_else(waves).unwrap_or(1.0))
        };
        Shown {
            findings: found.iter().map(finding).collect(),
            tested: data.shapes.len(),
            block_s,
            curves: seed.map_or_else(Vec::new, drawn),
        }
    }
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
