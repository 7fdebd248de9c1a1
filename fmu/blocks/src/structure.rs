//! The model structure: which unknown truly depends on which known.
//!
//! Dependencies are found, not declared: at scattered states and inputs each known is changed
//! and whatever then differs depends on it. So a custom law's dependencies are as true as those
//! of the library, and no second list of them can go wrong. The sensors are taken without their
//! quanta: within a quantum nothing would seem to depend on anything.

use drivescope_fmu::description::{Structure, TIME, Unknown};
use drivescope_plant::unit::{Role, Unit};

use crate::reference::reference;

/// Scattered operating points: (current, speed, position and own states, inputs).
const POINTS: [(f64, f64, f64, f64); 6] = [
    (0.31, 0.7, 0.4, 0.013),
    (-0.52, -1.3, -0.9, 0.021),
    (1.7, 248.0, 17.3, 0.17),
    (-2.9, -181.0, -23.1, -0.083),
    (0.011, 0.0, 0.2, 0.003),
    (0.9, 31.0, 5.1, 7.7),
];
/// Changes of a known as shares of its value: one small, one that doubles it nearly.
const SHARES: [f64; 2] = [0.013, 0.97];
/// Change of a known in its own unit: it carries a switch that stands near zero past its threshold.
const STEP: f64 = 1.0;

#[derive(Clone, Copy, PartialEq)]
enum Known {
    Time,
    Variable(usize),
}

impl Known {
    fn reference(self) -> u32 {
        match self {
            Self::Time => TIME,
            Self::Variable(place) => reference(place),
        }
    }
}

/// The structure of the unit's drive.
pub(crate) fn structure(unit: &Unit) -> Structure {
    let variables = unit.variables();
    let places = |of: &dyn Fn(&drivescope_plant::unit::Variable) -> bool| -> Vec<usize> {
        variables.iter().enumerate().filter(|(_, v)| of(v)).map(|(k, _)| k).collect()
    };
    let outputs = places(&|v| v.role == Role::Output);
    let derivatives = places(&|v| v.derivative_of.is_some());
    let inputs = places(&|v| v.role == Role::Input);
    let states = places(&|v| v.continuous && v.role == Role::Local && v.start.is_some());
    let parameters = places(&|v| v.role == Role::Parameter);
    let running: Vec<Known> =
        inputs.iter().chain(&states).map(|k| Known::Variable(*k)).chain([Known::Time]).collect();
    let initial: Vec<Known> =
        running.iter().copied().chain(parameters.iter().map(|k| Known::Variable(*k))).collect();

    let fine = without_quanta(unit);
    let indicators = unit.indicator_references();
    let unknowns: Vec<usize> =
        [&outputs, &derivatives, &indicators].into_iter().flatten().copied().collect();
    let depends = dependencies(&fine, &unknowns, &inputs, &states, &initial);
    let rows = |of: &[usize], knowns: &[Known]| -> Vec<Unknown> {
        let row = |place: &usize| {
            let on = unknowns.iter().position(|k| k == place).map_or(&[][..], |k| &depends[k]);
            let on = initial.iter().zip(on).filter(|(known, yes)| **yes && knowns.contains(known));
            Unknown {
                reference: reference(*place),
                dependencies: on.map(|(known, _)| known.reference()).collect(),
            }
        };
        of.iter().map(row).collect()
    };
    let computed: Vec<usize> = outputs.iter().chain(&derivatives).copied().collect();
    Structure {
        outputs: rows(&outputs, &running),
        derivatives: rows(&derivatives, &running),
        event_indicators: rows(&indicators, &running),
        initial_unknowns: rows(&computed, &initial),
    }
}

/// The same drive with sensors of any resolution; its variables are the same.
fn without_quanta(unit: &Unit) -> Unit {
    let mut drive = unit.drive().clone();
    drive.sensors.tacho_quantum = 0.0;
    drive.sensors.current_quantum = 0.0;
    Unit::new(drive, !unit.controlled())
}

/// For each unknown and each known, whether the one depends on the other.
fn dependencies(
    unit: &Unit,
    unknowns: &[usize],
    inputs: &[usize],
    states: &[usize],
    knowns: &[Known],
) -> Vec<Vec<bool>> {
    let mut found = vec![vec![false; knowns.len()]; unknowns.len()];
    for point in POINTS {
        let base = at_point(unit, inputs, states, point);
        let values = evaluate(base.clone(), unknowns);
        for (k, known) in knowns.iter().enumerate() {
            for changed in changed(&base, *known) {
                for (row, value) in evaluate(changed, unknowns).into_iter().enumerate() {
                    found[row][k] |= value.to_bits() != values[row].to_bits();
                }
            }
        }
    }
    found
}

/// The unit at a scattered point, its first sample still to come.
fn at_point(
    unit: &Unit,
    inputs: &[usize],
    states: &[usize],
    (current, speed, other, input): (f64, f64, f64, f64),
) -> Unit {
    let mut unit = unit.clone();
    unit.initialize(0.0);
    for (k, place) in inputs.iter().enumerate() {
        // Each input its own value; what the unit refuses stays at its start value.
        let _ = unit.set(*place, input * (1.0 + 0.1 * k as f64));
    }
    for (k, place) in states.iter().enumerate() {
        let value = [current, speed].get(k).copied().unwrap_or(other / (1.0 + k as f64));
        let _ = unit.set(*place, value);
    }
    unit
}

/// The unit with one known changed, in several ways; a value that the unit refuses is passed over.
fn changed(base: &Unit, known: Known) -> Vec<Unit> {
    let Known::Variable(place) = known else {
        // Another start, so that the same one sample is due.
        return SHARES
            .map(|time| {
                let mut unit = base.clone();
                unit.initialize(time);
                unit
            })
            .to_vec();
    };
    let Some(value) = base.get(place) else { return Vec::new() };
    let share = |share: f64| if value == 0.0 { share } else { value * (1.0 + share) };
    let values = SHARES.into_iter().map(share).chain([value + STEP, value - STEP]);
    values
        .filter_map(|value| {
            let mut unit = base.clone();
            unit.set(place, value).ok().map(|()| unit)
        })
        .collect()
}

/// The unknowns after the events that are due.
fn evaluate(mut unit: Unit, unknowns: &[usize]) -> Vec<f64> {
    unit.update_discrete();
    unknowns.iter().map(|place| unit.get(*place).unwrap_or(f64::NAN)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_plant::drive::Drive;

    fn dr300(open_loop: bool) -> Unit {
        let text = include_str!("../../../scenarios/drives/dr300.toml");
        Unit::new(Drive::parse(text, "dr300.toml").expect("the shipped drive is right"), open_loop)
    }

    /// The names on which that output is said to depend.
    fn declared(unit: &Unit, rows: &[Unknown], output: &str) -> Vec<String> {
        let place = unit.reference(output).expect("it exists");
        let row = rows.iter().find(|row| row.reference == reference(place)).expect("it is listed");
        let name = |of: &u32| match *of {
            TIME => "time".to_owned(),
            place => unit.variables()[place as usize - 1].name.clone(),
        };
        row.dependencies.iter().map(name).collect()
    }

    /// A tachometer of 2 rpm hides a small change of nearly everything.
    #[test]
    fn what_lies_behind_a_quantum_or_a_switch_is_declared() {
        for open_loop in [false, true] {
            let unit = dr300(open_loop);
            assert!(unit.drive().sensors.tacho_quantum > 0.0);
            let structure = structure(&unit);
            let of = |output: &str| declared(&unit, &structure.outputs, output);
            let tacho = of("T");
            for name in
                ["shaft.omega", "noise_T", "fault_tacho_noise", "fault_tacho_freeze", "fault_tacho"]
            {
                assert!(tacho.iter().any(|on| on == name), "T on {name}: {tacho:?}");
            }
            assert!(!tacho.iter().any(|on| on == "noise_I_m"), "{tacho:?}");
            let current = of("I_m");
            for name in ["armature.i", "noise_I_m", "fault_current_noise", "fault_current_freeze"] {
                assert!(current.iter().any(|on| on == name), "I_m on {name}: {current:?}");
            }
            if !open_loop {
                let control = of("C_m");
                for name in ["reference", "noise_reference", "noise_T", "fault_tacho_freeze"] {
                    assert!(control.iter().any(|on| on == name), "C_m on {name}: {control:?}");
                }
            }
        }
    }

    /// Points that the search has never seen: nothing may depend on what is not declared.
    #[test]
    fn nothing_depends_on_what_is_not_declared() {
        let unit = dr300(false);
        let found = structure(&unit);
        let mut state = 12345_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let variables = unit.variables();
        let knowns: Vec<usize> = (0..variables.len())
            .filter(|k| {
                let v = &variables[*k];
                v.role == Role::Input
                    || (v.continuous && v.role == Role::Local && v.start.is_some())
            })
            .collect();
        let outputs: Vec<usize> =
            (0..variables.len()).filter(|k| variables[*k].role == Role::Output).collect();
        for _ in 0..200 {
            let mut base = unit.clone();
            base.initialize(0.0);
            for known in &knowns {
                let size = 10.0_f64.powf(2.0 * random());
                let _ = base.set(*known, size * random());
            }
            let before = evaluate(base.clone(), &outputs);
            for known in &knowns {
                let mut changed = base.clone();
                if changed.set(*known, 100.0 * random()).is_err() {
                    continue;
                }
                let after = evaluate(changed, &outputs);
                for (k, output) in outputs.iter().enumerate() {
                    if before[k].to_bits() == after[k].to_bits() {
                        continue;
                    }
                    let output = &variables[*output].name;
                    let declared = declared(&unit, &found.outputs, output);
                    let known = &variables[*known].name;
                    assert!(declared.contains(known), "{output} depends on {known}");
                }
            }
        }
    }
}
