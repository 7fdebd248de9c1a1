//! A constant load: an offset of the current sensor, a slope, a cable.
//!
//! It belongs to a first model where the drive moves both ways and the torque balance is explained
//! clearly better with it.

use drivescope_discovery::{Begun, begin, unexplained};
use drivescope_plant::drive::{Drive, EffectData};
use drivescope_recording::Recording;

use super::evidence::seen;
use super::names::{OFFSET, split};

/// A constant load must leave at most this share of what was unexplained without it.
const CLEARLY_LESS: f64 = 0.9;
/// The same drive with a constant load, where that explains the torque clearly better.
pub(super) fn with_constant_load(
    template: &Drive,
    recording: &Recording,
    without: &Begun,
) -> miette::Result<Option<Begun>> {
    let (kind, key) = split(OFFSET);
    let load = EffectData {
        kind: kind.to_owned(),
        id: kind.to_owned(),
        parameters: vec![(key.to_owned(), 0.0)],
        law: None,
    };
    let mut drive = template.clone();
    drive.effects.push(load);
    drive.per_recording.push(OFFSET.to_owned());
    let evidence = seen(&drive, recording)?;
    let begun = begin(&drive, &evidence);
    let remainder = |drive: &Drive| unexplained(drive, &evidence)[0].map(|it| it.rms);
    let (before, after) = (remainder(&without.drive), remainder(&begun.drive));
    let clearly = before.zip(after).is_some_and(|(before, after)| after < CLEARLY_LESS * before);
    Ok((clearly && begun.identified.iter().any(|it| it.name == OFFSET)).then_some(begun))
}
