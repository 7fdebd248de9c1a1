//! What was measured decides what is modelled.
//!
//! Voltage, current and motion: a voltage-driven drive, both balances. Torque (force) and motion:
//! the torque balance alone, K_m = 1. Current and motion: the torque balance in ratios to K_m.
//! Voltage and motion: a rotary drive by its voltage, in ratios to R; a linear axis by its
//! command, for it most often hangs on a current amplifier. A control signal alone stands for that
//! voltage or command.

use drivescope_plant::drive::{Input, Motion};
use drivescope_plant::units::for_motion;
use drivescope_recording::{Quantity, Recording, Signal, Unit};

use super::FirstDriveError;

/// What is known of the torque constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Constant {
    /// It is 1: the torque itself drives.
    Known,
    /// Only ratios to it can be measured.
    Ratio,
    /// The recording tells it.
    Estimated,
}

/// What is modelled, and why.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Choice {
    /// Rotary or linear.
    pub(crate) motion: Motion,
    /// Both balances, or the torque balance alone.
    pub(crate) input: Input,
    /// The choice in one sentence.
    pub(crate) sentence: String,
    /// What is known of K_m.
    pub(crate) constant: Constant,
    /// Unit of what drives.
    pub(crate) unit: String,
    /// Whether a reference was recorded: there is a controller that nobody described.
    pub(crate) controlled: bool,
    /// What was recorded and is not used.
    pub(crate) remarks: Vec<String>,
}

impl Choice {
    /// Of a recording; `input` overrules what its columns suggest.
    ///
    /// # Errors
    /// Nothing drives, or nothing tells the motion.
    pub(crate) fn of(recording: &Recording, input: Option<Input>) -> Result<Self, FirstDriveError> {
        let file = || recording.name.clone();
        let signals =
            || recording.signals.iter().map(Signal::header).collect::<Vec<_>>().join(", ");
        let find = |name: &str| {
            let known = |signal: &&Signal| signal.values.iter().any(|value| value.is_finite());
            recording.signal(name).filter(known)
        };
        let motion = motion(&find)
            .ok_or_else(|| FirstDriveError::NoMotion { file: file(), signals: signals() })?;
        let (u, torque) = (find("u"), find("torque"));
        let current = find("i").or_else(|| find("I_m"));
        let given = input.is_some();
        let by_voltage = input == Some(Input::Voltage);
        // What a controller asks for, where nothing shows what came of it.
        let alone = u.is_none() && (by_voltage || torque.is_none() && current.is_none());
        let command = find("C_m").filter(|_| alone);
        let (input, driver, sentence) = match (input, u) {
            (Some(Input::Voltage), Some(u)) => (Input::Voltage, u, "as given".to_owned()),
            (None | Some(Input::Voltage), None)
                if command.is_some() && (by_voltage || motion == Motion::Rotary) =>
            {
                let ratio = if current.is_some() { "" } else { "in ratios to R and " };
                let said = format!(
                    "driven by the control signal C_m, taken for the voltage as by an amplifier of \
                     gain 1: both balances are modelled, {ratio}in units of the command"
                );
                (Input::Voltage, command.expect("it is there"), said)
            }
            (Some(Input::Voltage), None) => {
                return Err(FirstDriveError::NoVoltage { file: file(), signals: signals() });
            }
            (None, Some(u)) if is(u, Quantity::Voltage) && current.is_some() => {
                let said = "voltage, current and motion were recorded: both balances are modelled";
                (Input::Voltage, u, said.to_owned())
            }
            (None, Some(u))
                if is(u, Quantity::Voltage) && torque.is_none() && motion == Motion::Rotary =>
            {
                let said = "driven by the voltage u; no current was recorded: both balances are \
                            modelled, in ratios to R";
                (Input::Voltage, u, said.to_owned())
            }
            _ => force(u.or(command), torque, current, given)
                .ok_or_else(|| FirstDriveError::NoInput { file: file(), signals: signals() })?,
        };
        let constant = match input {
            Input::Voltage => Constant::Estimated,
            Input::Force if driver.unit == for_motion(motion, "N m") => Constant::Known,
            Input::Force => Constant::Ratio,
        };
        let torque_unused = torque.filter(|it| it.name != driver.name && input == Input::Voltage);
        let remarks =
            torque_unused.map(|_| "torque: not used beside voltage and current".to_owned());
        Ok(Self {
            motion,
            input,
            sentence,
            constant,
            unit: driver.unit.clone(),
            controlled: recording.signal("reference").is_some(),
            remarks: remarks.into_iter().collect(),
        })
    }
}

impl Choice {
    /// Unit of K_m of a force-driven drive: torque or force a unit of what drives.
    pub(crate) fn unit_of_constant(&self) -> String {
        match (self.constant, self.unit.as_str()) {
            (Constant::Known, _) => "1".to_owned(),
            (_, "" | "1") => for_motion(self.motion, "N m"),
            (_, unit) => format!("{}/{unit}", for_motion(self.motion, "N m")),
        }
    }
}

fn is(signal: &Signal, quantity: Quantity) -> bool {
    Unit::parse(&signal.unit).is_some_and(|unit| unit.quantity == quantity)
}

/// What drives a drive of the torque balance alone, as [`drivescope_discovery::driving`] takes it,
/// but that a voltage beside a torque or current is no command unless it was `given` as one.
fn force<'a>(
    u: Option<&'a Signal>,
    torque: Option<&'a Signal>,
    current: Option<&'a Signal>,
    given: bool,
) -> Option<(Input, &'a Signal, String)> {
    let measured = |u: &Signal| {
        (is(u, Quantity::Torque) || is(u, Quantity::Force))
            .then_some(torque)
            .flatten()
            .or_else(|| is(u, Quantity::Current).then_some(current).flatten())
    };
    let command = u.filter(|u| measured(u).is_none());
    let command = command.filter(|u| given || torque.is_none() || !is(u, Quantity::Voltage));
    let alone = "only the torque balance is modelled";
    let (driver, sentence) = match (command, torque, current) {
        (Some(u), ..) if given => (u, "as given".to_owned()),
        (Some(u), ..) if is(u, Quantity::Torque) || is(u, Quantity::Force) => {
            (u, format!("driven by the torque u [{}]: {alone}", u.unit))
        }
        (Some(u), ..) if is(u, Quantity::Current) => {
            (u, format!("driven by the current u; the voltage was not recorded: {alone}"))
        }
        (Some(u), ..) => {
            let said = format!(
                "driven by the command {}, as of a current amplifier, for no current was recorded",
                u.name
            );
            (u, format!("{said}: {alone}"))
        }
        (None, Some(torque), _) => {
            (torque, format!("driven by the recorded torque [{}]: {alone}", torque.unit))
        }
        (None, None, Some(i)) => {
            let said = "driven by the measured current; the voltage was not recorded";
            (i, format!("{said}: {alone}"))
        }
        (None, None, None) => return None,
    };
    Some((Input::Force, driver, sentence))
}

/// The motion by what was measured: speed, tachometer, or position; those of the load where the
/// motor's was not.
fn motion<'a>(find: &dyn Fn(&str) -> Option<&'a Signal>) -> Option<Motion> {
    let named = |names: [&str; 2]| names.iter().any(|name| find(name).is_some());
    let tacho = || match Unit::parse(&find("T")?.unit)?.quantity.si() {
        "rad/s" => Some(Motion::Rotary),
        "m/s" => Some(Motion::Linear),
        _ => None,
    };
    if named(["omega", "omega"]) {
        return Some(Motion::Rotary);
    }
    if named(["v", "v"]) {
        return Some(Motion::Linear);
    }
    tacho()
        .or_else(|| find("theta").map(|_| Motion::Rotary))
        .or_else(|| find("x").map(|_| Motion::Linear))
        .or_else(|| named(["omega_load", "theta_load"]).then_some(Motion::Rotary))
        .or_else(|| named(["v_load", "x_load"]).then_some(Motion::Linear))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(columns: &[(&str, &str)]) -> Recording {
        let signals = columns.iter().map(|(name, unit)| Signal {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            values: (0..50).map(|k| f64::from(k) * 0.5).collect(),
        });
        Recording::new("r", 0.0, 0.001, signals.collect())
    }

    #[test]
    fn columns_tell_the_kind_of_drive() {
        use Constant::{Estimated, Known, Ratio};
        let (rotary, linear) = (Motion::Rotary, Motion::Linear);
        let (voltage, force) = (Input::Voltage, Input::Force);
        for (columns, motion, input, constant) in [
            (&[("u", "V"), ("i", "A"), ("omega", "rad/s")][..], rotary, voltage, Estimated),
            (&[("u", "V"), ("T", "rpm")], rotary, voltage, Estimated),
            (&[("u", "V"), ("i", "A"), ("theta_load", "rad")], rotary, voltage, Estimated),
            (&[("torque", "N"), ("v_load", "m/s")], linear, force, Known),
            (&[("C_m", "1"), ("T", "rpm")], rotary, voltage, Estimated),
            (&[("C_m", "V"), ("I_m", "A"), ("T", "rpm")], rotary, force, Ratio),
            (&[("C_m", "1"), ("x", "m")], linear, force, Ratio),
            (&[("u", "V"), ("x", "m")], linear, force, Ratio),
            (&[("u", "A"), ("theta", "rad")], rotary, force, Ratio),
            (&[("u", "N m"), ("theta", "rad")], rotary, force, Known),
            (&[("u", "1"), ("i", "A"), ("theta", "rad")], rotary, force, Ratio),
            (&[("i", "A"), ("theta", "rad")], rotary, force, Ratio),
            (&[("I_m", "A"), ("T", "rpm")], rotary, force, Ratio),
            (&[("torque", "N m"), ("i", "A"), ("omega", "rad/s")], rotary, force, Known),
            (&[("torque", "N"), ("x", "m")], linear, force, Known),
            (&[("torque", "N m"), ("x", "m")], linear, force, Ratio),
            (&[("u", "V"), ("torque", "N m"), ("omega", "rad/s")], rotary, force, Known),
        ] {
            let found = Choice::of(&recording(columns), None).expect("it is enough");
            let is = (found.motion, found.input, found.constant);
            assert_eq!(is, (motion, input, constant), "{columns:?}");
            assert!(found.sentence.len() > 20, "{columns:?}");
        }
        assert!(Choice::of(&recording(&[("u", "V")]), None).is_err());
        assert!(Choice::of(&recording(&[("omega", "rad/s")]), None).is_err());
        let current = [("i", "A"), ("omega", "rad/s")];
        assert!(Choice::of(&recording(&current), Some(Input::Voltage)).is_err());
    }

    #[test]
    fn what_has_no_place_is_said() {
        let columns = [("u", "V"), ("i", "A"), ("theta", "rad"), ("torque", "N m")];
        let found = Choice::of(&recording(&columns), None).expect("it is enough");
        assert_eq!(found.remarks.len(), 1, "{:?}", found.remarks);
        assert!(found.remarks[0].contains("torque"), "{:?}", found.remarks);
    }
}
