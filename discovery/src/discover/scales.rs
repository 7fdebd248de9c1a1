//! What the recordings span: the scales from which start values and grids of shapes are made.

use drivescope_plant::drive::{Drive, Input};

use crate::estimate::Evidence;
use crate::measured::{Measured, Output};

/// Share of the fastest speed below which motion is slow.
pub(crate) const SLOW_SPEED: f64 = 0.1;
/// Samples over which a position is differentiated.
const SPAN: usize = 10;

/// The largest magnitudes that were recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    /// Speed, rad/s (m/s).
    pub(crate) speed: f64,
    /// Current, A (the commanded signal of a force-driven drive).
    pub(crate) current: f64,
    /// Integral of the squared current over a recording, A^2 s.
    pub(crate) heat: f64,
    /// Voltage, V (the commanded signal of a force-driven drive).
    pub(crate) voltage: f64,
    /// Way from the least to the greatest position, rad (m); 0 where none is known.
    pub(crate) travel: f64,
    /// Length of the longest recording, s.
    pub(crate) duration_s: f64,
    /// Share of the time that the shaft moves slower than a tenth of the fastest speed.
    pub(crate) slow: f64,
}

impl Scales {
    /// Over all recordings.
    pub(crate) fn of(drive: &Drive, evidence: &Evidence) -> Self {
        let most =
            |of: &dyn Fn(&Measured) -> f64| evidence.recordings.iter().map(of).fold(0.0, f64::max);
        let voltage = most(&|one| largest(one.u.iter().copied()));
        Self {
            speed: most(&fastest),
            current: most(&|one| largest(current(drive, one))),
            heat: most(&|one| current(drive, one).map(|i| i * i).sum::<f64>() * one.period_s),
            voltage,
            travel: most(&travel),
            duration_s: most(&|one| one.len() as f64 * one.period_s),
            slow: slow(evidence, SLOW_SPEED * most(&fastest)),
        }
    }
}

/// Current of every sample; without a measured one, the most that u can drive, and of a
/// force-driven drive the commanded signal.
fn current<'a>(drive: &Drive, one: &'a Measured) -> impl Iterator<Item = f64> + 'a {
    let (values, factor) = match (drive.motor.input, one.output(Output::Current)) {
        (Input::Force, _) => (&one.u, 1.0),
        (Input::Voltage, Some(channel)) => (&channel.values, 1.0),
        (Input::Voltage, None) => (&one.u, 1.0 / drive.motor.r.unwrap_or(1.0)),
    };
    values.iter().map(move |value| factor * value).filter(|value| value.is_finite())
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(0.0, |most, value| most.max(value.abs()))
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

fn travel(measured: &Measured) -> f64 {
    let position = measured.output(Output::Position).map(|channel| &channel.values);
    let Some(way) = measured.angle.as_ref().or(position) else { return 0.0 };
    let finite = || way.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low < high { high - low } else { 0.0 }
}
