//! A stretch of time that the user chose: where the model fails within it.

use std::ops::Range;

use drivescope_discovery::compare::{Comparison, Options, compare};
use drivescope_discovery::{Evidence, Measured, evaluate};

use super::session_step::SessionStep;
use crate::evidence::Gathered;
use crate::failure::into_report;

/// A step over a stretch of one recording.
pub(super) struct Window {
    /// Where the model fails.
    pub(super) compared: Comparison,
    /// Errors on what it is fitted to, and on what only judges, as far as the stretch has them.
    pub(super) errors: Vec<(&'static str, f64)>,
}

/// The comparison of a step over a stretch of one recording.
///
/// # Errors
/// A stretch that is too short.
pub(super) fn compared(
    step: &SessionStep,
    (whole, gathered): (&Evidence, &Gathered),
    recording: usize,
    (from, to): (f64, f64),
    seed: u64,
) -> miette::Result<Window> {
    let (Some(measured), Some(noise)) =
        (whole.recordings.get(recording), whole.noise.get(recording))
    else {
        return Err(miette::Report::msg(format!("there is no recording {recording}")));
    };
    // The nearest sample.
    let sample = |time: f64| measured.clock.sample(time + 0.5 * measured.period_s);
    let end = (sample(to) + 1).min(measured.len());
    let range = sample(from).min(end)..end;
    let part = |range: Range<usize>| {
        let part = measured.part(range).map_err(into_report)?;
        Ok::<_, miette::Report>(Evidence { recordings: vec![part], noise: vec![noise.clone()] })
    };
    let drive = &step.drive;
    let options = Options { curves: true, seed, fit: false };
    let compared =
        compare(drive, &part(range.clone())?, &step.setting, &options).map_err(into_report)?;
    let judges = gathered.estimation.recordings.get(recording).map_or(0, Measured::len);
    let parts = [
        ("what it is fitted to", range.start..range.end.min(judges)),
        ("what only judges", range.start.max(judges)..range.end),
    ];
    let parts: Vec<_> = parts.into_iter().filter(|(_, part)| !part.is_empty()).collect();
    let errors = match parts.as_slice() {
        [(of, _)] => vec![(*of, compared.error)],
        // One figure over both would be that of neither. What is too short for one has none.
        _ => parts
            .into_iter()
            .filter_map(|(of, range)| {
                let judged = evaluate(drive, &part(range).ok()?, &step.setting, true).ok()?;
                Some((of, judged.squares.error()))
            })
            .collect(),
    };
    Ok(Window { compared, errors })
}
