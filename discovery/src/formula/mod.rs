//! What nobody knows, as a formula: a small symbolic search, judged by the evidence that judges laws.
//!
//! ```text
//!  grammar: factors of speed, current, position ──> proposals: some thousand formulas
//!     ──> weighed: a column each beside the base, whitened by the same filters
//!     ──> judged: the best that differ, fitted as custom laws, less what choosing one costs;
//!         then those that come nearest to the curve of the best (compared), fitted from there
//! ```
//!
//! A formula with n names and numbers is one of N(n) that are no more complex, each as probable
//! beforehand as the others: choosing it costs ln N(n). Sums of two terms are not searched: with one of
//! them in the drive, another discovery proposes the other.

mod compared;
mod grammar;
mod judged;
mod proposals;
#[cfg(test)]
mod tests;
mod weighed;

use std::collections::BTreeMap;

use drivescope_plant::effects::custom::Target;
use serde::Serialize;

pub(crate) use judged::formulas;

use grammar::COEFFICIENTS;

/// A formula for what a drive lacks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Formula {
    /// The text of a custom law.
    #[serde(flatten)]
    pub law: FormulaLaw,
    /// Its coefficients and the constants of its shape, SI.
    pub parameters: BTreeMap<String, f64>,
    /// ln of its evidence over that of the model without it, in all recordings.
    pub evidence: f64,
    /// Its probability among those proposed, 0 to 1.
    pub probability: f64,
    /// Names and numbers in it.
    pub complexity: usize,
    /// ln of the number of formulas that are no more complex: what choosing it costs.
    #[serde(skip)]
    pub(crate) price: f64,
    /// Root of the mean square of what it does, of what the balance holds.
    #[serde(skip)]
    pub(crate) size: f64,
}

impl Formula {
    /// Evidence less price.
    pub(crate) fn worth(&self) -> f64 {
        self.evidence - self.price
    }

    /// The constants of its shape: those of its parameters that are no coefficients.
    pub fn shape(&self) -> impl Iterator<Item = (&str, f64)> {
        let constant = |(name, _): &(&String, &f64)| !COEFFICIENTS.contains(&name.as_str());
        self.parameters.iter().filter(constant).map(|(name, value)| (name.as_str(), *value))
    }

    /// Its text with the values of its parameters in it.
    pub fn with_values(&self) -> String {
        let (_, text) = self.law.parts();
        let apart = |c: char| !(c.is_alphanumeric() || c == '_' || c == '.');
        let value = |word: &str| match self.parameters.get(word) {
            Some(value) if *value < 0.0 => format!("({value:.4e})"),
            Some(value) => format!("{value:.4e}"),
            None => word.to_owned(),
        };
        let pieces = text.split_inclusive(apart);
        pieces
            .map(|piece| {
                let word = piece.trim_end_matches(apart);
                value(word) + &piece[word.len()..]
            })
            .collect()
    }
}

/// A law by what it gives.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FormulaLaw {
    /// A torque (force) in the positive direction, N m (N).
    Torque(String),
    /// A voltage in the direction of u, V.
    Voltage(String),
}

impl FormulaLaw {
    fn of(target: Target, text: String) -> Self {
        if target == Target::Voltage { Self::Voltage(text) } else { Self::Torque(text) }
    }

    /// What it gives, and its text.
    pub fn parts(&self) -> (Target, &str) {
        match self {
            Self::Torque(text) => (Target::Torque, text),
            Self::Voltage(text) => (Target::Voltage, text),
        }
    }
}
