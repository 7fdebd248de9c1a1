//! How far the recordings of a drive go: what grids of shapes and curves are scaled to.

use drivescope_plant::drive::{Drive, Motion};
use drivescope_plant::effects::grid::{SLOW_SPEED, Spans};
use drivescope_plant::effects::registry::Entry;

use crate::balances::friction_at_rest;
use crate::estimate::Evidence;
use crate::measured::{Measured, Output, largest};

/// Samples over which a position is differentiated.
const SPAN: usize = 10;

/// Of the drive, over all recordings.
pub(crate) fn spans(drive: &Drive, evidence: &Evidence) -> Spans {
    let most =
        |of: &dyn Fn(&Measured) -> f64| evidence.recordings.iter().map(of).fold(0.0, f64::max);
    let speed = most(&fastest);
    Spans {
        rotary: drive.motion == Motion::Rotary,
        inertia: drive.motor.j,
        resistance: drive.motor.r.unwrap_or(1.0),
        dry: dry(drive),
        speed,
        current: most(&|one| largest(one.current(drive))),
        heat: most(&|one| one.current(drive).map(|i| i * i).sum::<f64>() * one.period_s),
        voltage: most(&|one| largest(one.u.iter().copied())),
        travel: most(&travel),
        step: step(evidence, speed),
        duration_s: most(&|one| one.len() as f64 * one.period_s),
        period_s: evidence.recordings.iter().map(|it| it.period_s).fold(f64::INFINITY, f64::min),
        slow: slow(evidence, SLOW_SPEED * speed),
    }
}

/// Whether a machine may have the values of those effects of a drive, by their ids, as far as recordings
/// go.
pub(super) fn are_possible(drive: &Drive, those: impl Fn(&str) -> bool, spans: &Spans) -> bool {
    drive.effects.iter().filter(|effect| those(&effect.id)).all(|effect| {
        let values: Vec<f64> = effect.parameters.iter().map(|(_, value)| *value).collect();
        Entry::find(&effect.kind).is_none_or(|law| (law.info.possible)(&values, spans))
    })
}

/// Mean level of dry friction of both directions at rest, N m (N).
fn dry(drive: &Drive) -> f64 {
    let torques = friction_at_rest(drive);
    0.5 * (torques.forward + torques.backward)
}

fn fastest(measured: &Measured) -> f64 {
    match (measured.output(Output::Speed), measured.output(Output::Position)) {
        (Some(speed), _) => largest(speed.values.iter().copied()),
        (None, Some(x)) => {
            let span = SPAN as f64 * measured.period_s;
            largest(x.values.windows(SPAN + 1).map(|part| (part[SPAN] - part[0]) / span))
        }
        (None, None) => 0.0,
    }
}

/// Share of all samples with a speed between rest and that.
fn slow(evidence: &Evidence, below: f64) -> f64 {
    let (mut slow, mut all) = (0.0, 0.0_f64);
    for measured in &evidence.recordings {
        let mut see = |speed: f64| {
            if speed.is_finite() {
                all += 1.0;
                slow += f64::from(u8::from(speed.abs() < below && speed != 0.0));
            }
        };
        match (measured.output(Output::Speed), measured.output(Output::Position)) {
            (Some(speed), _) => {
                let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
                speed.values.windows(SPAN).for_each(|part| see(mean(part)));
            }
            (None, Some(x)) => {
                let span = SPAN as f64 * measured.period_s;
                x.values.windows(SPAN + 1).for_each(|part| see((part[SPAN] - part[0]) / span));
            }
            (None, None) => {}
        }
    }
    slow / all.max(1.0)
}

/// Way from one sample to the next, rad (m), that a tenth of the motion stays below.
fn step(evidence: &Evidence, fastest: f64) -> f64 {
    /// Share of the fastest speed from which on a shaft moves.
    const MOVES: f64 = 0.01;
    const TENTH: f64 = 0.1;
    let each = evidence.recordings.iter().flat_map(|it| {
        let shown = it.output(Output::Speed).map(|speed| speed.values.iter().map(|v| v.abs()));
        let steps: Vec<f64> = match (shown, it.output(Output::Position)) {
            (Some(speeds), _) => speeds.map(|speed| speed * it.period_s).collect(),
            (None, Some(x)) => x.values.windows(2).map(|two| (two[1] - two[0]).abs()).collect(),
            (None, None) => Vec::new(),
        };
        let least = MOVES * fastest * it.period_s;
        steps.into_iter().filter(move |step| *step > least)
    });
    let mut steps: Vec<f64> = each.collect();
    if steps.is_empty() {
        return 0.0;
    }
    let at = (TENTH * steps.len() as f64) as usize;
    *steps.select_nth_unstable_by(at, f64::total_cmp).1
}

fn travel(measured: &Measured) -> f64 {
    let position = measured.output(Output::Position).map(|channel| &channel.values);
    let Some(way) = measured.angle.as_ref().or(position) else { return 0.0 };
    let finite = || way.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low < high { high - low } else { 0.0 }
}
