//! The signals of a recording as the balances see them: means over intervals between samples.
//!
//! u is held over an interval, so its mean is exact; current, speed and angle are trapezoids, their
//! derivatives differences. A position alone gives the mean speed exactly, and the acceleration by
//! differences of neighbouring means. Averaging such means over windows integrates the balances:
//! nothing is differentiated twice.

use std::ops::Range;

use crate::measured::{Measured, Output};

/// Intervals between samples in which everything that was measured is known.
#[derive(Debug, Clone, Default)]
pub(super) struct Run {
    /// Time of the first interval's beginning, s.
    pub(super) start_s: f64,
    /// What drives, in its unit.
    pub(super) u: Vec<f64>,
    /// Load torque or force.
    pub(super) load: Vec<f64>,
    /// Current and its derivative, A and A/s; empty where it was not measured.
    pub(super) current: Vec<f64>,
    pub(super) slope: Vec<f64>,
    /// Speed and acceleration, rad/s and rad/s^2 (m/s and m/s^2).
    pub(super) speed: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    /// Position, rad (m); zero where nothing tells it.
    pub(super) angle: Vec<f64>,
}

/// The runs of a recording; none if no motion was measured.
pub(super) fn runs(measured: &Measured) -> Vec<Run> {
    let finite = |k: usize| measured.outputs.iter().all(|channel| channel.values[k].is_finite());
    let mut runs: Vec<Range<usize>> = Vec::new();
    for piece in &measured.pieces {
        let mut open = false;
        for k in piece.clone().filter(|k| finite(*k)) {
            match runs.last_mut().filter(|last| open && last.end == k) {
                Some(last) => last.end = k + 1,
                None => runs.push(k..k + 1),
            }
            open = true;
        }
    }
    runs.into_iter().filter_map(|run| of(measured, run)).collect()
}

fn of(measured: &Measured, samples: Range<usize>) -> Option<Run> {
    let h = measured.period_s;
    let values = |output| measured.output(output).map(|it| &it.values[samples.clone()]);
    let mean = |y: &[f64]| y.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<_>>();
    let change = |y: &[f64]| y.windows(2).map(|pair| (pair[1] - pair[0]) / h).collect::<Vec<_>>();
    let (speed, position) = (values(Output::Speed), values(Output::Position));
    let [shown, acceleration] = motion(speed, position, h)?;
    // A position alone tells no acceleration over the first interval and the last.
    let inner = if speed.is_some() { 0 } else { 1 };
    let intervals = shown.len();
    let cut = |all: Vec<f64>| all[inner..inner + intervals].to_vec();
    let current = values(Output::Current);
    let held = |all: &[f64]| all[samples.clone()][inner..inner + intervals].to_vec();
    let known = measured.angle.as_ref().map(|angle| &angle[samples.clone()]);
    Some(Run {
        start_s: measured.time(samples.start + inner),
        u: held(&measured.u),
        load: measured.load.as_ref().map_or(vec![0.0; intervals], |load| held(load)),
        current: current.map_or(vec![], |i| cut(mean(i))),
        slope: current.map_or(vec![], |i| cut(change(i))),
        speed: shown,
        acceleration,
        angle: position.or(known).map_or(vec![0.0; intervals], |angle| cut(mean(angle))),
    })
}

/// Speed and acceleration over the intervals; none if there are too few samples.
fn motion(speed: Option<&[f64]>, position: Option<&[f64]>, h: f64) -> Option<[Vec<f64>; 2]> {
    match (speed, position) {
        (Some(speed), _) if speed.len() > 1 => {
            let pairs = || speed.windows(2);
            let means = pairs().map(|pair| 0.5 * (pair[0] + pair[1]));
            Some([means.collect(), pairs().map(|pair| (pair[1] - pair[0]) / h).collect()])
        }
        (None, Some(x)) if x.len() > 3 => {
            let fours = || x.windows(4);
            let bend = |four: &[f64]| (four[3] - four[2] - four[1] + four[0]) / (2.0 * h * h);
            Some([
                fours().map(|four| (four[2] - four[1]) / h).collect(),
                fours().map(bend).collect(),
            ])
        }
        _ => None,
    }
}

/// Means over `length` intervals of means over as many: entry k is centred on interval
/// k + length - 1.
pub(super) fn averaged(values: &[f64], length: usize) -> Vec<f64> {
    let once = |values: &[f64]| -> Vec<f64> {
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        sums.extend(values.iter().map(|value| {
            sum += value;
            sum
        }));
        sums.windows(length + 1).map(|some| (some[length] - some[0]) / length as f64).collect()
    };
    if length == 1 { values.to_vec() } else { once(&once(values)) }
}

/// Variances of averaged speed and acceleration that white noise of variance 1 of the measured
/// speed (or position, if that is what was measured) makes.
pub(super) fn noise_of_motion(by_position: bool, h: f64, length: usize) -> [f64; 2] {
    let mut impulse = vec![0.0; 4 * length + 8];
    impulse[2 * length + 4] = 1.0;
    let shown =
        if by_position { motion(None, Some(&impulse), h) } else { motion(Some(&impulse), None, h) };
    shown.map_or([0.0; 2], |both| both.map(|values| power(&averaged(&values, length))))
}

/// The same of a measured current and its derivative.
pub(super) fn noise_of_current(h: f64, length: usize) -> [f64; 2] {
    noise_of_motion(false, h, length)
}

fn power(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, gaussian};

    #[test]
    fn holes_part_the_runs_and_means_are_those_of_the_motion() {
        let drive = dr300();
        let mut recording = bench(&drive, 1.0, 0.001);
        recording.signals[2].values[400] = f64::NAN;
        let measured = Measured::new(&drive, &recording).expect("usable");
        let runs = runs(&measured);
        assert_eq!(runs.iter().map(|run| run.speed.len()).collect::<Vec<_>>(), [399, 598]);
        assert!((runs[1].start_s - 0.401).abs() < 1e-12);
        recording.signals.retain(|signal| ["u", "theta"].contains(&signal.name.as_str()));
        let by_angle = super::runs(&Measured::new(&drive, &recording).expect("usable"));
        assert_eq!(by_angle[0].speed.len(), 997);
        let of = |k: usize| {
            (averaged(&runs[0].acceleration, 5)[k + 1], averaged(&by_angle[0].acceleration, 5)[k])
        };
        // Away from the steps of u both tell the same acceleration.
        let (a, b) = of(100);
        assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
    }

    #[test]
    fn windows_let_as_much_noise_in_as_is_said() {
        let noise = gaussian(200_000, 3);
        for by_position in [false, true] {
            let shown = if by_position {
                motion(None, Some(&noise), 0.01)
            } else {
                motion(Some(&noise), None, 0.01)
            };
            let expected = noise_of_motion(by_position, 0.01, 4);
            for (values, expected) in shown.expect("long enough").iter().zip(expected) {
                let averaged = averaged(values, 4);
                let found = power(&averaged) / averaged.len() as f64;
                assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
            }
        }
    }
}
