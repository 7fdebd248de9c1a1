//! The model structure: which unknown truly depends on which known.
//!
//! Dependencies are found, not declared: at scattered states and inputs each known is changed
//! and whatever then differs depends on it. So a custom law's dependencies are as true as those
//! of the library, and no second list of them can go wrong.

use drivescope_fmu::description::{Structure, TIME, Unknown};
use drivescope_plant::unit::{Role, Unit};

use crate::drive::reference;

/// Scattered operating points: (current, speed, position and own states, inputs).
const POINTS: [(f64, f64, f64, f64); 6] = [
    (0.31, 0.7, 0.4, 0.013),
    (-0.52, -1.3, -0.9, 0.021),
    (1.7, 248.0, 17.3, 0.17),
    (-2.9, -181.0, -23.1, -0.083),
    (0.011, 0.0, 0.2, 0.003),
    (0.9, 31.0, 5.1, 7.7),
];
/// Changes of a known: one small, one that crosses the threshold of a switch.
const CHANGES: [f64; 2] = [0.013, 0.97];

#[derive(Clone, Copy, PartialEq)]
enum Known {
    Time,
    Place(usize),
}

impl Known {
    fn reference(self) -> u32 {
        match self {
            Self::Time => TIME,
            Self::Place(place) => reference(place),
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
        inputs.iter().chain(&states).map(|k| Known::Place(*k)).chain([Known::Time]).collect();
    let initial: Vec<Known> =
        running.iter().copied().chain(parameters.iter().map(|k| Known::Place(*k))).collect();

    let indicators = unit.indicator_references();
    let unknowns: Vec<usize> =
        [&outputs, &derivatives, &indicators].into_iter().flatten().copied().collect();
    let depends = dependencies(unit, &unknowns, &inputs, &states, &initial);
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
            for change in CHANGES {
                let Some(changed) = changed(&base, *known, change) else { continue };
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

/// The unit with one known changed; nothing where the unit refuses the value.
fn changed(base: &Unit, known: Known, change: f64) -> Option<Unit> {
    let mut unit = base.clone();
    match known {
        // Another start, so that the same one sample is due.
        Known::Time => unit.initialize(change),
        Known::Place(place) => {
            let value = unit.get(place)?;
            let changed = if value == 0.0 { change } else { value * (1.0 + change) };
            unit.set(place, changed).ok()?;
        }
    }
    Some(unit)
}

/// The unknowns after the events that are due.
fn evaluate(mut unit: Unit, unknowns: &[usize]) -> Vec<f64> {
    unit.update_discrete();
    unknowns.iter().map(|place| unit.get(*place).unwrap_or(f64::NAN)).collect()
}
