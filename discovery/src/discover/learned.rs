//! What nobody knows, as a curve: shown, and addable as effect `learned`.

use drivescope_plant::drive::{Drive, EffectData, Input, LawData};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::effects::learned::{Factor as Times, Over as Variable};
use drivescope_plant::file::LEARNED;
use drivescope_plant::units::for_motion;
use nalgebra::DMatrix;
use serde::Serialize;

use super::curves::{Balance, Factor, Over};
use crate::formula::Formula;
use crate::likelihood::CurveWeight;
use crate::projection::beside;
use crate::sign::sign;

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
    /// Its values there: N m (N), V, or a share of the flux, in the direction of the motor torque, of
    /// u and of the nominal flux, as the effect `learned` holds them.
    pub values: Vec<f64>,
    /// Their unit; empty for a share.
    pub unit: String,
    /// The most probable formula for what nobody knows, as the text of a `custom` law in the same
    /// balance, with its coefficients in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
    /// Share of the error above the noise floor that it removes in free run.
    pub excess_removed: f64,
}

impl LearnedCurve {
    /// Of a curve that removes that share of the error above the noise floor.
    /// `formulas` are those for what nobody knows, the most probable first.
    pub(crate) fn of(
        weight: &CurveWeight,
        excess_removed: f64,
        drive: &Drive,
        formulas: &[Formula],
    ) -> Self {
        let (curve, values) = (&weight.curve, driving(weight));
        let alike = |it: &&Formula| it.law.parts().0 == target(curve.balance);
        Self {
            balance: curve.balance,
            over: name(curve.over),
            times: times(curve.factor).map(factor_name),
            knots: curve.knots.clone(),
            over_unit: unit(curve.over, drive),
            unit: balance_unit(curve.balance, drive),
            formula: formulas.iter().find(alike).map(Formula::with_values),
            values,
            excess_removed,
        }
    }
}

/// As what the effect `learned` knows it.
fn variable(over: Over) -> Variable {
    match over {
        Over::Speed => Variable::Speed,
        Over::SpeedMagnitude => Variable::SpeedMagnitude,
        Over::Current => Variable::Current,
        Over::CurrentMagnitude => Variable::CurrentMagnitude,
        Over::Position => Variable::Position,
        Over::Time => Variable::Time,
    }
}

fn name(over: Over) -> &'static str {
    Variable::ALL.iter().find(|(_, it)| *it == variable(over)).map_or("", |(name, _)| name)
}

fn unit(over: Over, drive: &Drive) -> String {
    let rotary = match over {
        Over::Speed | Over::SpeedMagnitude => "rad/s",
        // The commanded signal of a force-driven drive has the unit of its recording.
        Over::Current | Over::CurrentMagnitude if drive.motor.input == Input::Force => "",
        Over::Current | Over::CurrentMagnitude => "A",
        Over::Position => "rad",
        Over::Time => "s",
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

/// The curve as an effect of a drive, with the names of the values that these recordings do not
/// tell.
pub(crate) fn effect(drive: &Drive, weight: &CurveWeight) -> (EffectData, Vec<String>) {
    let CurveWeight { curve, identified, .. } = weight;
    let id = drive.free_id(LEARNED);
    let values = driving(weight).into_iter().enumerate();
    let parameters = values.map(|(k, value)| (LawData::value_name(k), value)).collect();
    let unidentified = identified.iter().enumerate().filter(|(_, identified)| !**identified);
    let kept = unidentified.map(|(k, _)| format!("{id}.{}", LawData::value_name(k))).collect();
    let (over, times, target) = (variable(curve.over), times(curve.factor), target(curve.balance));
    let law = LawData::Learned { target, over, times, knots: curve.knots.clone() };
    (EffectData { kind: LEARNED.to_owned(), id, parameters, law: Some(law) }, kept)
}

fn times(factor: Factor) -> Option<Times> {
    match factor {
        Factor::One => None,
        Factor::Direction => Some(Times::Direction),
        Factor::Current => Some(Times::Current),
    }
}

/// Its name in the drive file of a rotary drive.
fn factor_name(times: Times) -> &'static str {
    Times::ALL.iter().find(|(_, other)| *other == times).map_or("", |(name, _)| name)
}

fn target(balance: Balance) -> Target {
    match balance {
        Balance::Torque => Target::Torque,
        Balance::Voltage => Target::Voltage,
        Balance::Flux => Target::Flux,
    }
}

/// What a curve adds to its balance, where weighing counts what is lost.
fn driving(weight: &CurveWeight) -> Vec<f64> {
    beside_parameters(weight).into_iter().map(|value| -value).collect()
}

/// Values of a curve less what parameters of the base do over its variable: a resistance, viscous and
/// dry friction, the nominal flux. How much of that stands in the curve no recording tells. What was
/// not visited goes on as the nearest value that was.
fn beside_parameters(weight: &CurveWeight) -> Vec<f64> {
    let CurveWeight { curve, values, visited, .. } = weight;
    // What is in proportion to the variable, and what is the same on either side of 0.
    let of_base: [fn(f64) -> f64; 2] = match (curve.balance, curve.over, curve.factor) {
        (Balance::Voltage, Over::Current, Factor::One) => [|z| z, |_| 0.0],
        (Balance::Torque, Over::Speed, Factor::One) => [|z| z, sign],
        (Balance::Flux, ..) | (_, _, Factor::Direction | Factor::Current) => [|_| 0.0, |_| 1.0],
        _ => return values.clone(),
    };
    let known: Vec<usize> = (0..values.len()).filter(|k| visited[*k]).collect();
    let rows = DMatrix::from_fn(2, known.len(), |row, k| of_base[row](curve.knots[known[k]]));
    let remainder = beside(&rows, &known.iter().map(|k| values[*k]).collect::<Vec<_>>());
    let nearest = |k: usize| (0..known.len()).min_by_key(|place| known[*place].abs_diff(k));
    (0..values.len()).map(|k| nearest(k).map_or(0.0, |place| remainder[place])).collect()
}
