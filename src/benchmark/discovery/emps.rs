//! EMPS, a real positioning axis, unaided: what a discovery makes of measurements.
//!
//! Janot, Gautier and Brunot, "Data set and reference models of EMPS" (2019). Its authors found
//! that its friction differs by direction.

use std::fmt::Write as _;

use drivescope_discovery::{Discovery, LadderStep};
use serde::Serialize;

/// What has to come out.
const NAME: &str = "asymmetric_friction";
const DIFFERENCE: [f64; 2] = [65.0, 82.0];
const MEAN: [f64; 2] = [185.0, 210.0];
const RATIO: f64 = 0.80;

/// What a discovery answers on EMPS.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Emps {
    named: Vec<String>,
    /// Viscous friction backward less forward, N s/m.
    difference: Option<f64>,
    /// Its mean, N s/m.
    mean: f64,
    /// Validation error over that of the base.
    validation_ratio: f64,
    /// What was looked at and not named, and why.
    refused: Vec<(String, String)>,
}

impl Emps {
    /// Of a discovery on its data.
    pub(super) fn of(found: &Discovery) -> Self {
        let all = found.drive.parameters();
        let value = |name: &str| all.iter().find(|it| it.name == name).map(|it| it.value);
        let error = |step: Option<&LadderStep>| step.map_or(f64::NAN, |it| it.validation_error);
        let refused = found
            .ranking
            .iter()
            .filter_map(|it| it.refused.as_ref().map(|reason| (it.effect.clone(), reason.clone())));
        let not = found.not_judged.iter().map(|it| (it.effect.clone(), it.reason.clone()));
        Self {
            refused: refused.chain(not).collect(),
            difference: value(&format!("{NAME}.dB_m")).map(|half| 2.0 * half),
            mean: found.drive.motor.b_m,
            validation_ratio: error(found.ladder.last()) / error(found.ladder.first()),
            named: found.named.clone(),
        }
    }

    /// The row of the table.
    pub(super) fn text(&self) -> String {
        let mut text = String::from("EMPS, measured, unaided\n");
        let row = |text: &mut String, what: &str, value: String, bar: String| {
            let _ = writeln!(text, "  {what:<52} {value}  (bar: {bar})");
        };
        let named =
            if self.named.is_empty() { "nothing".to_owned() } else { self.named.join(", ") };
        let difference = self.difference.map(|value| format!("{value:.1} N s/m"));
        let difference = difference.unwrap_or_else(|| "none".to_owned());
        let [[a, b], [c, d]] = [DIFFERENCE, MEAN];
        row(&mut text, "named", named, NAME.to_owned());
        row(&mut text, "F_v- less F_v+", difference, format!("{a} to {b} N s/m"));
        row(
            &mut text,
            "mean of F_v",
            format!("{:.1} N s/m", self.mean),
            format!("{c} to {d} N s/m"),
        );
        let ratio = format!("{:.3}", self.validation_ratio);
        row(&mut text, "validation error over that of the base", ratio, format!("at most {RATIO}"));
        for kind in ["stribeck", "cogging"] {
            // Ripples of several wave lengths are refused each for its own reason.
            for (_, reason) in self.refused.iter().filter(|(effect, _)| effect == kind) {
                let _ = writeln!(text, "  {:<52} {reason}", format!("{kind} not named:"));
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_row_says_what_came_out_beside_the_bars() {
        let row = Emps {
            named: vec![NAME.to_owned()],
            difference: Some(74.26),
            mean: 198.5,
            validation_ratio: 0.726,
            refused: [("stribeck", "nothing is slow enough"), ("cogging", "a"), ("cogging", "b")]
                .map(|(effect, reason)| (effect.to_owned(), reason.to_owned()))
                .into(),
        };
        let text = row.text();
        for part in ["74.3 N s/m  (bar: 65 to 82", "198.5", "0.726", "nothing is slow enough"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(text.matches("cogging not named").count(), 2, "{text}");
    }
}
