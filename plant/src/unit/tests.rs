//! The unit as its users see it.

use super::*;
use crate::drive::TachoUnit;

fn dr300() -> Drive {
    let text = include_str!("../../../scenarios/drives/dr300.toml");
    Drive::parse(text, "dr300.toml").expect("the shipped drive is right")
}

fn set(unit: &mut Unit, name: &str, value: f64) {
    let reference = unit.reference(name).expect("the variable exists");
    unit.set(reference, value).expect("it can be set");
}

fn get(unit: &Unit, name: &str) -> f64 {
    unit.reference(name).and_then(|reference| unit.get(reference)).expect("it exists")
}

fn at_set_point(unit: &mut Unit) {
    set(unit, "reference", 2000.0 / TachoUnit::Rpm.per_si());
    unit.initialize(0.0);
    for _ in 0..1000 {
        unit.step(0.005).expect("it steps");
    }
}

#[test]
fn the_loop_holds_its_set_point() {
    let mut unit = Unit::new(dr300(), false);
    at_set_point(&mut unit);
    assert!((get(&unit, "T") - 2000.0).abs() < 3.0, "{}", get(&unit, "T"));
    // Friction and drag: 0.016 + 6e-5 x 209 N m over 0.06 N m/A.
    assert!((get(&unit, "i") - 0.476).abs() < 0.01, "{}", get(&unit, "i"));
}

#[test]
fn finer_communication_steps_give_the_same_samples() {
    let mut whole = Unit::new(dr300(), false);
    let mut parts = whole.clone();
    for unit in [&mut whole, &mut parts] {
        set(unit, "reference", 150.0);
        unit.initialize(0.0);
    }
    for _ in 0..400 {
        whole.step(0.005).expect("it steps");
    }
    for _ in 0..1000 {
        parts.step(0.002).expect("it steps");
    }
    let difference = get(&whole, "omega") - get(&parts, "omega");
    assert!(difference.abs() < 1e-6, "{difference}");
}

#[test]
fn memory_replays_bit_for_bit_in_another_unit() {
    let mut unit = Unit::new(dr300(), false);
    at_set_point(&mut unit);
    set(&mut unit, "fault_flux", 0.1);
    set(&mut unit, "R", 3.3);
    unit.step(0.005).expect("it steps");
    let memory = unit.memory();
    let mut other = Unit::new(dr300(), false);
    other.restore(&memory).expect("it is the memory of this drive");
    for _ in 0..100 {
        unit.step(0.005).expect("it steps");
        other.step(0.005).expect("it steps");
    }
    assert_eq!(unit.memory(), other.memory());
    assert!(other.restore(&memory[1..]).is_err());
}

#[test]
fn a_continuous_controller_holds_its_set_point_too() {
    let mut drive = dr300();
    if let Some(controller) = &mut drive.controller {
        controller.period = None;
    }
    let mut unit = Unit::new(drive, false);
    at_set_point(&mut unit);
    assert!((get(&unit, "T") - 2000.0).abs() < 3.0, "{}", get(&unit, "T"));
}

#[test]
fn wrong_references_and_values_are_refused() {
    let mut unit = Unit::new(dr300(), true);
    let omega = unit.reference("omega").expect("it exists");
    assert!(matches!(unit.set(omega, 1.0), Err(UnitError::Calculated { .. })));
    assert!(matches!(unit.set(9999, 1.0), Err(UnitError::Reference { .. })));
    let r = unit.reference("R").expect("it exists");
    assert!(matches!(unit.set(r, -1.0), Err(UnitError::Value { .. })));
    assert!(matches!(unit.set(r, f64::NAN), Err(UnitError::Value { .. })));
}
