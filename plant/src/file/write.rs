//! From a [`Drive`] back to its file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::curve::{BALANCES, overs};
use super::effects::target_key;
use super::layout::{
    ControllerTable, EffectTable, EffectValue, FitTable, GainTable, GeneratorTable, Layout,
    MotorTable, NoiseTable, Origin, SensorTable, TachoName,
};
use crate::drive::{Drive, EffectData, LawData, Motion, NoiseData, SensorData, TachoUnit};

/// The tables of a drive.
pub(super) fn layout(drive: &Drive) -> Layout {
    let motor = &drive.motor;
    Layout {
        schema: 1,
        name: drive.name.clone(),
        motion: drive.motion,
        motor: MotorTable {
            input: motor.input,
            r: motor.r,
            l: motor.l,
            k_e: motor.k_e,
            k_m: motor.k_m,
            j: motor.j,
            b_m: motor.b_m,
            tie_k: motor.tie_k.then_some(true),
            rated_torque: motor.rated_torque,
        },
        effect: effects(&drive.effects, drive.motion),
        controller: drive.controller.map(|c| ControllerTable {
            k_p: c.k_p,
            k_i: c.k_i,
            period: c.period,
            limit: c.limit,
        }),
        amplifier: drive.amplifier.map(|a| GainTable { gain: a.gain, limit: a.limit }),
        generator: drive.generator.map(|g| GeneratorTable {
            k_m: g.k_m,
            gain: g.gain,
            limit: g.limit,
        }),
        sensors: sensors(&drive.sensors),
        noise: noise(&drive.noise, drive.motion),
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
        Some(LawData::Learned { target, over, knots }) => {
            let balance = BALANCES.iter().find(|(_, other)| other == target);
            let of_motion = overs(motion).into_iter().rfind(|(_, other)| other == over);
            let list = |key: &str, all: Vec<f64>| (key.to_owned(), EffectValue::List(all));
            table.push(text("balance", balance.expect("a curve acts in a balance").0));
            table.push(text("over", of_motion.expect("every variable has a name").0));
            table.push(list("knots", knots.clone()));
            table.push(list("values", effect.parameters.iter().map(|(_, v)| *v).collect()));
        }
    }
    EffectTable(table)
}

/// Zero means that there is none: then the key is left out.
fn unless_zero(value: f64) -> Option<f64> {
    (value != 0.0).then_some(value)
}

fn sensors(sensors: &SensorData) -> Option<SensorTable> {
    let table = SensorTable {
        tacho_quantum: unless_zero(sensors.tacho_quantum),
        current_quantum: unless_zero(sensors.current_quantum),
        tacho_unit: (sensors.tacho_unit == TachoUnit::Rpm).then_some(TachoName::Rpm),
    };
    let empty = table.tacho_quantum.or(table.current_quantum).is_none();
    (!empty || table.tacho_unit.is_some()).then_some(table)
}

fn noise(noise: &NoiseData, motion: Motion) -> Option<NoiseTable> {
    let rotary = |value| unless_zero(value).filter(|_| motion == Motion::Rotary);
    let linear = |value| unless_zero(value).filter(|_| motion == Motion::Linear);
    (*noise != NoiseData::default()).then(|| NoiseTable {
        omega: rotary(noise.omega),
        v: linear(noise.omega),
        i: unless_zero(noise.i),
        theta: rotary(noise.theta),
        x: linear(noise.theta),
        reference: unless_zero(noise.reference),
        torque: unless_zero(noise.torque),
        torque_time: unless_zero(noise.torque_time),
    })
}

/// Writes the text beside the target and renames it: nobody ever sees half a file.
pub(super) fn replace(path: &Path, text: &str) -> io::Result<()> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?;
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}.part", std::process::id()));
    let part: PathBuf = path.with_file_name(hidden);
    let written = fs::write(&part, text).and_then(|()| fs::rename(&part, path));
    if written.is_err() {
        // The first error is the one to report; the part may not even exist.
        drop(fs::remove_file(&part));
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::DriveFileError;

    const DR300: &str = include_str!("../../../scenarios/drives/dr300.toml");

    fn files(folder: &Path) -> Vec<String> {
        let name = |entry: io::Result<fs::DirEntry>| {
            entry.expect("an entry").file_name().into_string().expect("UTF-8")
        };
        fs::read_dir(folder).expect("a folder").map(name).collect()
    }

    #[test]
    fn a_file_is_replaced_as_a_whole_and_nothing_is_left_beside_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("drive.toml");
        let drive = Drive::parse(DR300, "dr300.toml").expect("a right drive file");
        fs::write(&path, "old").expect("written");
        drive.write(&path).expect("written");
        assert_eq!(Drive::read(&path).expect("a right drive file"), drive);
        assert_eq!(files(folder.path()), ["drive.toml"]);
    }

    #[test]
    fn a_path_that_takes_no_file_is_named_and_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let drive = Drive::parse(DR300, "dr300.toml").expect("a right drive file");
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).expect("a folder");
        for path in [taken, folder.path().join("absent/drive.toml"), PathBuf::from("/")] {
            let error = drive.write(&path).expect_err("no file can be there");
            let shown = error.to_string();
            assert!(matches!(error, DriveFileError::Write { .. }));
            assert!(
                shown.starts_with(&format!("{}: cannot be written", path.display())),
                "{shown}"
            );
        }
        assert_eq!(files(folder.path()), ["taken"]);
        let error = Drive::read(folder.path().join("none.toml")).expect_err("there is none");
        assert!(matches!(error, DriveFileError::Read { .. }));
    }
}
