//! An output whose sensor is slower than the recording and keeps its value in between.
//!
//! Held values have no noise from row to row, so that whatever weighs rows by their noise believes them
//! too much. A coarse sensor keeps its value too, but goes on by one level; a held one by as much as
//! the motion went in the meantime.

use drivescope_plant::drive::Drive;
use drivescope_recording::rounded_to;

use super::finding::{Consequence, SignalFinding, Size, What};
use super::outputs::outputs;
use crate::estimate::Evidence;
use crate::measured::{Channel, Measured};

/// Fewest rows that a value is kept for, and fewest such stays.
const ROWS: usize = 3;
const STAYS: usize = 50;
/// Share of the stays that last as long as most do, or a multiple of it, to a row.
const REGULAR: f64 = 0.8;
/// Least usual change over the smallest: of a coarse sensor it is one level.
const LEVELS: f64 = 3.0;

/// The findings.
pub(super) fn check(_: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    outputs(evidence).filter_map(|(measured, channel)| of(measured, channel)).collect()
}

fn of(measured: &Measured, channel: &Channel) -> Option<SignalFinding> {
    let rows = held(&channel.values)?;
    let (name, period_s) = (channel.name, rounded_to(6, rows as f64 * measured.period_s));
    Some(SignalFinding {
        recording: measured.name.clone(),
        channel: name.to_owned(),
        what: What::Held,
        at: None,
        size: Size { value: rows as f64, of: "rows" },
        consequence: Consequence::Limits,
        sentence: format!(
            "{name} changes every {rows} rows only: its sensor is slower than the recording, and what \
             it keeps in between is taken for free of noise"
        ),
        next: format!("give --resample {period_s}, or record {name} at its own rate"),
    })
}

/// Rows that values are kept for, if a sensor holds them.
fn held(values: &[f64]) -> Option<usize> {
    let stays: Vec<&[f64]> =
        values.chunk_by(|a, b| a == b).filter(|it| it[0].is_finite()).collect();
    // The first and the last are cut off.
    let inner = stays.get(1..stays.len().saturating_sub(1)).filter(|it| it.len() >= STAYS)?;
    let mut lengths: Vec<usize> = inner.iter().map(|stay| stay.len()).collect();
    lengths.sort_unstable();
    let usual = lengths[lengths.len() / 2];
    let is_regular = |length: &&usize| {
        let off = **length % usual;
        off <= 1 || off + 1 == usual
    };
    let regular = lengths.iter().filter(is_regular).count();
    let mut changes: Vec<f64> =
        inner.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs()).collect();
    changes.sort_unstable_by(f64::total_cmp);
    let jumps = changes[changes.len() / 2] >= LEVELS * changes[0];
    (usual >= ROWS && regular as f64 >= REGULAR * lengths.len() as f64 && jumps).then_some(usual)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    #[test]
    fn a_slow_sensor_is_told_from_a_coarse_one() {
        let drive = dr300();
        let clean = noisy(bench(&drive, 3.0, 0.001), [0.01, 0.3], 7);
        let found = |of: &dyn Fn(&mut Vec<f64>)| {
            let mut recording = clean.clone();
            of(&mut recording.signals[2].values);
            let measured = Measured::new(&drive, &recording).expect("usable");
            let evidence = Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] };
            check(&drive, &evidence)
        };
        assert_eq!(found(&|_| {}), []);
        assert_eq!(
            found(&|omega| omega.iter_mut().for_each(|it| *it = (*it / 5.0).round() * 5.0)),
            []
        );
        let ramp = |omega: &mut Vec<f64>| {
            (0..omega.len()).for_each(|k| omega[k] = (k as f64 / 8.0).floor());
        };
        assert_eq!(found(&ramp), []);
        let hold =
            |omega: &mut Vec<f64>| (0..omega.len()).for_each(|k| omega[k] = omega[k - k % 12]);
        let slow = found(&hold);
        let [one] = &slow[..] else { panic!("{slow:?}") };
        assert_eq!((one.what, one.size.value, one.channel.as_str()), (What::Held, 12.0, "omega"));
        assert!(one.next.contains("--resample 0.012"), "{}", one.next);
    }
}
