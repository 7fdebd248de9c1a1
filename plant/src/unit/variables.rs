//! The variables of a simulation unit: one list from which names, units and access derive.

use crate::drive::{Drive, Motion, TachoUnit};
use crate::effects::registry::Entry;
use crate::fault::MECHANISMS;
use crate::parameters;
use crate::units::{for_motion, name_for_motion};

/// Who gives a variable its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Another system; held from one communication point or event to the next.
    Input,
    /// The drive, for other systems.
    Output,
    /// The drive, to be looked at.
    Local,
    /// The user; may be changed between steps.
    Parameter,
}

/// What a variable is in the unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    Input(InputSlot),
    Fault(usize),
    Output(OutputSlot),
    State(usize),
    Derivative(usize),
    /// Event indicator: 0 of forward, 1 of backward motion.
    Indicator(usize),
    /// Number in [`Drive::parameters`].
    Parameter(usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum InputSlot {
    U,
    Reference,
    Load,
    NoiseLoad,
    GeneratorControl,
    NoiseReference,
    NoiseTacho,
    NoiseCurrent,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OutputSlot {
    Current,
    Speed,
    Position,
    Control,
    Tacho,
    MeasuredCurrent,
    GeneratorCurrent,
    Voltage,
    Load,
}

/// A variable of the unit; its reference is its place in [`super::Unit::variables`].
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name, as in the drive file for parameters.
    pub name: String,
    /// Unit for the drive's motion.
    pub unit: String,
    /// One line for a person.
    pub description: String,
    /// Who gives the value.
    pub role: Role,
    /// Whether it changes between events.
    pub continuous: bool,
    /// Start value; none where the drive calculates it.
    pub start: Option<f64>,
    /// Least and greatest value that can be set.
    pub range: (f64, f64),
    /// Typical size.
    pub nominal: f64,
    /// Place of the state whose derivative this is.
    pub derivative_of: Option<usize>,
    pub(super) slot: Slot,
}

/// Any value.
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Nominal current, A, and nominal speeds and positions: rad/s and rad, m/s and m.
const SMALL_CURRENT: f64 = 0.1;
const SLOW_ROTARY: f64 = 1.0;
const SLOW_LINEAR: f64 = 0.01;
/// A fault of -100 % is total; more would turn a gain round.
const TOTAL_LOSS: f64 = -1.0;

/// Every variable of the drive, open loop or controlled; `signed` if the sign of its motion matters.
pub(super) fn list(drive: &Drive, controlled: bool, signed: bool) -> Vec<Variable> {
    let mut list = Vec::new();
    inputs(&mut list, drive, controlled);
    faults(&mut list, drive);
    outputs(&mut list, drive, controlled);
    states(&mut list, drive, controlled);
    if signed {
        indicators(&mut list, drive);
    }
    for (number, parameter) in drive.parameters().into_iter().enumerate() {
        // Noise comes from outside, and the rating scales a fault: neither is the model's.
        if !matches!(parameter.role, parameters::Role::Physics | parameters::Role::Control) {
            continue;
        }
        list.push(Variable {
            name: parameter.name,
            unit: parameter.unit,
            description: parameter.description.to_owned(),
            role: Role::Parameter,
            continuous: false,
            start: Some(parameter.value),
            range: parameter.range,
            nominal: parameter.nominal,
            derivative_of: None,
            slot: Slot::Parameter(number),
        });
    }
    list
}

fn input_unit(drive: &Drive) -> &'static str {
    match drive.motor.input {
        crate::drive::Input::Voltage => "V",
        crate::drive::Input::Force => "1",
    }
}

fn tacho_unit(drive: &Drive) -> String {
    match drive.sensors.tacho_unit {
        TachoUnit::Rpm => "rpm".to_owned(),
        TachoUnit::Si => for_motion(drive.motion, "rad/s"),
    }
}

fn inputs(list: &mut Vec<Variable>, drive: &Drive, controlled: bool) {
    let si = |unit: &str| for_motion(drive.motion, unit);
    let mut add = |name: &str, unit: String, description: &str, slot: InputSlot| {
        list.push(Variable {
            name: name.to_owned(),
            unit,
            description: description.to_owned(),
            role: Role::Input,
            continuous: false,
            start: Some(0.0),
            range: ANY,
            nominal: 1.0,
            derivative_of: None,
            slot: Slot::Input(slot),
        });
    };
    if controlled {
        add("reference", si("rad/s"), "speed reference", InputSlot::Reference);
    } else {
        let unit = input_unit(drive).to_owned();
        add("u", unit, "armature voltage, or the commanded force signal", InputSlot::U);
    }
    add("T_l", si("N m"), "load torque", InputSlot::Load);
    if drive.generator.is_some() {
        let description = "generator control signal";
        add("C_g", "V".to_owned(), description, InputSlot::GeneratorControl);
    }
    if controlled {
        let description = "noise added to the reference";
        add("noise_reference", si("rad/s"), description, InputSlot::NoiseReference);
    }
    add("noise_T", tacho_unit(drive), "noise added to T", InputSlot::NoiseTacho);
    add("noise_I_m", "A".to_owned(), "noise added to I_m", InputSlot::NoiseCurrent);
    add("noise_T_l", si("N m"), "disturbance added to the load torque", InputSlot::NoiseLoad);
}

fn faults(list: &mut Vec<Variable>, drive: &Drive) {
    for (number, mechanism) in MECHANISMS.iter().enumerate() {
        let relative = mechanism.unit == "1";
        list.push(Variable {
            name: format!("fault_{}", mechanism.id),
            unit: for_motion(drive.motion, mechanism.unit),
            description: format!("size of the fault: {}", mechanism.description),
            role: Role::Input,
            continuous: false,
            start: Some(0.0),
            range: if relative && mechanism.id != "load" {
                (TOTAL_LOSS, f64::INFINITY)
            } else {
                ANY
            },
            nominal: 1.0,
            derivative_of: None,
            slot: Slot::Fault(number),
        });
    }
}

fn outputs(list: &mut Vec<Variable>, drive: &Drive, controlled: bool) {
    let si = |unit: &str| for_motion(drive.motion, unit);
    let mut add = |name: &str, unit: String, description: &str, slot, role, continuous| {
        list.push(Variable {
            name: name.to_owned(),
            unit,
            description: description.to_owned(),
            role,
            continuous,
            start: None,
            range: ANY,
            nominal: 1.0,
            derivative_of: None,
            slot: Slot::Output(slot),
        });
    };
    let speed = name_for_motion(drive.motion, "omega");
    let position = name_for_motion(drive.motion, "theta");
    let current = match drive.motor.input {
        crate::drive::Input::Voltage => "A",
        crate::drive::Input::Force => input_unit(drive),
    };
    use OutputSlot::{
        Control, Current, GeneratorCurrent, Load, MeasuredCurrent, Position, Speed, Tacho, Voltage,
    };
    add("i", current.into(), "armature current, ideal sensor", Current, Role::Output, true);
    add(speed, si("rad/s"), "speed, ideal sensor", Speed, Role::Output, true);
    add(position, si("rad"), "position, ideal sensor", Position, Role::Output, true);
    if controlled {
        add("C_m", "V".into(), "control signal", Control, Role::Output, false);
    }
    let live = !controlled;
    add("T", tacho_unit(drive), "tachometer signal, as measured", Tacho, Role::Output, live);
    let description = "armature current, as measured";
    add("I_m", current.into(), description, MeasuredCurrent, Role::Output, live);
    if drive.generator.is_some() {
        add("I_g", "A".into(), "generator current", GeneratorCurrent, Role::Output, false);
    }
    let unit = input_unit(drive).to_owned();
    add(
        "armature.u",
        unit,
        "input of the motor, before its delay if it has one",
        Voltage,
        Role::Local,
        false,
    );
    add("shaft.T_l", si("N m"), "load torque that acts on the shaft", Load, Role::Local, false);
}

/// States and their derivatives, in the order of the model.
fn states(list: &mut Vec<Variable>, drive: &Drive, controlled: bool) {
    let speed = name_for_motion(drive.motion, "omega");
    let position = name_for_motion(drive.motion, "theta");
    // An importer takes its absolute tolerance from the nominal values: they are those of slow
    // motion, or sticking and breaking away would drown in it.
    let slow = match drive.motion {
        Motion::Rotary => SLOW_ROTARY,
        Motion::Linear => SLOW_LINEAR,
    };
    let mut names = vec![
        ("armature.i".to_owned(), "A", "armature current", SMALL_CURRENT),
        (format!("shaft.{speed}"), "rad/s", "speed of the motor shaft", slow),
        (format!("shaft.{position}"), "rad", "position of the motor shaft", slow),
    ];
    for effect in &drive.effects {
        let own = Entry::find(&effect.kind).map_or(&[][..], |entry| entry.states);
        for state in own {
            let name = format!("{}.{}", effect.id, state.name);
            names.push((name, state.unit, state.description, state.nominal));
        }
    }
    if drive.controller.is_some_and(|controller| controlled && controller.period.is_none()) {
        names.push(("controller.integral".to_owned(), "V", "integrator of the controller", 1.0));
    }
    for (number, (name, unit, description, nominal)) in names.iter().enumerate() {
        list.push(Variable {
            name: name.clone(),
            unit: for_motion(drive.motion, unit),
            description: (*description).to_owned(),
            role: Role::Local,
            continuous: true,
            start: Some(0.0),
            range: ANY,
            nominal: *nominal,
            derivative_of: None,
            slot: Slot::State(number),
        });
    }
    let first = list.len() - names.len();
    for (number, (name, unit, description, nominal)) in names.iter().enumerate() {
        list.push(Variable {
            name: format!("der({name})"),
            unit: derivative_unit(drive.motion, unit),
            description: format!("time derivative: {description}"),
            role: Role::Local,
            continuous: true,
            start: None,
            range: ANY,
            nominal: *nominal,
            derivative_of: Some(first + number),
            slot: Slot::Derivative(number),
        });
    }
}

/// Event indicators of stick-slip.
fn indicators(list: &mut Vec<Variable>, drive: &Drive) {
    for (number, direction) in ["forward", "backward"].into_iter().enumerate() {
        list.push(Variable {
            name: format!("stick_slip.{direction}"),
            unit: "1".to_owned(),
            description: format!(
                "event indicator: speed in {} while slipping, margin to break away {direction} \
                 in {} while sticking",
                for_motion(drive.motion, "rad/s"),
                for_motion(drive.motion, "N m"),
            ),
            role: Role::Local,
            continuous: true,
            start: None,
            range: ANY,
            nominal: 1.0,
            derivative_of: None,
            slot: Slot::Indicator(number),
        });
    }
}

/// The unit of a time derivative: `rad` gives `rad/s`, `rad/s` gives `rad/s^2`.
fn derivative_unit(motion: Motion, unit: &str) -> String {
    let unit = for_motion(motion, unit);
    match unit.strip_suffix("/s") {
        Some(base) => format!("{base}/s^2"),
        None => format!("{unit}/s"),
    }
}
