//! From the tables of the file to a [`Drive`]: the rules between keys.

use std::collections::BTreeMap;
use std::ops::Range;

use super::document::{Document, Spans};
use super::effects;
use super::error::{Flaw, Problem};
use super::layout::{Layout, MotorTable, NoiseTable, Origin, TachoName};
use crate::drive::{
    AmplifierData, ControllerData, Drive, EffectData, GeneratorData, Input, LawData, Motion,
    MotorData, NoiseData, SensorData, TachoUnit,
};
use crate::effects::refusal::Refusal;
use crate::effects::registry::{Entry, Kind};
use crate::parameters::{FIELDS, NamedParameter, Role, allowed, nearest, possible};
use crate::units::name_for_motion;

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
    let motor = motor(document, &layout.motor)?;
    let effects = effects::effects(document, &layout.effect, motion, motor.input)?;
    let fit = layout.fit.unwrap_or_default();
    let drive = Drive {
        name: layout.name,
        motion,
        motor,
        effects,
        controller: layout.controller.map(|c| ControllerData {
            k_p: c.k_p,
            k_i: c.k_i,
            period: c.period,
            limit: c.limit,
        }),
        amplifier: layout.amplifier.map(|a| AmplifierData { gain: a.gain, limit: a.limit }),
        generator: layout.generator.map(|g| GeneratorData {
            k_m: g.k_m,
            gain: g.gain,
            limit: g.limit,
        }),
        sensors: {
            let sensors = layout.sensors.unwrap_or_default();
            SensorData {
                tacho_quantum: sensors.tacho_quantum.unwrap_or(0.0),
                current_quantum: sensors.current_quantum.unwrap_or(0.0),
                tacho_unit: tacho_unit(document, sensors.tacho_unit, motion)?,
            }
        },
        noise: noise(document, layout.noise.unwrap_or_default(), motion)?,
        fixed: fit.fixed,
        per_recording: fit.per_recording,
        origin: flat(layout.origin),
    };
    numbers(document, &drive)?;
    delay(document, &drive)?;
    lists(document, &drive)?;
    Ok(drive)
}

fn motor(document: &Document<'_>, motor: &MotorTable) -> Result<MotorData, Flaw> {
    let electrical = [("R", motor.r), ("L", motor.l), ("K_e", motor.k_e)];
    let key = |key: &str| format!("motor.{key}");
    if motor.input == Input::Force {
        let given = electrical.iter().filter(|(_, value)| value.is_some()).map(|(key, _)| *key);
        if let Some(name) = given.chain(motor.tie_k.map(|_| "tie_K")).next() {
            let problem = Problem::Meaningless { key: key(name), why: NO_CIRCUIT };
            return Err(Flaw::new(problem, document.place_of("motor", name).key));
        }
    } else if let Some((name, _)) = electrical.iter().find(|(_, value)| value.is_none()) {
        let why = ", or set `input = \"force\"` if u commands the torque or force".to_owned();
        let span = document.place_of("motor", "").value;
        return Err(Flaw::new(Problem::Missing { key: key(name), why }, span));
    }
    Ok(MotorData {
        input: motor.input,
        r: motor.r,
        l: motor.l,
        k_e: motor.k_e,
        k_m: motor.k_m,
        j: motor.j,
        b_m: motor.b_m,
        tie_k: motor.tie_k.unwrap_or(false),
        rated_torque: motor.rated_torque,
    })
}

fn tacho_unit(
    document: &Document<'_>,
    given: Option<TachoName>,
    motion: Motion,
) -> Result<TachoUnit, Flaw> {
    match (given, motion) {
        (None, _)
        | (Some(TachoName::Rotary), Motion::Rotary)
        | (Some(TachoName::Linear), Motion::Linear) => Ok(TachoUnit::Si),
        (Some(TachoName::Rpm), Motion::Rotary) => Ok(TachoUnit::Rpm),
        (Some(TachoName::Rotary | TachoName::Linear | TachoName::Rpm), _) => {
            let span = document.place_of("sensors", "tacho_unit").value;
            let expected = match motion {
                Motion::Rotary => "\"rpm\" or \"rad/s\" (`motion = \"rotary\"`)",
                Motion::Linear => "\"m/s\" (`motion = \"linear\"`)",
            };
            let problem = Problem::Type {
                key: "sensors.tacho_unit".to_owned(),
                found: document.text[span.clone()].to_owned(),
                expected: expected.to_owned(),
            };
            Err(Flaw::new(problem, span))
        }
    }
}

fn noise(document: &Document<'_>, noise: NoiseTable, motion: Motion) -> Result<NoiseData, Flaw> {
    // A quantity has one key, or two for a linear drive, of which one may be used.
    let one = |key: &'static str, rotary: Option<f64>, linear: Option<f64>| {
        let other = name_for_motion(Motion::Linear, key);
        if linear.is_some() && (motion == Motion::Rotary || rotary.is_some()) {
            let why = match motion {
                Motion::Rotary => "it belongs to a linear drive",
                Motion::Linear => "its other name is given as well",
            };
            let problem = Problem::Meaningless { key: format!("noise.{other}"), why };
            return Err(Flaw::new(problem, document.place_of("noise", other).key));
        }
        Ok(rotary.or(linear).unwrap_or(0.0))
    };
    let torque = noise.torque.unwrap_or(0.0);
    let torque_time = noise.torque_time.unwrap_or(0.0);
    if torque > 0.0 && torque_time == 0.0 {
        let why = ", a correlation time above 0 (s) for the load torque's noise".to_owned();
        let problem = Problem::Missing { key: "noise.torque_time".to_owned(), why };
        return Err(Flaw::new(problem, document.place_of("noise", "torque").key));
    }
    Ok(NoiseData {
        omega: one("omega", noise.omega, noise.v)?,
        i: noise.i.unwrap_or(0.0),
        theta: one("theta", noise.theta, noise.x)?,
        reference: noise.reference.unwrap_or(0.0),
        torque,
        torque_time,
    })
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
    let given =
        |key: &&str| document.section(section).is_some_and(|table| table.contains_key(*key));
    let mut keys = FIELDS.iter().filter(|field| field.section == section);
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
