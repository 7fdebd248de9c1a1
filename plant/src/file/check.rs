//! From the tables of the file to a [`Drive`]: the rules between keys.

use std::collections::BTreeMap;
use std::ops::Range;

use super::document::{Document, Spans};
use super::effects;
use super::error::{Flaw, Problem};
use super::layout::{Layout, NoiseTable, Origin};
use crate::drive::{
    Drive, EffectData, Input, LawData, Motion, MotorData, NoiseData, SensorData, fields,
};
use crate::effects::refusal::Refusal;
use crate::effects::registry::{Entry, Kind};
use crate::parameters::{NamedParameter, Role, allowed, nearest, possible};

/// The format that this program reads and writes.
const SCHEMA: i64 = 1;
const NO_CIRCUIT: &str =
    "with `input = \"force\"` there is no armature circuit, u x K_m is the torque or force itself";

/// Checks the rules between keys and puts the drive together.
pub(super) fn drive(document: &Document<'_>, layout: Layout) -> Result<Drive, Flaw> {
    if layout.schema != SCHEMA {
        let span = Document::spans(&document.root, "schema").map_or(0..0, |spans| spans.value);
        return Err(Flaw::new(Problem::Schema { found: layout.schema }, span));
    }
    let motion = layout.motion;
    let motor = motor(document, layout.motor)?;
    let effects = effects::effects(document, &layout.effect, motion, motor.input)?;
    let fit = layout.fit.unwrap_or_default();
    let drive = Drive {
        name: layout.name,
        motion,
        motor,
        effects,
        controller: layout.controller,
        amplifier: layout.amplifier,
        generator: layout.generator,
        sensors: sensors(document, layout.sensors.unwrap_or_default(), motion)?,
        noise: match layout.noise {
            Some(NoiseTable::Read(noise)) => self::noise(document, noise)?,
            _ => NoiseData::default(),
        },
        fixed: fit.fixed,
        per_recording: fit.per_recording,
        origin: flat(layout.origin),
    };
    numbers(document, &drive)?;
    delay(document, &drive)?;
    lists(document, &drive)?;
    Ok(drive)
}

fn motor(document: &Document<'_>, motor: MotorData) -> Result<MotorData, Flaw> {
    const ELECTRICAL: [&str; 3] = ["R", "L", "K_e"];
    let key = |key: &str| format!("motor.{key}");
    let is_given = |key: &&&str| has(document, "motor", key);
    if motor.input == Input::Force {
        if let Some(name) = ELECTRICAL.iter().chain(&["tie_K"]).find(is_given) {
            let problem = Problem::Meaningless { key: key(name), why: NO_CIRCUIT };
            return Err(Flaw::new(problem, document.place_of("motor", name).key));
        }
    } else if let Some(name) = ELECTRICAL.iter().find(|name| !is_given(name)) {
        let why = ", or set `input = \"force\"` if u commands the torque or force".to_owned();
        let span = document.place_of("motor", "").value;
        return Err(Flaw::new(Problem::Missing { key: key(name), why }, span));
    }
    Ok(motor)
}

/// Whether the file gives that key.
fn has(document: &Document<'_>, section: &str, key: &str) -> bool {
    document.section(section).is_some_and(|table| table.contains_key(key))
}

fn sensors(
    document: &Document<'_>,
    sensors: SensorData,
    motion: Motion,
) -> Result<SensorData, Flaw> {
    let unit = document.section("sensors").and_then(|table| table.get("tacho_unit"));
    let given = unit.and_then(|unit| unit.get_ref().as_str());
    let expected = match (given, motion) {
        (Some("m/s"), Motion::Rotary) => "\"rpm\" or \"rad/s\" (`motion = \"rotary\"`)",
        (Some("rad/s" | "rpm"), Motion::Linear) => "\"m/s\" (`motion = \"linear\"`)",
        _ => return Ok(sensors),
    };
    let span = document.place_of("sensors", "tacho_unit").value;
    let problem = Problem::Type {
        key: "sensors.tacho_unit".to_owned(),
        found: document.text[span.clone()].to_owned(),
        expected: expected.to_owned(),
    };
    Err(Flaw::new(problem, span))
}

/// A number of the noise has one key, or two for a linear drive, of which one may be used. To be
/// checked before the tables are read, which take the two for one.
pub(super) fn names(document: &Document<'_>) -> Result<(), Flaw> {
    let motion = document.root.get("motion").and_then(|motion| motion.get_ref().as_str());
    for field in fields().filter(|field| field.section == "noise") {
        let (key, other) = (field.key, field.key(Motion::Linear));
        let why = match motion {
            _ if key == other || !has(document, "noise", other) => continue,
            Some("linear") if !has(document, "noise", key) => continue,
            Some("linear") => "its other name is given as well",
            _ => "it belongs to a linear drive",
        };
        let problem = Problem::Meaningless { key: format!("noise.{other}"), why };
        return Err(Flaw::new(problem, document.place_of("noise", other).key));
    }
    Ok(())
}

fn noise(document: &Document<'_>, noise: NoiseData) -> Result<NoiseData, Flaw> {
    if noise.torque > 0.0 && noise.torque_time == 0.0 {
        let why = ", a correlation time above 0 (s) for the load torque's noise".to_owned();
        let problem = Problem::Missing { key: "noise.torque_time".to_owned(), why };
        return Err(Flaw::new(problem, document.place_of("noise", "torque").key));
    }
    Ok(noise)
}

/// `coulomb.T_c` without quotes is a table in TOML: both spellings give one name.
fn flat(origin: BTreeMap<String, Origin>) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for (name, origin) in origin {
        match origin {
            Origin::Text(text) => {
                all.insert(name, text);
            }
            Origin::Below(below) => {
                all.extend(below.into_iter().map(|(key, text)| (format!("{name}.{key}"), text)));
            }
        }
    }
    all
}

/// Every number is finite and within its range.
fn numbers(document: &Document<'_>, drive: &Drive) -> Result<(), Flaw> {
    for parameter in drive.parameters() {
        if !possible(parameter.value, parameter.range) {
            let (key, spans) = place(document, drive, &parameter.name);
            let problem = Problem::OutOfRange {
                key,
                found: parameter.value,
                description: parameter.description.to_owned(),
                allowed: allowed(parameter.range, &parameter.unit),
            };
            return Err(Flaw::new(problem, spans.value));
        }
    }
    Ok(())
}

/// A delay needs an input that is held.
fn delay(document: &Document<'_>, drive: &Drive) -> Result<(), Flaw> {
    let is_delay =
        |effect: &EffectData| Entry::find(&effect.kind).map(|e| e.kind) == Some(Kind::Delay);
    let continuous = drive.controller.is_some_and(|controller| controller.period.is_none());
    let Some(number) = drive.effects.iter().position(is_delay).filter(|_| continuous) else {
        return Ok(());
    };
    let id = drive.effects[number].id.clone();
    let problem = Problem::Impossible { id, why: Refusal::ContinuousControl };
    let (table, span) = document.effect(number).expect("the effect was read from it");
    Err(Flaw::new(problem, Document::spans(table, "kind").map_or(span, |spans| spans.value)))
}

/// Key as the file has it, and place, of a parameter.
fn place(document: &Document<'_>, drive: &Drive, name: &str) -> (String, Spans) {
    let (section, key) = name.split_once('.').unwrap_or(("motor", name));
    if let Some(number) = drive.effects.iter().position(|effect| effect.id == section) {
        let (table, span) = document.effect(number).expect("the effect was read from it");
        let coefficients = table.get("parameters").and_then(|value| value.get_ref().as_table());
        let values = || {
            let names = &drive.effects[number].parameters;
            let at = names.iter().position(|(name, _)| name == key)?;
            let span = table.get("values")?.get_ref().get(at)?.span();
            Some(Spans { key: span.clone(), value: span })
        };
        let spans = match drive.effects[number].law {
            None => Document::spans(table, key),
            Some(LawData::Typed { .. }) => coefficients.and_then(|all| Document::spans(all, key)),
            Some(LawData::Learned { .. }) => values(),
        };
        let spans = spans.unwrap_or(Spans { key: span.clone(), value: span });
        return (name.to_owned(), spans);
    }
    // A linear drive may write `omega` for `v`.
    let given = |key: &&str| has(document, section, key);
    let mut keys = fields().filter(|field| field.section == section);
    let rotary = keys.find(|field| field.key(drive.motion) == key).map_or(key, |field| field.key);
    let in_file = Some(key).filter(given).unwrap_or(rotary);
    (format!("{section}.{in_file}"), document.place_of(section, in_file))
}

/// The lists of names hold names of the drive.
fn lists(document: &Document<'_>, drive: &Drive) -> Result<(), Flaw> {
    let all = drive.parameters();
    let fitted: Vec<_> = all.iter().filter(|p| p.role == Role::Physics).collect();
    for (key, list) in [("fixed", &drive.fixed), ("per_recording", &drive.per_recording)] {
        for (number, name) in list.iter().enumerate() {
            let span = || document.item("fit", key, number);
            known(&format!("fit.{key}"), name, &fitted, span)?;
        }
    }
    let both = drive.per_recording.iter().position(|name| drive.fixed.contains(name));
    if let Some(number) = both {
        let problem = Problem::FixedAndFree { name: drive.per_recording[number].clone() };
        return Err(Flaw::new(problem, document.item("fit", "per_recording", number)));
    }
    let all: Vec<_> = all.iter().collect();
    for name in drive.origin.keys() {
        let span = || {
            let origin = document.section("origin");
            let quoted = origin.and_then(|table| Document::spans(table, name));
            let split = || {
                let (id, key) = name.split_once('.')?;
                Document::spans(origin?.get(id)?.get_ref().as_table()?, key)
            };
            quoted.or_else(split).map_or(0..0, |spans| spans.key)
        };
        known("origin", name, &all, span)?;
    }
    Ok(())
}

fn known(
    key: &str,
    name: &str,
    all: &[&NamedParameter],
    span: impl Fn() -> Range<usize>,
) -> Result<(), Flaw> {
    if all.iter().any(|parameter| parameter.name == name) {
        return Ok(());
    }
    let names: Vec<&str> = all.iter().map(|parameter| parameter.name.as_str()).collect();
    let problem = Problem::UnknownParameter {
        key: key.to_owned(),
        name: name.to_owned(),
        nearest: nearest(name, names.iter().copied()),
        known: names.join(", "),
    };
    Err(Flaw::new(problem, span()))
}
