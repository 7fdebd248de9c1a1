//! A law that the user types: checked while it is typed, shown beside what is missing, added.

use drivescope_discovery::compare::Curve;
use drivescope_plant::drive::Drive;
use drivescope_plant::effects::custom::{Law, Target};
use maud::{Markup, PreEscaped, html};
use serde::{Deserialize, Serialize};

use super::session_step::SessionStep;
use crate::answer::compare::pictures;
use crate::failure::Failure;
use crate::report::page::minus;
use crate::report::plot::{Dash, Ink, Layer};
use crate::report::words::number;

/// Width of the preview, pixels.
const WIDTH: f64 = 400.0;
/// Points of the previewed law.
const POINTS: usize = 121;

/// What the user typed.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct TypedLaw {
    /// What it gives: `torque`, `voltage`, ...
    target: String,
    /// The law.
    text: String,
    /// Its coefficients with their start values, `c = 1e-6, d`; a value that is left out is
    /// taken from what is missing.
    coefficients: String,
}

/// What is wrong, and where in the text of the law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Wrong {
    /// Position of the character in the law; none where the law is not to blame.
    pub(super) at: Option<usize>,
    /// What is wrong.
    pub(super) words: String,
}

/// A law that was understood.
#[derive(Debug)]
pub(super) struct Understood {
    target: &'static str,
    law: Law,
    text: String,
    names: Vec<String>,
    values: Vec<f64>,
}

impl TypedLaw {
    /// Understands the law; start values that were left out are 1, or fit what is missing.
    ///
    /// # Errors
    /// What is wrong.
    pub(super) fn understood(&self, curves: &[Curve]) -> Result<Understood, Wrong> {
        let wrong = |words: String| Wrong { at: None, words };
        let known = Target::ALL.iter().find(|(name, _)| *name == self.target);
        let (target, kind) =
            *known.ok_or_else(|| wrong(format!("`{}` is no target", self.target)))?;
        let (mut names, mut given) = (Vec::new(), Vec::new());
        for item in self.coefficients.split(',').map(str::trim).filter(|it| !it.is_empty()) {
            let (name, value) = match item.split_once('=') {
                None => (item, None),
                Some((name, value)) => {
                    let parsed = value.trim().parse::<f64>().ok().filter(|it| it.is_finite());
                    let none = || wrong(format!("`{}` is no number", value.trim()));
                    (name.trim(), Some(parsed.ok_or_else(none)?))
                }
            };
            if names.iter().any(|other| other == name) {
                return Err(wrong(format!("the coefficient `{name}` is there twice")));
            }
            names.push(name.to_owned());
            given.push(value);
        }
        let law = Law::parse(kind, &self.text, &names).map_err(|error| Wrong {
            // Bytes to characters, as a text field counts.
            at: self.text.get(..error.at()).map(|before| before.chars().count()),
            words: error.to_string(),
        })?;
        let mut values: Vec<f64> = given.iter().map(|value| value.unwrap_or(1.0)).collect();
        let text = self.text.clone();
        let open: Vec<usize> = (0..given.len()).filter(|k| given[*k].is_none()).collect();
        let understood = |values| Understood { target, law, text, names, values };
        if let ([only], Some(curve)) = (open.as_slice(), shown_over(target, &self.text, curves)) {
            let this = understood(values.clone());
            if let Some(scale) = this.scale(curve, *only) {
                values[*only] = scale;
            }
            return Ok(Understood { values, ..this });
        }
        Ok(understood(values))
    }
}

/// The curve of what is missing that a law can be drawn beside: over the variable that it reads.
fn shown_over<'a>(target: &str, text: &str, curves: &'a [Curve]) -> Option<&'a Curve> {
    let reads = |name: &str| {
        let apart = |c: char| !(c.is_alphanumeric() || c == '_');
        text.split(apart).any(|word| word == name)
    };
    let variable = [("omega", "omega"), ("v", "omega"), ("i", "i"), ("theta", "theta")]
        .into_iter()
        .find(|(name, _)| reads(name))?
        .1;
    curves.iter().find(|curve| curve.variable == variable && curve.balance == target)
}

impl Understood {
    /// The law at a place of a variable, the others at zero.
    fn at(&self, variable: &str, x: f64, values: &[f64]) -> f64 {
        let place = match variable {
            "i" => [x, 0.0, 0.0, 0.0, 0.0],
            "theta" => [0.0, 0.0, x, 0.0, 0.0],
            _ => [0.0, x, 0.0, 0.0, 0.0],
        };
        self.law.at(values, place)
    }

    /// The value of one coefficient with which the law is nearest to the curve, if the law is
    /// proportional to it.
    fn scale(&self, curve: &Curve, coefficient: usize) -> Option<f64> {
        let with = |value: f64| {
            let mut values = self.values.clone();
            values[coefficient] = value;
            curve.x.iter().map(|x| self.at(curve.variable, *x, &values)).collect::<Vec<f64>>()
        };
        let (none, one) = (with(0.0), with(1.0));
        let (mut dot, mut own) = (0.0, 0.0);
        for ((none, one), wanted) in none.iter().zip(&one).zip(&curve.value) {
            dot += (one - none) * (wanted - none);
            own += (one - none).powi(2);
        }
        Some(dot / own).filter(|it| it.is_finite() && *it != 0.0)
    }

    /// The law beside what is missing.
    pub(super) fn preview(&self, curves: &[Curve]) -> Markup {
        let values = self.names.iter().zip(&self.values);
        let values = values.map(|(name, value)| format!("{name} = {}", minus(&number(*value))));
        let values = values.collect::<Vec<_>>().join(", ");
        html! {
            p.good { "Understood" @if !values.is_empty() { "; a fit starts at " (values) } "." }
            @match shown_over(self.target, &self.text, curves) {
                None => p.note { "What is missing over its variables was not drawn." },
                Some(curve) => {
                    (PreEscaped(self.figure(curve)))
                    p.note { "Dashed: the law. The band: what is missing, with 95 %." }
                }
            }
        }
    }

    fn figure(&self, curve: &Curve) -> String {
        let mut figure = pictures::curve(curve, "law");
        let (first, last) = (curve.x.first().copied(), curve.x.last().copied());
        let (from, to) = (first.unwrap_or(0.0), last.unwrap_or(1.0));
        let point = |k: usize| {
            let x = from + (to - from) * k as f64 / (POINTS - 1) as f64;
            (x, self.at(curve.variable, x, &self.values))
        };
        figure.panels[0].layers.push(Layer::Line {
            label: "the law".to_owned(),
            points: (0..POINTS).map(point).collect(),
            ink: Ink::Vermilion,
            dash: Dash::Dashed,
        });
        figure.svg_of(WIDTH)
    }

    /// What is done, and the drive file of the step with the law in it.
    ///
    /// # Errors
    /// A drive that cannot have it.
    pub(super) fn added(&self, step: &SessionStep) -> Result<(String, String), Failure> {
        let id = step.drive.free_id("custom");
        let values = self.names.iter().zip(&self.values);
        let values: Vec<String> =
            values.map(|(name, value)| format!("{name} = {value:e}")).collect();
        let text = format!(
            "{}\n[[effect]]\nkind = \"custom\"\nid = \"{id}\"\n{} = {}\nparameters = {{ {} }}\n",
            step.text,
            self.target,
            serde_json::Value::from(self.text.as_str()),
            values.join(", ")
        );
        Drive::parse(&text, "the drive with this law").map_err(|error| Failure::Usage {
            what: error.to_string(),
            instead: "change the law or its coefficients".to_owned(),
        })?;
        Ok((format!("+ {} = {}", self.target, self.text), text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(text: &str, coefficients: &str) -> TypedLaw {
        let (text, coefficients) = (text.to_owned(), coefficients.to_owned());
        TypedLaw { target: "torque".to_owned(), text, coefficients }
    }

    /// A drag of 2e-6 is missing.
    fn missing() -> Curve {
        let x: Vec<f64> = (-10..=10).map(|k| 10.0 * f64::from(k)).collect();
        let value: Vec<f64> = x.iter().map(|x| -2e-6 * x * x.abs()).collect();
        Curve {
            variable: "omega",
            balance: "torque",
            words: "torque over speed",
            x_unit: "rad/s".to_owned(),
            unit: "N m".to_owned(),
            lower: value.clone(),
            upper: value.clone(),
            x,
            value,
        }
    }

    #[test]
    fn a_coefficient_without_a_value_fits_what_is_missing() {
        let law = typed("-c * omega * abs(omega)", "c").understood(&[missing()]).expect("right");
        assert!((law.values[0] / 2e-6 - 1.0).abs() < 1e-9, "{:?}", law.values);
        let preview = law.preview(&[missing()]).into_string();
        assert!(preview.contains("the law") && preview.contains("c = 2.00e\u{2212}6"), "{preview}");
        let given = typed("-c * omega", "c = 5").understood(&[missing()]).expect("right");
        assert_eq!(given.values, [5.0]);
    }

    #[test]
    fn what_is_wrong_has_its_place() {
        let wrong = |text: &str, coefficients: &str| {
            typed(text, coefficients).understood(&[]).expect_err("wrong")
        };
        assert_eq!(wrong("-c * speed", "c").at, Some(5));
        assert_eq!(wrong("c * ", "c").at, Some(4));
        assert!(wrong("c", "c = x").words.contains("no number"));
        assert!(wrong("c", "c, c").words.contains("twice"));
        let odd = TypedLaw { target: "power".to_owned(), ..typed("c", "c") };
        assert!(odd.understood(&[]).is_err());
    }
}
