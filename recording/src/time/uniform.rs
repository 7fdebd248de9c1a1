//! Steps that agree within 1 %: such a recording passes as it is.

/// Largest departure of a time step from the others, relative.
const UNIFORM: f64 = 0.01;
/// A time stamp farther than so many steps off the grid belongs to another sample.
const DRIFT_STEPS: f64 = 0.5;

/// A uniform sampling time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Uniform {
    /// The sampling time, s.
    pub(super) period_s: f64,
    /// Largest departure of a step from the mean, relative.
    pub(super) jitter: f64,
}

/// The sampling time of stamps that are uniform within 1 % and never half a step off their grid.
pub(super) fn uniform(time: &[f64]) -> Option<Uniform> {
    let (first, last, steps) = (time[0], time[time.len() - 1], (time.len() - 1) as f64);
    let mean = (last - first) / steps;
    if !(mean.is_finite() && mean > 0.0) {
        return None;
    }
    let (mut jitter, mut off) = (0.0_f64, 0.0_f64);
    for k in 1..time.len() {
        jitter = jitter.max((time[k] - time[k - 1] - mean).abs() / mean);
        off = off.max((time[k] - (first + k as f64 * mean)).abs());
    }
    let period_s = shortest_period(first, last, steps);
    (jitter <= UNIFORM && off <= DRIFT_STEPS * mean).then_some(Uniform { period_s, jitter })
}

/// The period with the fewest digits that the first and last time stamp allow.
///
/// `(last - first) / steps` carries their rounding: 0.001 s would come back as
/// 0.0009999999999999998 s. Whatever lies within that rounding explains them as well.
fn shortest_period(first: f64, last: f64, steps: f64) -> f64 {
    let mean = (last - first) / steps;
    let rounding = f64::EPSILON * (first.abs().max(last.abs()) / steps + mean.abs());
    shortest(mean, rounding)
}

/// The number with the fewest digits within `off` of a value.
pub(crate) fn shortest(value: f64, off: f64) -> f64 {
    (0..17)
        .map(|digits| format!("{value:.digits$e}"))
        .filter_map(|text| text.parse::<f64>().ok())
        .find(|short| (short - value).abs() <= off)
        .unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_sampling_times_come_back_as_they_are() {
        for period in [0.001, 0.005, 1e-4, 0.0003, 1.0 / 3.0, 2.5e-5, 0.02] {
            for samples in [2, 3, 1000, 24_841] {
                let time: Vec<f64> = (0..samples).map(|k| 7.0 + f64::from(k) * period).collect();
                let found = uniform(&time).unwrap();
                let off = (found.period_s - period).abs();
                // 1/3 s has no short form: it is known to the rounding of the stamps only.
                let allowed = if period == 1.0 / 3.0 { 1e-15 * f64::from(samples) } else { 0.0 };
                assert!(off <= allowed, "{period} over {samples}: {}", found.period_s);
            }
        }
    }

    #[test]
    fn one_per_cent_passes_and_two_do_not() {
        let jittered = |share: f64| -> Vec<f64> {
            (0..100).map(|k| f64::from(k) + if k % 2 == 0 { 0.0 } else { share }).collect()
        };
        assert!(uniform(&jittered(0.009)).unwrap().jitter > 0.008);
        assert_eq!(uniform(&jittered(0.02)), None);
        // Steps of 0.995 and then 1.005: each within 1 % of the mean, yet 2.5 samples off.
        let drifting: Vec<f64> =
            (0..1001).map(|k: i32| f64::from(k) + 0.005 * f64::from((k - 500).abs())).collect();
        assert_eq!(uniform(&drifting), None);
    }
}
