//! Signals under the names that the drive's own variables have.

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::info::Beside;
use drivescope_plant::units::{for_motion, name_for_motion};
use drivescope_recording::{Recording, Signal, Unit};

use crate::driving::{driving, usable};
use crate::error::Error;

/// Name and unit of the drive's speed.
pub(crate) fn speed(drive: &Drive) -> (&'static str, String) {
    (name_for_motion(drive.motion, "omega"), for_motion(drive.motion, "rad/s"))
}

/// Name and unit of the drive's position.
pub(crate) fn position(drive: &Drive) -> (&'static str, String) {
    (name_for_motion(drive.motion, "theta"), for_motion(drive.motion, "rad"))
}

/// A sensor of the load that stands for that of the motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ByLoad {
    load: &'static str,
    motor: &'static str,
}

impl ByLoad {
    /// What was assumed.
    pub(crate) fn remark(self) -> String {
        let Self { load, motor } = self;
        format!(
            "{load} is taken for {motor}: the motor's own motion was not measured, and the shaft \
             between them is taken as rigid and without a gear"
        )
    }
}

/// The sensors of the load that stand for those of the motor, where the motor's motion was not
/// measured at all: the load of a rigid drive moves as its motor does.
///
/// # Errors
/// [`Error::LoadAlone`] if the drive has a coupling between them.
pub(crate) fn taken_for_motor(drive: &Drive, recording: &Recording) -> Result<Vec<ByLoad>, Error> {
    let name = |rotary: &'static str| name_for_motion(drive.motion, rotary);
    if ["omega", "theta", "T"].iter().any(|motor| usable(recording, name(motor)).is_some()) {
        return Ok(Vec::new());
    }
    let pairs = [("omega_load", "omega"), ("theta_load", "theta")];
    let pairs = pairs.map(|(load, motor)| ByLoad { load: name(load), motor: name(motor) });
    let shown = |it: &ByLoad| usable(recording, it.load).is_some();
    let taken: Vec<ByLoad> = pairs.into_iter().filter(shown).collect();
    match taken.first() {
        Some(ByLoad { load, motor }) if drive.model().has(Beside::LoadPosition) => {
            Err(Error::LoadAlone { file: recording.name.clone(), load, motor })
        }
        _ => Ok(taken),
    }
}

/// The recording with what drives the model as u, and with a speed and a current under their own
/// names: where there is none, the tachometer signal T and the measured current I_m stand in, and
/// where the motor's motion was not measured, that of the load of a rigid drive.
pub fn with_canonical_names(drive: &Drive, mut recording: Recording) -> Recording {
    let (speed, unit) = speed(drive);
    let per_unit = recording.signal("T").and_then(|t| Some((t, Unit::parse(&t.unit)?)));
    if recording.signal(speed).is_none()
        && let Some((t, of)) = per_unit.filter(|(_, of)| of.quantity.si() == unit)
    {
        let values = t.values.iter().map(|value| of.to_si(*value)).collect();
        recording.signals.push(Signal { name: speed.to_owned(), unit, values });
    }
    for ByLoad { load, motor } in taken_for_motor(drive, &recording).unwrap_or_default() {
        recording.signals.retain(|signal| signal.name != motor);
        let of_load = recording.signals.iter_mut().find(|signal| signal.name == load);
        of_load.into_iter().for_each(|signal| motor.clone_into(&mut signal.name));
    }
    if recording.signal("i").is_none()
        && let Some(i_m) = recording.signal("I_m")
    {
        let current = Signal { name: "i".to_owned(), ..i_m.clone() };
        recording.signals.push(current);
    }
    let driver = driving(drive, &recording).ok().filter(|(_, signal)| signal.name != "u");
    if let Some(driver) = driver.map(|(what, signal)| what.as_u(drive, signal)) {
        recording.signals.retain(|signal| signal.name != "u");
        recording.signals.insert(0, driver);
    }
    recording
}

#[cfg(test)]
mod tests {
    use super::*;

    const DR300: &str = include_str!("../../scenarios/drives/dr300.toml");

    #[test]
    fn what_drives_is_u() {
        let text = include_str!("../../scenarios/drives/emps.toml");
        let drive = Drive::parse(text, "emps.toml").expect("a right drive file");
        let signal = |name: &str, unit: &str, value| Signal {
            name: name.into(),
            unit: unit.into(),
            values: vec![value; 3],
        };
        let signals = vec![signal("x", "m", 1.0), signal("u", "A", 2.0), signal("I_m", "A", 3.0)];
        let bench = Recording::new("bench", 0.0, 0.002, signals);
        let named = with_canonical_names(&drive, bench);
        assert_eq!(named.signals[0], signal("u", "A", 3.0), "measured before commanded");
        assert_eq!(named.signals.iter().filter(|it| it.name == "u").count(), 1);
    }

    #[test]
    fn the_tachometer_stands_in_for_the_speed() {
        let drive = Drive::parse(DR300, "dr300.toml").expect("a right drive file");
        let signal = |name: &str, unit: &str, value| Signal {
            name: name.into(),
            unit: unit.into(),
            values: vec![value; 3],
        };
        let signals = vec![signal("T", "rpm", 3000.0), signal("I_m", "A", 0.5)];
        let bench = Recording::new("bench", 0.0, 0.002, signals);
        let named = with_canonical_names(&drive, bench);
        let speed = named.signal("omega").expect("it was added").values[0];
        assert!((speed - 100.0 * std::f64::consts::PI).abs() < 1e-10, "{speed}");
        assert_eq!(named.signal("i").map(|i| i.values[0]), Some(0.5));
    }

    #[test]
    fn the_load_alone_stands_for_the_motor_of_a_rigid_drive() {
        let recorded = crate::testing::bench(&crate::testing::dr300(), 1.0, 0.001);
        let mut by_load = recorded.clone();
        for (motor, load) in [("omega", "omega_load"), ("theta", "theta_load")] {
            let of = by_load.signals.iter_mut().find(|it| it.name == motor);
            load.clone_into(&mut of.expect("it is there").name);
        }
        let drive = crate::testing::dr300();
        let [ours, theirs] = [&recorded, &by_load]
            .map(|it| crate::Measured::new(&drive, it).expect("it can be used"));
        assert_eq!(theirs.outputs, ours.outputs);
        assert_eq!(theirs.angle, ours.angle);
        assert_eq!((ours.remarks.len(), theirs.remarks.len()), (0, 2));
        assert!(theirs.remarks[1].starts_with("theta_load is taken for theta"));
        let coupling = "[[effect]]\nkind = \"flexible_coupling\"\nk = 5.0\nd = 1e-3\nratio = 0.5\n";
        let drive = Drive::parse(&format!("{DR300}\n{coupling}"), "d.toml").expect("right");
        let said = crate::Measured::new(&drive, &by_load).expect_err("a coupling").to_string();
        assert!(said.contains("omega_load") && said.contains("--columns omega="), "{said}");
        crate::Measured::new(&drive, &recorded).expect("the motor was measured");
    }
}
