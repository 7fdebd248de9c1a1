//! A stretch of time that the user chose: where the model fails within it.

use drivescope_discovery::Evidence;
use drivescope_discovery::compare::{Comparison, Options, compare};
use drivescope_plant::drive::Drive;

use super::rung::Rung;
use crate::failure::told;

/// The comparison of a rung over a stretch of one recording.
///
/// # Errors
/// A stretch that is too short.
pub(super) fn compared(
    rung: &Rung,
    whole: &Evidence,
    recording: usize,
    (from, to): (f64, f64),
    seed: u64,
) -> miette::Result<Comparison> {
    let (Some(measured), Some(noise)) =
        (whole.recordings.get(recording), whole.noise.get(recording))
    else {
        return Err(miette::Report::msg(format!("there is no recording {recording}")));
    };
    // The nearest sample.
    let sample = |time: f64| measured.clock.sample(time + 0.5 * measured.period_s);
    let end = (sample(to) + 1).min(measured.len());
    let part = measured.part(sample(from).min(end)..end).map_err(told)?;
    let evidence = Evidence { recordings: vec![part], noise: vec![noise.clone()] };
    let drive: &Drive = &rung.drive;
    compare(drive, &evidence, &rung.setting, &Options { curves: true, seed }).map_err(told)
}
