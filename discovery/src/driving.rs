//! Which signal of a recording drives the model.
//!
//! A voltage-driven drive takes the voltage u. A force-driven one takes u where it was recorded,
//! else the torque (force), else the current: its K_m then is 1, or the torque constant. Where u
//! is a command and the same quantity was measured beside it, the measured one drives. What a
//! controller asks for, C_m, drives where nothing else does that the drive could take: through the
//! amplifier of the drive file, or one of gain 1.

use drivescope_plant::drive::{AmplifierData, Drive, Input};
use drivescope_recording::{Quantity, Recording, Signal, Unit};
use serde::Serialize;

use crate::error::Error;

/// Motor torque or force.
const TORQUE: &str = "torque";
/// Currents, the first that is there.
const CURRENTS: [&str; 2] = ["i", "I_m"];
/// What a controller asks for.
const COMMAND: &str = "C_m";
/// What tells the motion, of rotary and linear drives.
const MOTION: [&str; 9] =
    ["omega", "theta", "v", "x", "T", "omega_load", "theta_load", "v_load", "x_load"];

/// What drives the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Driving {
    /// The voltage u, or the command u of a force-driven drive.
    Input,
    /// The motor's torque or force.
    Torque,
    Current,
    /// The control signal, taken for u.
    Command,
    /// The control signal through the drive's own amplifier.
    Amplified,
}

impl Driving {
    /// What a person should know of it: nothing where u drives.
    pub fn remark(self) -> Option<&'static str> {
        match self {
            Self::Input => None,
            Self::Torque => {
                Some("driven by the recorded torque: only the torque balance is modelled")
            }
            Self::Current => {
                Some("driven by the measured current: only the torque balance is modelled")
            }
            Self::Command => Some(
                "driven by the control signal C_m, taken for u as by an amplifier of gain 1: the \
                 values of the model are in units of the command",
            ),
            Self::Amplified => {
                Some("driven by the control signal C_m through the amplifier of the drive file")
            }
        }
    }

    /// The name of the recorded signal.
    pub(crate) fn channel(self) -> &'static str {
        match self {
            Self::Input => "u",
            Self::Torque => TORQUE,
            Self::Current => CURRENTS[0],
            Self::Command | Self::Amplified => COMMAND,
        }
    }

    /// The signal that drives as u of that drive.
    pub(crate) fn as_u(self, drive: &Drive, signal: &Signal) -> Signal {
        let through = |it: &AmplifierData, c_m: f64| {
            let limit = it.limit.unwrap_or(f64::INFINITY);
            (it.gain * c_m).clamp(-limit, limit)
        };
        let values = match (self, &drive.amplifier) {
            (Self::Amplified, Some(it)) => signal.values.iter().map(|c| through(it, *c)).collect(),
            _ => signal.values.clone(),
        };
        let commanded = matches!(self, Self::Command | Self::Amplified);
        let unit = match drive.motor.input {
            Input::Voltage if commanded => "V".to_owned(),
            _ => signal.unit.clone(),
        };
        Signal { name: "u".to_owned(), unit, values }
    }
}

/// The signal of that name if it holds any value.
pub(crate) fn usable<'a>(recording: &'a Recording, name: &str) -> Option<&'a Signal> {
    let has_values = |signal: &&Signal| signal.values.iter().any(|value| value.is_finite());
    recording.signal(name).filter(has_values)
}

/// The signal that drives the model, and what it is.
///
/// # Errors
/// [`Error::MissingInput`], [`Error::NoVoltage`] or [`Error::WrongInput`].
pub fn driving<'a>(
    drive: &Drive,
    recording: &'a Recording,
) -> Result<(Driving, &'a Signal), Error> {
    let u = usable(recording, "u");
    let torque = usable(recording, TORQUE).map(|it| (Driving::Torque, it));
    let current = CURRENTS.iter().find_map(|name| usable(recording, name));
    let current = current.map(|it| (Driving::Current, it));
    let amplified = drive.amplifier.map_or(Driving::Command, |_| Driving::Amplified);
    let command = usable(recording, COMMAND).map(|it| (amplified, it));
    let columns = || recording.signals.iter().map(Signal::header).collect::<Vec<_>>().join(", ");
    let file = || recording.name.clone();
    if drive.motor.input == Input::Voltage {
        let moves = MOTION.iter().any(|name| usable(recording, name).is_some());
        return match u {
            Some(u) if is_voltage(u) => Ok((Driving::Input, u)),
            Some(u) => Err(Error::WrongInput { file: file(), unit: u.unit.clone() }),
            None => command.ok_or_else(|| match torque.or(current).filter(|_| moves) {
                Some((_, it)) => Error::NoVoltage { file: file(), instead: it.header() },
                None => Error::MissingInput { file: file(), wanted: "`u`", columns: columns() },
            }),
        };
    }
    let measured = |u: &Signal| match Unit::parse(&u.unit)?.quantity {
        Quantity::Torque | Quantity::Force => torque,
        Quantity::Current => current,
        _ => None,
    };
    let by_u = u.map(|u| measured(u).unwrap_or((Driving::Input, u)));
    by_u.or(torque).or(current).or(command).ok_or_else(|| Error::MissingInput {
        file: file(),
        wanted: "`u`, `torque`, `i`, `C_m`",
        columns: columns(),
    })
}

/// Whether a signal is a voltage, or may be one: a share of the supply, or of no known unit.
fn is_voltage(u: &Signal) -> bool {
    let may_be = [Quantity::Voltage, Quantity::Dimensionless];
    Unit::parse(&u.unit).is_none_or(|unit| may_be.contains(&unit.quantity))
}

#[cfg(test)]
mod tests {
    use super::*;

    const VOLTAGE: &str = include_str!("../../scenarios/drives/dr300.toml");
    const FORCE: &str = include_str!("../../scenarios/drives/emps.toml");

    fn recording(columns: &[(&str, &str)]) -> Recording {
        let signals = columns.iter().map(|(name, unit)| Signal {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            values: vec![1.0; 30],
        });
        Recording::new("r.csv", 0.0, 0.01, signals.collect())
    }

    fn driver(text: &str, columns: &[(&str, &str)]) -> Result<(Driving, String), Error> {
        let drive = Drive::parse(text, "drive.toml").expect("a right drive file");
        driving(&drive, &recording(columns)).map(|(kind, signal)| (kind, signal.header()))
    }

    #[test]
    fn what_was_measured_drives_a_force_driven_drive() {
        let x = ("x", "m");
        for (columns, kind, header) in [
            (&[("u", "V"), ("i", "A"), x][..], Driving::Input, "u [V]"),
            (&[("u", ""), ("torque", "N"), x], Driving::Input, "u [1]"),
            (&[("torque", "N"), ("i", "A"), x], Driving::Torque, "torque [N]"),
            (&[("i", "A"), x], Driving::Current, "i [A]"),
            (&[("I_m", "A"), x], Driving::Current, "I_m [A]"),
            (&[("u", "A"), ("i", "A"), x], Driving::Current, "i [A]"),
            (&[("u", "N"), ("torque", "N"), x], Driving::Torque, "torque [N]"),
            (&[("u", "N"), ("i", "A"), x], Driving::Input, "u [N]"),
        ] {
            assert_eq!(driver(FORCE, columns), Ok((kind, header.to_owned())), "{columns:?}");
        }
        let text = driver(FORCE, &[x]).expect_err("nothing drives").to_string();
        assert!(text.contains("`torque`") && text.contains("x [m]"), "{text}");
    }

    #[test]
    fn a_voltage_driven_drive_needs_its_voltage() {
        let omega = ("omega", "rad/s");
        assert!(driver(VOLTAGE, &[("u", "V"), ("i", "A"), omega]).is_ok());
        let text = driver(VOLTAGE, &[("i", "A"), omega]).expect_err("no voltage").to_string();
        assert!(text.contains("init") && text.contains("i [A]"), "{text}");
        let text = driver(VOLTAGE, &[omega]).expect_err("nothing").to_string();
        assert!(text.contains("`u`"), "{text}");
        let text = driver(VOLTAGE, &[("u", "A"), omega]).expect_err("a current").to_string();
        assert!(text.contains("force"), "{text}");
    }

    #[test]
    fn a_control_signal_drives_where_nothing_else_does() {
        let (omega, c_m) = (("omega", "rad/s"), ("C_m", "1"));
        // The shipped drive has an amplifier.
        let mut drive = Drive::parse(VOLTAGE, "drive.toml").expect("a right drive file");
        drive.amplifier = Some(AmplifierData { gain: 3.0, limit: Some(2.0) });
        let of = |drive: &Drive, columns: &[(&str, &str)]| {
            let recording = recording(columns);
            let (kind, signal) = driving(drive, &recording).expect("it drives");
            (kind, signal.name.clone(), kind.as_u(drive, signal))
        };
        let (kind, name, u) = of(&drive, &[c_m, ("i", "A"), omega]);
        assert_eq!((kind, name.as_str()), (Driving::Amplified, "C_m"));
        assert_eq!((u.name.as_str(), u.unit.as_str(), u.values[0]), ("u", "V", 2.0));
        assert_eq!(of(&drive, &[c_m, ("u", "V"), omega]).0, Driving::Input);
        drive.amplifier = None;
        let (kind, _, u) = of(&drive, &[c_m, omega]);
        assert_eq!((kind, u.values[0]), (Driving::Command, 1.0));
        assert!(kind.remark().is_some_and(|it| it.contains("gain 1")));
        let x = ("x", "m");
        assert_eq!(driver(FORCE, &[c_m, x]), Ok((Driving::Command, "C_m [1]".to_owned())));
        let measured = driver(FORCE, &[c_m, ("i", "A"), x]);
        assert_eq!(measured, Ok((Driving::Current, "i [A]".to_owned())));
    }
}
