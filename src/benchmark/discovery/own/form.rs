//! Whether a formula has the form of a hidden law: equal where the machine went.

use drivescope_discovery::Formula;
use drivescope_numerics::Regression;
use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::custom::{Law, Target};
use drivescope_plant::unit::Unit;
use drivescope_recording::Recording;

/// A law that is hidden in a machine.
#[derive(Debug, Clone)]
pub(in crate::benchmark) struct HiddenLaw {
    pub(super) truth: Drive,
    pub(super) effect: EffectData,
}

/// How far a formula is from a hidden law where the machine went, its coefficients and what the
/// base has besides (friction, resistance, the torque and back-EMF constants) at their best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::benchmark) struct Distance {
    /// Root of the mean square, of that of the law.
    pub(in crate::benchmark) of_law: f64,
    /// The same of what the base alone leaves of the law.
    pub(in crate::benchmark) of_rest: f64,
}

impl HiddenLaw {
    /// The law, as it is in the machine.
    pub(in crate::benchmark) fn effect(&self) -> &EffectData {
        &self.effect
    }

    /// The law as a user would type it, who knows its form: its coefficient `c` is 0.
    pub(in crate::benchmark) fn at_null(&self) -> EffectData {
        let mut effect = self.effect.clone();
        effect.parameters.iter_mut().filter(|it| it.0 == "c").for_each(|it| it.1 = 0.0);
        effect
    }

    /// Nothing where the formula stands in the other balance.
    pub(in crate::benchmark) fn distance(
        &self,
        formula: &Formula,
        recording: &Recording,
    ) -> Option<Distance> {
        let hidden = self.effect.typed()?;
        let (target, text) = formula.law.parts();
        if target != hidden.target() {
            return None;
        }
        let own: Vec<f64> = self.effect.parameters.iter().map(|(_, value)| *value).collect();
        let (names, values): (Vec<String>, Vec<f64>) =
            formula.parameters.iter().map(|(name, value)| (name.clone(), *value)).unzip();
        let law = Law::parse(target, text, &names).ok()?;
        let places = self.places(recording);
        let lost: Vec<f64> = places.iter().map(|at| hidden.at(&own, *at)).collect();
        // A formula is linear in the first two of its names, c and d.
        let coefficients = ["c", "d"].map(|name| names.iter().position(|it| it == name));
        let one = |only: usize| {
            let mut values = values.clone();
            coefficients.iter().flatten().for_each(|place| values[*place] = 0.0);
            values[only] = 1.0;
            values
        };
        let columns: Vec<Vec<f64>> = coefficients.into_iter().flatten().map(one).collect();
        let known = |[i, omega, ..]: [f64; 5]| match target {
            Target::Voltage => vec![i, omega],
            _ => vec![i, omega, if omega == 0.0 { 0.0 } else { omega.signum() }],
        };
        let base: Vec<Vec<f64>> = places.iter().map(|at| known(*at)).collect();
        let with = |at: usize| {
            let mut row = base[at].clone();
            row.extend(columns.iter().map(|values| law.at(values, places[at])));
            row
        };
        let all: Vec<Vec<f64>> = (0..places.len()).map(with).collect();
        let (of_base, remainder) = (unexplained(&lost, &base)?, unexplained(&lost, &all)?);
        let size = lost.iter().map(|it| it * it).sum::<f64>().sqrt();
        Some(Distance { of_law: remainder / size, of_rest: remainder / of_base })
    }

    /// Where the machine goes under the voltage of a recording: `[i, omega, theta, u, t]`.
    fn places(&self, recording: &Recording) -> Vec<[f64; 5]> {
        let mut unit = Unit::new(self.truth.clone(), true);
        let place = |name: &str| unit.reference(name).expect("a unit has it");
        let (at_u, shown) = (place("u"), ["i", "omega", "theta"].map(place));
        let u = recording.signals.iter().find(|it| it.name == "u").expect("it is driven");
        let period_s = recording.period_s;
        unit.initialize(0.0);
        let mut places = Vec::with_capacity(u.values.len());
        for (k, u) in u.values.iter().enumerate() {
            let time = k as f64 * period_s;
            unit.set_time(time);
            unit.set(at_u, *u).expect("finite");
            let [i, omega, theta] = shown.map(|place| unit.get(place).expect("finite"));
            places.push([i, omega, theta, *u, time]);
            unit.step(period_s).expect("finite");
        }
        places
    }
}

/// Root of the sum of squares of what columns, row by row, leave of values.
fn unexplained(values: &[f64], rows: &[Vec<f64>]) -> Option<f64> {
    let columns = rows.first()?.len();
    let mut regression = Regression::new(columns);
    for (row, value) in rows.iter().zip(values) {
        regression.push(row.iter().copied(), *value);
    }
    Some(regression.solve().ok()?.sse.sqrt())
}
