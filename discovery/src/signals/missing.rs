//! Outputs of which many values are not there.

use drivescope_plant::drive::Drive;

use super::finding::{Consequence, SignalFinding, Size, Stretch, What};
use super::outputs::outputs;
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured};

/// Share of the samples from which on it is said: the reader tells of every hole.
const MANY: f64 = 0.05;

/// The findings.
pub(super) fn check(_: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    outputs(evidence).filter_map(|(measured, channel)| of(measured, channel)).collect()
}

fn of(measured: &Measured, channel: &Channel) -> Option<SignalFinding> {
    let within = || measured.pieces.iter().cloned().flatten();
    let holes = || within().filter(|k| !channel.values[*k].is_finite());
    let share = holes().count() as f64 / within().count() as f64;
    let samples = holes().next()?..holes().next_back()? + 1;
    let name = channel.name;
    (share > MANY).then(|| SignalFinding {
        recording: measured.name.clone(),
        channel: name.to_owned(),
        what: What::Missing,
        at: Some(Stretch::of(samples, &measured.clock)),
        size: Size { value: share, of: "share of the samples" },
        consequence: Consequence::Limits,
        sentence: format!(
            "{:.1} % of the samples of {name} are missing: it tells as much less",
            100.0 * share
        ),
        next: format!("record {name} without holes"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300};

    #[test]
    fn many_holes_are_said_with_their_place() {
        let drive = dr300();
        let mut recording = bench(&drive, 1.0, 0.001);
        let mut found = |from: usize, to: usize| {
            recording.signals[1].values[from..to].fill(f64::NAN);
            let measured = Measured::new(&drive, &recording).expect("usable");
            check(&drive, &Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] })
        };
        assert_eq!(found(100, 140), []);
        let found = found(200, 300);
        let at = found[0].at.expect("a place");
        assert_eq!((found[0].channel.as_str(), at.from, at.to), ("i", 100, 299));
        assert!((found[0].size.value - 0.14).abs() < 1e-12 && (at.to_s - 0.299).abs() < 1e-12);
    }
}
