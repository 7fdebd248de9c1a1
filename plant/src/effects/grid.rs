//! Grids of shapes: what a law depends on besides its coefficients, scaled to a drive and to how far
//! its recordings go. A discovery weighs the law at each of them.

use std::f64::consts::{PI, TAU};

/// How far the recordings of a drive go, as greatest magnitudes, and the drive's own scales.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spans {
    /// Whether the drive turns; else it moves along a line.
    pub rotary: bool,
    /// Inertia J, kg m^2 (kg).
    pub inertia: f64,
    /// Resistance R, ohm; 1 where there is no armature circuit.
    pub resistance: f64,
    /// Level of dry friction at rest, N m (N).
    pub dry: f64,
    /// Speed, rad/s (m/s).
    pub speed: f64,
    /// Current, A (the commanded signal of a force-driven drive).
    pub current: f64,
    /// Integral of the squared current over a recording, A^2 s.
    pub heat: f64,
    /// Voltage, V (the commanded signal of a force-driven drive).
    pub voltage: f64,
    /// Way from the least to the greatest position, rad (m); 0 where none is known.
    pub travel: f64,
    /// Way from one sample to the next, rad (m), that a tenth of the motion stays below; 0 where none is
    /// known.
    pub step: f64,
    /// Length of the longest recording, s.
    pub duration_s: f64,
    /// Shortest sampling time, s.
    pub period_s: f64,
    /// Share of the time in which the shaft moves, but slower than [`SLOW_SPEED`].
    pub slow: f64,
}

/// Share of the fastest speed below which motion is slow.
pub const SLOW_SPEED: f64 = 0.1;

impl Spans {
    /// One radian of a rotor, or the way of an axis that compares with it.
    pub(super) fn radian(&self) -> f64 {
        /// Of the travel.
        const RADIAN: f64 = 0.02;
        if self.rotary { 1.0 } else { RADIAN * self.travel }
    }

    /// Half the sampling frequency, Hz: what swings faster is not seen, and takes many sub-steps.
    pub(super) fn nyquist_hz(&self) -> f64 {
        0.5 / self.period_s
    }
}

/// Values of some parameters of a law, by their names: one choice of its shape.
pub type Shape = Vec<(&'static str, f64)>;

/// The grid of a law that has no shape, or whose nominal one will do.
pub fn nominal(_: &Spans) -> Vec<Shape> {
    vec![Shape::new()]
}

/// A shape for each value of one parameter.
pub(super) fn each(name: &'static str, values: impl IntoIterator<Item = f64>) -> Vec<Shape> {
    values.into_iter().map(|value| vec![(name, value)]).collect()
}

/// Most periods a revolution of which all are searched.
const MOST_PERIODS: usize = 48;
/// Further ones: the least common multiples of usual numbers of slots and poles, and six a pair of poles.
const FURTHER: [usize; 13] = [54, 60, 66, 72, 84, 90, 96, 108, 120, 126, 132, 144, 168];
/// Periods that must have passed by for a repetition to be seen: along fewer a wave is any smooth curve.
pub(super) const REPEATED: f64 = 2.0;

/// The least number of periods a revolution that repeats on the way of a rotor; 0 where no way is known.
fn least_repeated(spans: &Spans) -> usize {
    if spans.travel > 0.0 { (REPEATED * TAU / spans.travel).ceil() as usize } else { 0 }
}

/// Whether samples lie close enough for a wave of that many periods a revolution, or that wave number,
/// rad/m: two in a period, or it is not told from slower ones.
pub(super) fn is_resolved(periods: f64, spans: &Spans) -> bool {
    periods * spans.step < PI
}

/// Numbers of periods a revolution that recordings can show.
fn countable(least: usize, spans: &Spans) -> impl Iterator<Item = f64> {
    let least = least.max(least_repeated(spans));
    let all = (1..=MOST_PERIODS).chain(FURTHER).filter(move |n| *n >= least);
    all.map(|n| n as f64).filter(|n| is_resolved(*n, spans))
}

/// Why the way of a rotor shows no repetition.
pub(super) fn never_repeats(spans: &Spans) -> Option<String> {
    if !spans.rotary || countable(1, spans).next().is_some() {
        return None;
    }
    Some(if is_resolved(1.0, spans) {
        format!(
            "shows in what repeats with the angle, and the shaft turns by {:.2e} rad only: record \
             longer ways",
            spans.travel
        )
    } else {
        format!(
            "shows in what repeats with the angle, and the shaft turns by {:.1} rad from one sample to \
             the next: record slower motion",
            spans.step
        )
    })
}

/// Numbers of periods a revolution from `least` on that repeat on the way of the rotor, or wave numbers
/// of an axis, rad/m.
pub(super) fn periods(name: &'static str, least: usize, spans: &Spans) -> Vec<Shape> {
    /// Shortest spatial period on an axis over its travel: finer ones are not searched.
    const FINEST: f64 = 240.0;
    /// Steps of the search a wave over the travel: two neighbours differ by half a wave at its end.
    const STEPS: f64 = 2.0;
    if spans.rotary {
        let mut counted: Vec<f64> = countable(least, spans).collect();
        if counted.is_empty() {
            // A grid is never empty; what it holds then is not weighed, for it is never seen.
            counted.push(least as f64);
        }
        return each(name, counted);
    }
    let one = TAU / spans.travel.max(f64::MIN_POSITIVE);
    let wave = |k: usize| k as f64 / STEPS * one;
    let shown = (4..=(FINEST * STEPS) as usize).filter(|k| *k == 4 || is_resolved(wave(*k), spans));
    each(name, shown.map(wave))
}

/// Whether a motor that was run up to its greatest current may have that share of its flux left there.
pub(super) fn has_flux(share: f64) -> bool {
    /// What is left of less is no motor any more: makers' curves end at about half of the torque
    /// constant.
    const LEAST: f64 = 0.3;
    share >= LEAST
}

/// Whether a voltage that is lost on the way leaves the armature enough of what was applied.
pub(super) fn reaches_the_armature(lost: f64, spans: &Spans) -> bool {
    /// Of the greatest voltage: bridges keep back some per cent, brushes a volt or two; where a third is
    /// lost with the sign of the motion, it is friction that holds the shaft.
    const MOST: f64 = 1.0 / 3.0;
    lost <= MOST * spans.voltage
}

/// Currents over which a voltage drop is rounded.
pub(super) fn rounded(name: &'static str, spans: &Spans) -> Vec<Shape> {
    /// Over the greatest current.
    const ROUNDED: [f64; 3] = [0.005, 0.02, 0.07];
    each(name, ROUNDED.map(|share| share * spans.current))
}

/// Time constants of slow changes, s.
pub(super) fn slow_times(spans: &Spans) -> [f64; 3] {
    /// Over the length of the recording.
    const SLOW: [f64; 3] = [0.25, 0.8, 3.0];
    SLOW.map(|share| share * spans.duration_s)
}

/// Whether a change with that time constant, s, is still going on when a start is over.
pub(super) fn is_slow(tau_s: f64, spans: &Spans) -> bool {
    /// Of the length of the recording: what is over sooner belongs to its beginning, not to warming.
    const START: f64 = 0.1;
    tau_s >= START * spans.duration_s
}

/// What recordings of a small drive span.
#[cfg(test)]
pub(super) const SPANS: Spans = Spans {
    rotary: true,
    inertia: 1e-4,
    resistance: 2.0,
    dry: 0.02,
    speed: 300.0,
    current: 4.0,
    heat: 30.0,
    voltage: 24.0,
    travel: 500.0,
    step: 0.01,
    duration_s: 8.0,
    period_s: 1e-3,
    slow: 0.2,
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::registry::REGISTRY;

    #[test]
    fn what_repeats_is_seen_over_two_periods() {
        let within = |travel: f64| Spans { travel, ..SPANS };
        let least = |travel: f64| periods("N", 2, &within(travel))[0][0].1;
        assert_eq!((least(0.0), least(500.0), least(2.0)), (2.0, 2.0, 7.0));
        assert!(never_repeats(&within(2.0)).is_none() && never_repeats(&within(0.0)).is_none());
        assert!(never_repeats(&within(0.05)).is_some_and(|why| why.contains("5.00e-2 rad")));
        assert!(never_repeats(&Spans { rotary: false, ..within(0.2) }).is_none());
    }

    #[test]
    fn what_passes_between_two_samples_is_not_searched() {
        let most = |step: f64| periods("N", 2, &Spans { step, ..SPANS }).last().expect("one")[0].1;
        assert_eq!((most(0.0), most(0.04), most(0.1), most(0.3)), (168.0, 72.0, 31.0, 10.0));
        let fast = Spans { step: 4.0, ..SPANS };
        assert!(never_repeats(&fast).is_some_and(|why| why.contains("4.0 rad from one sample")));
        assert_eq!(periods("N", 2, &fast).len(), 1);
    }

    /// A shape that no grid names would be weighed at its nominal value alone.
    #[test]
    fn every_parameter_vanishes_or_stands_in_the_grid() {
        for spans in [SPANS, Spans { rotary: false, ..SPANS }] {
            for entry in REGISTRY.iter().filter(|entry| entry.info.unweighed.is_none()) {
                let shapes = (entry.info.grid)(&spans);
                assert!(!shapes.is_empty(), "{}", entry.info.id);
                for parameter in entry.parameters {
                    let name = parameter.name;
                    let vanishes =
                        entry.info.nulls.iter().any(|(it, null)| *it == name && null.is_finite());
                    let of =
                        |shape: &Shape| shape.iter().find(|(it, _)| *it == name).map(|it| it.1);
                    let in_all = shapes.iter().all(|shape| of(shape).is_some());
                    assert!(vanishes || in_all, "{}.{name} has no shape", entry.info.id);
                    let (low, high) = parameter.range;
                    let possible = |value: f64| (low..=high).contains(&value);
                    assert!(shapes.iter().filter_map(of).all(possible), "{}.{name}", entry.info.id);
                }
                let known = |name: &&str| entry.parameters.iter().any(|it| it.name == *name);
                assert!(entry.info.counts.iter().all(known), "{}", entry.info.id);
                assert!(shapes.iter().flatten().all(|(name, _)| known(name)), "{}", entry.info.id);
            }
        }
    }
}
