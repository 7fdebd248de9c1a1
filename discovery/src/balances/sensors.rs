//! What the drive was like behind sensors that show something else: an offset, a gain, an eccentricity.
//!
//! The balances hold for what the armature carries and how the shaft turns. A sensor that is off by little
//! shows y = x + e(x), and x follows by x := y - e(x), again and again.

use std::borrow::Cow;

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::model::{Applied, CURRENT, POSITION, SPEED};

use super::laws::without_states;
use crate::measured::{Measured, Output};

/// Rounds of x := y - e(x): of an error of a third a thousandth is left.
const ROUNDS: usize = 6;
/// What shows each of a drive's true values; a position may be known beside a speed.
const SHOWN: [(Output, usize); 3] =
    [(Output::Current, CURRENT), (Output::Speed, SPEED), (Output::Position, POSITION)];

/// The recording without what the drive's sensors add to true values; sensors with states of their own are
/// taken as they are.
pub(super) fn behind<'a>(drive: &Drive, measured: &'a Measured) -> Cow<'a, Measured> {
    let senses =
        |effect: &EffectData| Entry::find(&effect.kind).is_some_and(|entry| entry.info.senses());
    if !drive.effects.iter().any(senses) {
        return Cow::Borrowed(measured);
    }
    let model = without_states(drive).model();
    let mut behind = measured.clone();
    for k in measured.pieces.iter().cloned().flatten() {
        let mut x = vec![[0.0]; model.states()];
        let applied = Applied { u: [measured.u[k]], load: [0.0], time: measured.time(k) };
        let shown = SHOWN.map(|(output, _)| {
            let beside = measured.angle.as_ref().filter(|_| output == Output::Position);
            let value = measured.output(output).map(|it| it.values[k]);
            value.or(beside.map(|angle| angle[k])).filter(|y| y.is_finite())
        });
        let known = || shown.iter().zip(SHOWN).map(|(y, (_, state))| (state, *y));
        known().for_each(|(state, y)| x[state] = [y.unwrap_or(0.0)]);
        for _ in 0..ROUNDS {
            let is = model.outputs(&x, &applied);
            for ((state, y), [is]) in known().zip([is.i, is.omega, is.theta]) {
                x[state][0] += y.map_or(0.0, |y| y - is);
            }
        }
        for (output, state) in SHOWN {
            let channel = behind.outputs.iter_mut().find(|it| it.output == output);
            if let Some(channel) = channel.filter(|it| it.values[k].is_finite()) {
                channel.values[k] = x[state][0];
            }
        }
    }
    Cow::Owned(behind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balances::unexplained;
    use crate::estimate::Evidence;
    use crate::testing::{bench, dr300};

    fn with(kind: &str, parameters: &[(&str, f64)]) -> Drive {
        let mut drive = dr300();
        drive.effects.push(EffectData {
            kind: kind.to_owned(),
            id: kind.to_owned(),
            parameters: parameters
                .iter()
                .map(|(name, value)| ((*name).to_owned(), *value))
                .collect(),
            law: None,
        });
        drive
    }

    #[test]
    fn true_values_are_found_behind_a_sensor_that_is_off() {
        let recording = bench(&dr300(), 3.0, 0.001);
        let mut shown = recording.clone();
        for signal in &mut shown.signals {
            let change = |values: &mut Vec<f64>, by: &dyn Fn(f64) -> f64| {
                values.iter_mut().for_each(|value| *value = by(*value));
            };
            match signal.name.as_str() {
                "i" => change(&mut signal.values, &|i| i + 0.3),
                "omega" => change(&mut signal.values, &|omega| 1.2 * omega),
                _ => {}
            }
        }
        let mut drive = with("current_offset", &[("i_0", 0.3)]);
        drive.effects.extend(with("tacho_gain", &[("g", 0.2)]).effects.pop());
        let measured = |recording| Measured::new(&drive, recording).expect("usable");
        let (true_values, shown) = (measured(&recording), measured(&shown));
        let found = behind(&drive, &shown);
        for (found, truth) in found.outputs.iter().zip(&true_values.outputs) {
            let most = truth.values.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
            let off = found.values.iter().zip(&truth.values).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-3 * most, "{}", truth.name);
        }
        // The balance of torques is that of the armature's current.
        let left = |drive: &Drive| {
            let evidence =
                Evidence { recordings: vec![shown.clone()], noise: vec![vec![0.01, 0.3]] };
            unexplained(drive, &evidence)[0].expect("it is told").share
        };
        let (without, with) = (left(&dr300()), left(&drive));
        assert!(with < 0.2 * without, "{without} {with}");
        assert!(matches!(behind(&dr300(), &shown), Cow::Borrowed(_)));
    }
}
