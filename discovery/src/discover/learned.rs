//! What nobody knows, as a curve: shown, suggested as a formula, addable as effect `learned`.

use drivescope_plant::drive::{Drive, EffectData, Input, LawData};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::effects::learned::Over as Variable;
use drivescope_plant::units::for_motion;
use nalgebra::DMatrix;
use serde::Serialize;

use super::curves::{Balance, Curve, Factor, Over};
use super::projection::beside;
use crate::likelihood::CurveWeight;

/// Shares of the largest argument over which a rounded step is tried.
const WIDTHS: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7];
/// Places of a bump up to the largest argument, and its widths over its place.
const BUMPS: usize = 20;
const BUMP_WIDTHS: [f64; 2] = [0.2, 0.4];
/// Share of the curve's power that a formula must hold to be suggested.
const HOLDS: f64 = 0.9;

/// A curve over one variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearnedCurve {
    /// Where it stands.
    pub balance: Balance,
    /// The variable, under its name in the drive file.
    pub over: &'static str,
    /// What multiplies it: the sign of the motion, or the current.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times: Option<&'static str>,
    /// Its knots, SI.
    pub knots: Vec<f64>,
    /// Unit of the knots.
    pub over_unit: String,
    /// Its values there: N m (N), V, or a share of the flux, lost.
    pub values: Vec<f64>,
    /// Their unit; empty for a share.
    pub unit: String,
    /// A simple formula for it, as the text of a `custom` law, with its coefficients in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
    /// Share of the error above the noise floor that it removes.
    pub excess_removed: f64,
}

impl LearnedCurve {
    /// Of a curve that removes that share of the error above the noise floor.
    pub(crate) fn of(weight: &CurveWeight, excess_removed: f64, drive: &Drive) -> Self {
        let (curve, values) = (&weight.curve, beside_parameters(weight));
        let times = match curve.factor {
            Factor::One => None,
            Factor::Direction => Some("sign(omega)"),
            Factor::Current => Some("i"),
        };
        Self {
            balance: curve.balance,
            over: name(curve.over),
            times,
            knots: curve.knots.clone(),
            over_unit: unit(curve.over, drive),
            unit: balance_unit(curve.balance, drive),
            formula: formula(curve, &values),
            values,
            excess_removed,
        }
    }
}

fn name(over: Over) -> &'static str {
    match over {
        Over::Speed => "omega",
        Over::SpeedMagnitude => "abs(omega)",
        Over::Current => "i",
        Over::CurrentMagnitude => "abs(i)",
        Over::Position => "theta",
        Over::Time => "time",
        Over::Acceleration => "acceleration",
    }
}

fn unit(over: Over, drive: &Drive) -> String {
    let rotary = match over {
        Over::Speed | Over::SpeedMagnitude => "rad/s",
        // The commanded signal of a force-driven drive has the unit of its recording.
        Over::Current | Over::CurrentMagnitude if drive.motor.input == Input::Force => "",
        Over::Current | Over::CurrentMagnitude => "A",
        Over::Position => "rad",
        Over::Time => "s",
        Over::Acceleration => "rad/s^2",
    };
    for_motion(drive.motion, rotary)
}

fn balance_unit(balance: Balance, drive: &Drive) -> String {
    let rotary = match balance {
        Balance::Torque => "N m",
        Balance::Voltage => "V",
        Balance::Flux => "",
    };
    for_motion(drive.motion, rotary)
}

impl Curve {
    /// Where and over what the effect `learned` holds the curve, if it can.
    fn as_effect(&self) -> Option<(Target, Variable)> {
        let over = match (self.over, self.factor) {
            (Over::Speed, Factor::One) => Variable::Speed,
            (Over::Current, Factor::One) => Variable::Current,
            (Over::Position, Factor::One) => Variable::Position,
            (Over::Time, Factor::One) => Variable::Time,
            _ => return None,
        };
        match self.balance {
            Balance::Torque => Some((Target::Torque, over)),
            Balance::Voltage => Some((Target::Voltage, over)),
            Balance::Flux => None,
        }
    }

    /// Whether the effect `learned` can hold it.
    pub(crate) fn is_addable(&self) -> bool {
        self.as_effect().is_some()
    }
}

/// The curve as an effect of a drive, if the effect `learned` can hold it, with the names of the
/// values that these recordings do not tell.
pub(crate) fn effect(drive: &Drive, weight: &CurveWeight) -> Option<(EffectData, Vec<String>)> {
    let (target, over) = weight.curve.as_effect()?;
    let id = (1..)
        .map(|k| if k == 1 { "learned".to_owned() } else { format!("learned_{k}") })
        .find(|id| !drive.effects.iter().any(|effect| effect.id == *id))?;
    // A curve is what is lost; the effect adds.
    let values = beside_parameters(weight);
    let values = values.iter().enumerate();
    let parameters = values.map(|(k, value)| (LawData::value_name(k), -value)).collect();
    let untold = weight.told.iter().enumerate().filter(|(_, told)| !**told);
    let kept = untold.map(|(k, _)| format!("{id}.{}", LawData::value_name(k))).collect();
    let law = LawData::Learned { target, over, knots: weight.curve.knots.clone() };
    Some((EffectData { kind: "learned".to_owned(), id, parameters, law: Some(law) }, kept))
}

/// A form, and its text for a coefficient.
type Form = (Box<dyn Fn(f64) -> f64>, Box<dyn Fn(f64) -> String>);

/// The simplest formula that holds the curve: one coefficient, or two with a width.
fn formula(curve: &Curve, values: &[f64]) -> Option<String> {
    if curve.period.is_some() || curve.factor != Factor::One {
        return None;
    }
    let z = match curve.over {
        Over::Speed => "omega",
        Over::Current => "i",
        _ => return None,
    };
    let largest = curve.knots.iter().fold(0.0_f64, |most, knot| most.max(knot.abs()));
    // Forms and their texts; what the base has (constant friction, proportional) is taken out.
    let mut forms: Vec<Form> = vec![
        (Box::new(|x| x * x.abs()), Box::new(move |c| format!("{c:.4e} * {z} * abs({z})"))),
        (Box::new(|x| x * x * x), Box::new(move |c| format!("{c:.4e} * {z}^3"))),
        (Box::new(|x| x * x), Box::new(move |c| format!("{c:.4e} * {z}^2"))),
    ];
    for width in WIDTHS.map(|share| share * largest) {
        forms.push((
            Box::new(move |x| (x / width).tanh()),
            Box::new(move |c| format!("{c:.4e} * tanh({z} / {width:.4e})")),
        ));
    }
    for middle in (1..BUMPS).map(|k| k as f64 / BUMPS as f64 * largest) {
        for wide in BUMP_WIDTHS.map(|share| share * middle) {
            forms.push((
                Box::new(move |x| x.signum() * (-((x.abs() - middle) / wide).powi(2)).exp()),
                Box::new(move |c| {
                    format!(
                        "{c:.4e} * sign({z}) * exp(-((abs({z}) - {middle:.4e}) / {wide:.4e})^2)"
                    )
                }),
            ));
        }
    }
    let base = |values: &[f64]| -> Vec<f64> { beside_base(&curve.knots, values) };
    let left = base(values);
    let power: f64 = left.iter().map(|value| value * value).sum();
    let held = forms.iter().map(|(form, text)| {
        let form: Vec<f64> = base(&curve.knots.iter().map(|z| form(*z)).collect::<Vec<_>>());
        let (dot, own) = form
            .iter()
            .zip(&left)
            .fold((0.0, 0.0), |(dot, own), (form, value)| (dot + form * value, own + form * form));
        let share = if own > 0.0 && power > 0.0 { dot * dot / (own * power) } else { 0.0 };
        (share, dot / own, text)
    });
    let best = held.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 >= HOLDS).then(|| format!("-({})", best.2(best.1)))
}

/// Values of a curve less what parameters of the base do over its variable: a resistance, viscous and
/// dry friction. How much of that stands in the curve no recording tells. What was not visited goes on
/// as the nearest value that was.
fn beside_parameters(weight: &CurveWeight) -> Vec<f64> {
    let CurveWeight { curve, values, visited, .. } = weight;
    let dry = match (curve.balance, curve.over, curve.factor) {
        (Balance::Voltage, Over::Current, Factor::One) => 0.0,
        (Balance::Torque, Over::Speed, Factor::One) => 1.0,
        _ => return values.clone(),
    };
    let known: Vec<usize> = (0..values.len()).filter(|k| visited[*k]).collect();
    let of_base = |row: usize, k: usize| {
        let z = curve.knots[known[k]];
        if row == 0 { z } else { dry * sign(z) }
    };
    let rows = DMatrix::from_fn(2, known.len(), of_base);
    let left = beside(&rows, &known.iter().map(|k| values[*k]).collect::<Vec<_>>());
    let nearest = |k: usize| (0..known.len()).min_by_key(|place| known[*place].abs_diff(k));
    (0..values.len()).map(|k| nearest(k).map_or(0.0, |place| left[place])).collect()
}

/// Values less what constants, slopes and signs explain of them.
fn beside_base(knots: &[f64], values: &[f64]) -> Vec<f64> {
    let column = |row: usize, k: usize| [1.0, knots[k], sign(knots[k])][row];
    beside(&DMatrix::from_fn(3, knots.len(), column), values)
}

fn sign(z: f64) -> f64 {
    if z == 0.0 { 0.0 } else { z.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suggested(law: impl Fn(f64) -> f64) -> Option<String> {
        let knots: Vec<f64> = (-8..=8).map(|k| 10.0 * f64::from(k)).collect();
        let values: Vec<f64> = knots.iter().map(|z| law(*z)).collect();
        let (balance, over, factor) = (Balance::Torque, Over::Speed, Factor::One);
        formula(&Curve { balance, over, factor, knots, period: None }, &values)
    }

    #[test]
    fn a_simple_law_is_recognised_whatever_the_base_adds_to_it() {
        let drag = suggested(|z| 3e-6 * z * z.abs() + 0.01 * z + 0.2);
        assert_eq!(drag.as_deref(), Some("-(3.0000e-6 * omega * abs(omega))"));
        let even = suggested(|z| 2e-6 * z * z);
        assert_eq!(even.as_deref(), Some("-(2.0000e-6 * omega^2)"));
        let bump = suggested(|z| 0.01 * z.signum() * (-((z.abs() - 40.0) / 16.0).powi(2)).exp());
        assert!(bump.is_some_and(|it| it.contains("exp(-((abs(omega) - 4.0000e1)")));
        // Nothing simple: no suggestion.
        assert_eq!(suggested(|z| (0.7 * z).sin() + (0.31 * z).cos()), None);
    }
}
