//! An output that its sensor or converter cuts off.

use drivescope_plant::drive::Drive;
use drivescope_recording::{limits, rounded_to};

use super::finding::{Consequence, SignalFinding, Size, Stretch, What};
use super::outputs::outputs;
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured, Output};

/// Stays shorter than this are those of a slow signal in steps.
const STAY: usize = 10;

/// The findings.
pub(super) fn check(_: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    // A position at its extreme rests at a stop.
    let cut =
        outputs(evidence).filter(|(_, it)| matches!(it.output, Output::Current | Output::Speed));
    cut.flat_map(|(measured, channel)| of(measured, channel)).collect()
}

fn of(measured: &Measured, channel: &Channel) -> Vec<SignalFinding> {
    let name = channel.name;
    let said = limits(&channel.values).into_iter().filter(|it| it.longest >= STAY).map(|it| {
        // Rows are counted from 1.
        let from = it.at as usize - 1;
        SignalFinding {
            recording: measured.name.clone(),
            channel: name.to_owned(),
            what: What::Saturated,
            at: Some(Stretch::of(from..from + it.longest, &measured.clock)),
            size: Size { value: it.share, of: "share of the samples" },
            consequence: Consequence::Limits,
            sentence: format!(
                "{name} sits at {} {} for {:.1} % of the samples: the sensor is at its limit, and \
                 the machine beyond it",
                rounded_to(6, it.value),
                channel.unit,
                100.0 * it.share
            ),
            next: format!("record {name} with a larger range, or with less u"),
        }
    });
    said.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    #[test]
    fn a_cut_current_is_saturated_and_a_whole_one_is_not() {
        let drive = dr300();
        let mut recording = noisy(bench(&drive, 3.0, 0.001), [0.01, 0.3], 7);
        let found = |recording: &drivescope_recording::Recording| {
            let measured = Measured::new(&drive, recording).expect("usable");
            check(&drive, &Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] })
        };
        assert_eq!(found(&recording), []);
        recording.signals[1].values.iter_mut().for_each(|i| *i = i.clamp(-0.6, 0.7));
        let found = found(&recording);
        assert_eq!(found.iter().map(|it| it.channel.as_str()).collect::<Vec<_>>(), ["i", "i"]);
        let at = found[0].at.expect("a place");
        let stay = &recording.signals[1].values[at.from..=at.to];
        assert!(stay.iter().all(|i| *i == -0.6) && stay.len() >= STAY, "{at:?}");
    }
}
