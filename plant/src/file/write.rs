//! From a [`Drive`] back to its file.

use super::curve::{BALANCES, factors, overs};
use super::custom::target_key;
use super::layout::{EffectTable, EffectValue, FitTable, Layout, NoiseTable, Origin};
use crate::drive::{Drive, EffectData, Field, LawData, Motion, SensorData, fields};

/// The tables of a drive.
pub(super) fn layout(drive: &Drive) -> Layout {
    Layout {
        schema: 1,
        name: drive.name.clone(),
        motion: drive.motion,
        motor: drive.motor,
        effect: effects(&drive.effects, drive.motion),
        controller: drive.controller,
        amplifier: drive.amplifier,
        generator: drive.generator,
        sensors: (drive.sensors != SensorData::default()).then_some(drive.sensors),
        noise: noise(drive),
        fit: (!drive.fixed.is_empty() || !drive.per_recording.is_empty()).then(|| FitTable {
            fixed: drive.fixed.clone(),
            per_recording: drive.per_recording.clone(),
        }),
        origin: drive.origin.iter().map(|(k, v)| (k.clone(), Origin::Text(v.clone()))).collect(),
    }
}

/// The tables of some effects.
pub(super) fn effects(effects: &[EffectData], motion: Motion) -> Vec<EffectTable> {
    effects.iter().map(|one| effect(one, motion)).collect()
}

fn effect(effect: &EffectData, motion: Motion) -> EffectTable {
    let text = |key: &str, text: &str| (key.to_owned(), EffectValue::Text(text.to_owned()));
    let mut table = vec![text("kind", &effect.kind)];
    if effect.id != effect.kind {
        table.push(text("id", &effect.id));
    }
    match &effect.law {
        None => {
            let number =
                |(name, value): &(String, f64)| (name.clone(), EffectValue::Number(*value));
            table.extend(effect.parameters.iter().map(number));
        }
        Some(LawData::Typed { target, text: law }) => {
            table.push(text(target_key(*target, motion), law));
            if !effect.parameters.is_empty() {
                let coefficients = EffectValue::Coefficients(effect.parameters.clone());
                table.push(("parameters".to_owned(), coefficients));
            }
        }
        Some(LawData::Learned { target, over, times, knots }) => {
            let balance = BALANCES.iter().find(|(_, other)| other == target);
            let of_motion = overs(motion).into_iter().rfind(|(_, other)| other == over);
            let list = |key: &str, all: Vec<f64>| (key.to_owned(), EffectValue::List(all));
            table.push(text("balance", balance.expect("a curve acts in a balance").0));
            table.push(text("over", of_motion.expect("every variable has a name").0));
            if let Some(times) = times {
                let name = factors(motion).into_iter().rfind(|(_, other)| other == times);
                table.push(text("times", name.expect("every factor has a name").0));
            }
            table.push(list("knots", knots.clone()));
            table.push(list("values", effect.parameters.iter().map(|(_, v)| *v).collect()));
        }
    }
    EffectTable(table)
}

/// The noise under the names of the drive's motion; zero, for none, goes unsaid.
fn noise(drive: &Drive) -> Option<NoiseTable> {
    let of_noise = fields().filter(|field| field.section == "noise");
    let number = |field: &Field| Some((field.key(drive.motion), (field.get)(drive)?));
    let numbers: Vec<_> = of_noise.filter_map(number).filter(|(_, value)| *value != 0.0).collect();
    (!numbers.is_empty()).then_some(NoiseTable::Written(numbers))
}
