//! The unit as its users see it.

use super::*;
use crate::drive::TachoUnit;
use crate::testing::{DR300, drive};

fn dr300() -> Drive {
    drive(DR300)
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

fn delayed(tau: f64) -> Drive {
    let mut drive = dr300();
    let tau = ("tau".to_owned(), tau);
    let (kind, id) = ("delay".to_owned(), "delay".to_owned());
    drive.effects.push(crate::drive::EffectData { kind, id, parameters: vec![tau], law: None });
    drive
}

/// An open loop under a square wave of u that starts low: speed at the end.
fn under_a_square_wave(drive: Drive, shift: f64, step: f64) -> f64 {
    let mut unit = Unit::new(drive, true);
    unit.initialize(0.0);
    for k in 0..(0.2 / step).round() as usize {
        let time = k as f64 * step - shift;
        let on = time >= 0.0 && (time / 0.01 + 1e-6).floor() % 2.0 == 1.0;
        set(&mut unit, "u", if on { 12.0 } else { 0.0 });
        unit.step(step).expect("it steps");
    }
    get(&unit, "omega")
}

/// Accuracy of the steps over speeds of some hundred rad/s.
const STEPS: f64 = 1e-5;

#[test]
fn a_delay_shifts_the_input_by_a_fraction_of_a_step() {
    let shifted = under_a_square_wave(dr300(), 0.0035, 0.0005);
    let held_back = under_a_square_wave(delayed(0.0035), 0.0, 0.01);
    assert!((shifted - held_back).abs() < STEPS, "{shifted}, {held_back}");
    let at_once = under_a_square_wave(dr300(), 0.0, 0.01);
    assert!((shifted - at_once).abs() > 1.0, "the delay is seen");
}

#[test]
fn the_memory_holds_what_a_delay_has_yet_to_give() {
    let mut unit = Unit::new(delayed(0.0123), true);
    unit.initialize(0.0);
    for k in 0..10u8 {
        set(&mut unit, "u", f64::from(k));
        unit.step(0.005).expect("it steps");
    }
    let memory = unit.memory();
    let mut other = Unit::new(delayed(0.0123), true);
    other.restore(&memory).expect("it is the memory of this drive");
    assert!(other.restore(&memory[1..]).is_err());
    for unit in [&mut unit, &mut other] {
        let acting = unit.sampled.applied(unit.time).u[0];
        assert_eq!(acting, 7.0, "set at 0.035 s, acting from 0.0473 s on");
        assert_eq!(get(unit, "armature.u"), 9.0, "what a recording shows is not delayed");
        unit.step(0.005).expect("it steps");
    }
    assert_eq!(unit.memory(), other.memory());
}

/// Model Exchange: an importer is told when a delayed input acts.
#[test]
fn a_delayed_input_is_a_time_event() {
    let mut unit = Unit::new(delayed(0.003), true);
    unit.initialize(0.0);
    assert_eq!(unit.update_discrete().next_event, None);
    unit.set_time(0.01);
    set(&mut unit, "u", 12.0);
    let event = unit.update_discrete().next_event.expect("the change that is to come");
    assert!((event - 0.013).abs() < 1e-12, "{event}");
    unit.set_time(0.0129);
    assert_eq!(unit.derivatives()[0], 0.0);
    unit.set_time(event);
    assert_eq!(unit.update_discrete().next_event, None);
    assert_eq!(unit.derivatives()[0], 12.0 / 5e-3);
}

/// Every sampling time is a sampling time, however the drive came by it.
#[test]
fn a_period_that_is_set_is_the_sampling_time() {
    let mut slow = dr300();
    slow.set("controller.period", 0.02).expect("the drive has one");
    let mut made = Unit::new(slow, false);
    let mut changed = Unit::new(dr300(), false);
    set(&mut changed, "controller.period", 0.02);
    for unit in [&mut made, &mut changed] {
        set(unit, "reference", 150.0);
        unit.initialize(0.0);
        // While the drive accelerates: at its set point the sampling time cannot be seen.
        for _ in 0..12 {
            unit.step(0.005).expect("it steps");
        }
    }
    let apart = made.memory().into_iter().zip(changed.memory()).position(|(a, b)| a != b);
    assert_eq!(apart, None);
    let at_once = {
        let mut unit = Unit::new(dr300(), false);
        set(&mut unit, "reference", 150.0);
        unit.initialize(0.0);
        (0..12).for_each(|_| unit.step(0.005).expect("it steps"));
        get(&unit, "omega")
    };
    assert!((get(&made, "omega") - at_once).abs() > 1.0, "the period is seen");
}

#[test]
fn a_period_that_changes_during_a_run_counts_from_the_last_sample() {
    let mut unit = Unit::new(dr300(), false);
    unit.initialize(1.0);
    unit.update_discrete();
    unit.set_time(1.005);
    assert_eq!(unit.update_discrete().next_event, Some(1.0 + 2.0 * 0.005));
    set(&mut unit, "controller.period", 0.02);
    let next = unit.update_discrete().next_event.expect("a sample");
    assert!((next - 1.025).abs() < 1e-12, "{next}");
}

/// Model Exchange: an importer that steps over samples asks for none of them.
#[test]
fn a_time_far_past_a_due_sample_is_answered_at_once() {
    let mut unit = Unit::new(dr300(), false);
    unit.initialize(0.0);
    unit.update_discrete();
    unit.set_time(1e9 + 0.001);
    let next = unit.update_discrete().next_event.expect("a sample");
    assert!(next > 1e9 + 0.001 && next < 1e9 + 0.0051, "{next}");
}

#[test]
fn a_step_beyond_the_budget_is_an_error() {
    let mut unit = Unit::new(dr300(), false);
    unit.initialize(0.0);
    let refused = unit.step(1e9).expect_err("2e11 samples");
    assert!(refused.to_string().contains("2.000e11 samples of the controller"), "{refused}");
    unit.step(1.0).expect("it is as before");

    let mut drive = dr300();
    let stiff = [("k", 1e12), ("d", 1e-3), ("ratio", 0.5)];
    let stiff = stiff.map(|(name, value)| (name.to_owned(), value)).to_vec();
    drive.effects.push(crate::drive::EffectData {
        kind: "flexible_coupling".to_owned(),
        id: "flexible_coupling".to_owned(),
        parameters: stiff,
        law: None,
    });
    let mut unit = Unit::new(drive, true);
    set(&mut unit, "u", 10.0);
    unit.initialize(0.0);
    let refused = unit.step(0.1).expect_err("it is too stiff");
    assert!(refused.to_string().contains("sub-steps"), "{refused}");
    assert!(get(&unit, "omega").is_nan(), "no answer is made up");
}
