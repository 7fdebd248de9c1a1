//! Several healthy recordings as the two that a training takes.

use drivescope_recording::{Break, Recording, Signal};

/// Pause between two recordings in the time of the joined one, s; nothing depends on it.
const PAUSE_S: f64 = 1.0;

/// Every other recording in one, and those between in a second one: both see what changed over
/// the time of the recordings.
pub(super) fn alternating(recordings: &[Recording]) -> Vec<Recording> {
    let of = |first: usize| joined(recordings.iter().skip(first).step_by(2));
    (0..2).filter_map(of).collect()
}

/// Recordings as segments of one; signals that not all of them have are left out.
fn joined<'a>(recordings: impl Iterator<Item = &'a Recording>) -> Option<Recording> {
    recordings.cloned().reduce(|mut all, next| {
        let at = all.len();
        let later = all.time(at.saturating_sub(1)) + PAUSE_S - next.start_s;
        all.breaks.push(Break { at, start_s: next.start_s + later });
        let breaks = next.breaks.iter();
        all.breaks.extend(breaks.map(|it| Break { at: at + it.at, start_s: it.start_s + later }));
        let same = |signal: &Signal| {
            let other = next.signal(&signal.name);
            other.filter(|other| other.unit == signal.unit).cloned()
        };
        let both = all.signals.into_iter().filter_map(|mut signal| {
            signal.values.extend(same(&signal)?.values);
            Some(signal)
        });
        all.signals = both.collect();
        all
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_become_segments() {
        let recording = |values: Vec<f64>| {
            let signal = Signal { name: "T".to_owned(), unit: "rpm".to_owned(), values };
            Recording::new("one", 5.0, 0.5, vec![signal])
        };
        let all: Vec<Recording> =
            [vec![1.0, 2.0], vec![3.0], vec![4.0]].into_iter().map(recording).collect();
        let [first, second] = &alternating(&all)[..] else { panic!("two") };
        assert_eq!(
            (first.signals[0].values.as_slice(), first.segments()),
            (&[1.0, 2.0, 4.0][..], vec![0..2, 2..3])
        );
        assert_eq!((first.time(2), second.len()), (6.5, 1));
        assert!(first.check().is_ok());
    }
}
