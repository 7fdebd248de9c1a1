//! Signals under the names that the drive's own variables have.

use drivescope_plant::drive::Drive;
use drivescope_plant::units::{for_motion, name_for_motion};
use drivescope_recording::{Recording, Signal, Unit};

use crate::driving::driving;

/// Name and unit of the drive's speed.
pub(crate) fn speed(drive: &Drive) -> (&'static str, String) {
    (name_for_motion(drive.motion, "omega"), for_motion(drive.motion, "rad/s"))
}

/// Name and unit of the drive's position.
pub(crate) fn position(drive: &Drive) -> (&'static str, String) {
    (name_for_motion(drive.motion, "theta"), for_motion(drive.motion, "rad"))
}

/// The recording with what drives the model as u, and with a speed and a current under their own
/// names: where there is none, the tachometer signal T and the measured current I_m stand in.
pub fn with_canonical_names(drive: &Drive, mut recording: Recording) -> Recording {
    let (speed, unit) = speed(drive);
    let per_unit = recording.signal("T").and_then(|t| Some((t, Unit::parse(&t.unit)?)));
    if recording.signal(speed).is_none()
        && let Some((t, of)) = per_unit.filter(|(_, of)| of.quantity.si() == unit)
    {
        let values = t.values.iter().map(|value| of.to_si(*value)).collect();
        recording.signals.push(Signal { name: speed.to_owned(), unit, values });
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
}
