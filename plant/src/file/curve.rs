//! The `[[effect]]` of a learned curve: `balance`, `over`, perhaps `times`, `knots`, `values`.

use std::ops::Range;

use super::error::{Flaw, Problem};
use super::layout::EffectValue;
use super::reader::Reader;
use crate::drive::{EffectData, Input, LawData, Motion};
use crate::effects::custom::Target;
use crate::effects::learned::{Factor, KnotError, Over};
use crate::effects::refusal::Refusal;

/// The kind of an effect that is a learned curve.
pub const LEARNED: &str = "learned";

/// The balances in which a curve may act.
pub const BALANCES: [(&str, Target); 3] =
    [("torque", Target::Torque), ("voltage", Target::Voltage), ("flux", Target::Flux)];

/// The variables that a curve may go over for that motion; its own names come last.
pub(super) fn overs(motion: Motion) -> Vec<(&'static str, Over)> {
    of_motion(&Over::ALL, motion)
}

/// What a curve may be multiplied by; the names of that motion come last.
pub(super) fn factors(motion: Motion) -> Vec<(&'static str, Factor)> {
    of_motion(&Factor::ALL, motion)
}

fn of_motion<T: Copy>(all: &[(&'static str, T)], motion: Motion) -> Vec<(&'static str, T)> {
    let linear = |name: &str| ["v", "x", "abs(v)", "sign(v)"].contains(&name);
    all.iter().filter(|(name, _)| motion == Motion::Linear || !linear(name)).copied().collect()
}

impl Reader<'_, '_> {
    /// Reads the curve.
    pub(super) fn learned(&self, kind: String, id: String) -> Result<EffectData, Flaw> {
        self.only(&["kind", "id", "balance", "over", "times", "knots", "values"])?;
        let target = self.choice("balance", &BALANCES)?;
        if self.input == Input::Force && target == Target::Voltage {
            return Err(self.impossible(&id, "balance", Refusal::NoCircuit));
        }
        let over = self.choice("over", &overs(self.motion))?;
        let times = match self.get("times") {
            Some(_) => Some(self.choice("times", &factors(self.motion))?),
            None => None,
        };
        if times == Some(Factor::Direction) && target != Target::Torque {
            return Err(
                self.of_type("times", "\"i\", for the sign of the motion belongs to a torque")
            );
        }
        let (knots, values) = (self.list("knots")?, self.list("values")?);
        self.motion.curve(over, knots).map_err(|error| {
            let span = match error {
                KnotError::Order { number, .. } => self.item("knots", number),
                KnotError::Count { .. } | KnotError::Revolution { .. } => self.spans("knots").value,
            };
            Flaw::new(Problem::Knots { key: self.below("knots"), error }, span)
        })?;
        if knots.len() != values.len() {
            let (knots, values) = (knots.len(), values.len());
            let span = self.spans("values").value;
            return Err(Flaw::new(Problem::Values { id, knots, values }, span));
        }
        let named = |(k, value): (usize, &f64)| (LawData::value_name(k), *value);
        let parameters = values.iter().enumerate().map(named).collect();
        let law = Some(LawData::Learned { target, over, times, knots: knots.to_vec() });
        Ok(EffectData { kind, id, parameters, law })
    }

    /// One of these words.
    fn choice<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<T, Flaw> {
        let known: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let known = known.join(" or ");
        let Some(text) = self.text(key)? else {
            return Err(self.missing(key, &format!(", {known}")));
        };
        let found = words.iter().find(|(word, _)| *word == text);
        found.map(|(_, value)| *value).ok_or_else(|| self.of_type(key, &known))
    }

    /// A list of numbers.
    fn list(&self, key: &str) -> Result<&[f64], Flaw> {
        match self.get(key) {
            Some(EffectValue::List(all)) => Ok(all),
            Some(_) => Err(self.of_type(key, "a list of numbers")),
            None => Err(self.missing(key, ", a list of numbers")),
        }
    }

    /// Where a number of a list stands.
    fn item(&self, key: &str, number: usize) -> Range<usize> {
        let list = self.table.get(key).and_then(|list| list.get_ref().get(number));
        list.map_or_else(|| self.spans(key).value, |item| item.span())
    }
}
