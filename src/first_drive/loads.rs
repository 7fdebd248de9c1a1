//! Loads that least squares on the balances are tried beside.
//!
//! A constant one (a slope, a cable, an offset of what commands a force) belongs to a first model where
//! the drive moves both ways and the torque balance is explained clearly better with it. An offset of the
//! current sensor looks the same there, but the armature does not feel it; that, and a weight that turns
//! with the shaft, are named by a discovery, and do not belong to a first model. The weight hides an
//! inertia that the balance tells beside it.

use drivescope_discovery::{
    Begun, Evidence, Identified, Options, Output, Setting, begin, fit, unexplained_share,
};
use drivescope_plant::drive::{Drive, EffectData, Input};
use drivescope_plant::effects::registry::Entry;
use drivescope_recording::Recording;

use super::evidence::seen;
use super::names::{CURRENT_OFFSET, OFFSET, WEIGHT, split};

/// A load must leave at most this share of what was unexplained without it.
const CLEARLY_LESS: f64 = 0.9;

/// The same drive with a constant load, where that explains the torque clearly better.
pub(super) fn with_constant_load(
    template: &Drive,
    recording: &Recording,
    without: &Begun,
) -> miette::Result<Option<Begun>> {
    let mut drive = template.clone();
    drive.effects.push(absent(split(OFFSET).0));
    drive.per_recording.push(OFFSET.to_owned());
    let begun = clearly_better(&drive, recording, without)?;
    let told = begun.filter(|it| it.identified.iter().any(|it| it.name == OFFSET));
    let Some(told) = told else { return Ok(None) };
    let evidence = seen(template, recording)?;
    Ok((!is_of_current_sensor(&told.drive, &evidence)).then_some(told))
}

/// Whether an offset of the current sensor fits better than the constant load of that drive.
fn is_of_current_sensor(drive: &Drive, evidence: &Evidence) -> bool {
    let motor = &drive.motor;
    let measured = evidence.recordings[0].output(Output::Current).is_some();
    if motor.input != Input::Voltage || !measured {
        return false;
    }
    let load = split(OFFSET).0;
    let mut shifted = drive.clone();
    let Some(place) = shifted.effects.iter().position(|it| it.kind == load) else { return false };
    shifted.effects.remove(place);
    shifted.effects.push(absent(split(CURRENT_OFFSET).0));
    shifted.per_recording.retain(|name| name != OFFSET);
    shifted.per_recording.push(CURRENT_OFFSET.to_owned());
    // Both run in the same way, so that their errors compare.
    let setting = Setting::of_fit(drive, evidence);
    let error = |drive: &Drive| {
        let fitted = fit(drive, evidence, &setting, &Options::default());
        fitted.map_or(f64::INFINITY, |it| it.squares.sum)
    };
    error(&shifted) < error(drive)
}

/// The inertia that the torque balance tells beside a weight that turns with the shaft, where that
/// explains the torque clearly better.
pub(super) fn inertia_beside_weight(
    drive: &Drive,
    recording: &Recording,
    without: &Begun,
) -> miette::Result<Option<(f64, Identified)>> {
    if recording.signal("theta").is_none() {
        return Ok(None);
    }
    let mut drive = drive.clone();
    drive.effects.push(absent(WEIGHT));
    let begun = clearly_better(&drive, recording, without)?;
    Ok(begun.and_then(|it| {
        let told = it.identified.into_iter().find(|it| it.name == "J")?;
        Some((it.drive.motor.j, told))
    }))
}

/// An effect that does nothing yet.
fn absent(kind: &str) -> EffectData {
    let parameters = Entry::find(kind).map_or(&[][..], |entry| entry.parameters);
    EffectData {
        kind: kind.to_owned(),
        id: kind.to_owned(),
        parameters: parameters.iter().map(|it| (it.name.to_owned(), 0.0)).collect(),
        law: None,
    }
}

/// What least squares give of a drive, where that explains the torque clearly better.
fn clearly_better(
    drive: &Drive,
    recording: &Recording,
    without: &Begun,
) -> miette::Result<Option<Begun>> {
    let evidence = seen(drive, recording)?;
    let begun = begin(drive, &evidence);
    let remainder = |drive: &Drive| unexplained_share(drive, &evidence);
    let both = remainder(&without.drive).zip(remainder(&begun.drive));
    let clearly = both.is_some_and(|(before, after)| after < CLEARLY_LESS * before);
    Ok(clearly.then_some(begun))
}
