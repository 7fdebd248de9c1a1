//! How far a state in which a piece begins may be from its guess.

use drivescope_plant::drive::{Drive, EffectData, Input};
use drivescope_plant::effects::info::Beside;
use drivescope_plant::effects::registry::Entry;

use crate::measured::{Measured, Output};
use crate::start::{OWN_STATES, STARTS};

/// What a winding that has worked is warmer by, K, where no temperature was measured.
const USUAL_WARMTH: f64 = 50.0;

/// Standard deviation of the guess of a number of [`Start::values`](crate::Start::values): the
/// largest magnitude that was measured, or follows from u.
pub(super) fn swing(base: &Drive, measured: &Measured, number: usize) -> f64 {
    debug_assert!(number < STARTS);
    let shown = measured.outputs.iter().find(|channel| channel.output as usize == number);
    let own = OWN_STATES.iter().find(|(_, own)| *own == number);
    let found = match (shown, own) {
        (Some(channel), _) => largest(&channel.values),
        (None, Some((Beside::LoadPosition, _))) => twist(base, measured),
        (None, Some((Beside::Temperature, _))) => warmth(measured),
        (None, Some((Beside::LoadSpeed, _))) => speed(measured),
        (None, None) if number == Output::Current as usize => current(base, measured),
        (None, None) => speed(measured),
    };
    if found > 0.0 { found } else { 1.0 }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|value| value.is_finite()).fold(0.0_f64, |most, y| most.max(y.abs()))
}

/// A (of a force-driven drive the unit of u).
fn current(base: &Drive, measured: &Measured) -> f64 {
    let shown = measured.output(Output::Current).map(|channel| largest(&channel.values));
    shown.unwrap_or_else(|| largest(&measured.u) / base.motor.r.unwrap_or(1.0))
}

/// rad/s (m/s).
fn speed(measured: &Measured) -> f64 {
    if let Some(speed) = measured.output(Output::Speed) {
        return largest(&speed.values);
    }
    measured.output(Output::Position).map_or(0.0, |x| {
        let steps = x.values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.filter(|step| step.is_finite()).fold(0.0, f64::max) / measured.period_s
    })
}

/// rad (m): what the motor's largest torque does to the spring.
fn twist(base: &Drive, measured: &Measured) -> f64 {
    /// By which the registry tells the stiffness of a spring behind the shaft.
    const STIFFNESS: &str = "N m/rad";
    let stiffness_of = |effect: &EffectData| {
        let entry = Entry::find(&effect.kind)?;
        entry.states.iter().find(|it| it.beside == Some(Beside::LoadPosition))?;
        let stiffness = entry.parameters.iter().find(|it| it.unit == STIFFNESS)?;
        effect.parameters.iter().find_map(|(name, k)| (name == stiffness.name).then_some(*k))
    };
    let stiffness = base.effects.iter().find_map(stiffness_of);
    let torque = match base.motor.input {
        Input::Voltage => base.motor.k_m * current(base, measured),
        Input::Force => base.motor.k_m * largest(&measured.u),
    };
    stiffness.map_or(0.0, |k| torque.abs() / k)
}

/// K.
fn warmth(measured: &Measured) -> f64 {
    let Some(shown) = measured.output(Output::Temperature) else { return USUAL_WARMTH };
    let finite = || shown.values.iter().copied().filter(|value| value.is_finite());
    finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min)
}
