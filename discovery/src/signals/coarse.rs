//! An output of which few levels are seen.

use drivescope_plant::drive::Drive;
use drivescope_recording::rounded_to;

use super::finding::{Consequence, SignalFinding, Size, What};
use super::outputs::outputs;
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured};

/// Levels below which the shape of what is missing is that of the converter: half a level is then
/// 3 % of the range, and no effect beside friction is larger.
const LEVELS: usize = 16;

/// The findings.
pub(super) fn check(_: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    outputs(evidence).filter_map(|(measured, channel)| of(measured, channel)).collect()
}

/// Whether any output takes few levels only.
pub(crate) fn is_coarse(evidence: &Evidence) -> bool {
    outputs(evidence).any(|(measured, channel)| of(measured, channel).is_some())
}

fn of(measured: &Measured, channel: &Channel) -> Option<SignalFinding> {
    let mut seen: Vec<f64> = Vec::new();
    for value in channel.values.iter().filter(|it| it.is_finite()) {
        if !seen.contains(value) {
            seen.push(*value);
        }
        if seen.len() >= LEVELS {
            return None;
        }
    }
    let levels = seen.len();
    let range = seen.iter().copied().fold(f64::MIN, f64::max)
        - seen.iter().copied().fold(f64::MAX, f64::min);
    let step = range / levels.saturating_sub(1).max(1) as f64;
    let (name, unit, apart) = (channel.name, &channel.unit, rounded_to(4, step));
    // One level is a shaft at rest.
    (levels > 1).then(|| SignalFinding {
        recording: measured.name.clone(),
        channel: name.to_owned(),
        what: What::Coarse,
        at: None,
        size: Size { value: levels as f64, of: "levels" },
        consequence: Consequence::Limits,
        sentence: format!(
            "{name} takes {levels} levels only, {apart} {unit} apart: what is smaller than a \
             level hardly shows"
        ),
        next: format!("record {name} with more digits or a finer sensor, or over a larger range"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    #[test]
    fn ten_levels_are_coarse_and_a_hundred_are_not() {
        let drive = dr300();
        let mut recording = noisy(bench(&drive, 3.0, 0.001), [0.01, 0.3], 7);
        let mut levels = |count: f64| {
            let omega = &mut recording.signals[2].values;
            let most = omega.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
            let step = 2.0 * most / count;
            omega.iter_mut().for_each(|it| *it = (*it / step).round() * step);
            let measured = Measured::new(&drive, &recording).expect("usable");
            let evidence = Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] };
            check(&drive, &evidence)
        };
        assert_eq!(levels(100.0), []);
        let found = levels(10.0);
        assert_eq!(
            (found.len(), found[0].what, found[0].channel.as_str()),
            (1, What::Coarse, "omega")
        );
        assert!(found[0].size.value <= 11.0, "{:?}", found[0].size);
    }
}
