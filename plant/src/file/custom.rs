//! The `[[effect]]` of a typed law: one target with its text, and the coefficients.

use super::document::Document;
use super::error::{Flaw, Problem};
use super::law_text::offset_in_source;
use super::layout::EffectValue;
use super::reader::{Reader, is_name};
use crate::drive::{EffectData, Input, LawData, Motion};
use crate::effects::custom::{Law, Target};
use crate::effects::refusal::Refusal;
use crate::units::name_for_motion;

/// The kind of an effect whose law stands in the file.
pub const CUSTOM: &str = "custom";

/// What an effect of a custom kind may give, with the keys for that motion.
pub(super) fn targets(motion: Motion) -> Vec<(&'static str, Target)> {
    let mut all = Target::ALL.to_vec();
    if motion == Motion::Linear {
        let named = |(key, target)| (name_for_motion(motion, key), target);
        all.extend(Target::ALL.map(named).into_iter().filter(|(key, _)| *key == "v"));
    }
    all
}

/// The key of what a custom effect gives, in the file of a drive that moves so.
///
/// # Panics
/// Never: every target has a key.
pub fn target_key(target: Target, motion: Motion) -> &'static str {
    // The last key of a target is the motion's own.
    let key = targets(motion).into_iter().rfind(|(_, other)| *other == target);
    key.expect("every target has a key").0
}

impl Reader<'_, '_> {
    /// Reads the law.
    pub(super) fn custom(&self, kind: String, id: String) -> Result<EffectData, Flaw> {
        let targets = targets(self.motion);
        let keys: Vec<_> = targets.iter().map(|(key, _)| *key).collect();
        self.only(&[&["kind", "id", "parameters"], keys.as_slice()].concat())?;
        let given: Vec<_> = targets.iter().filter(|(key, _)| self.get(key).is_some()).collect();
        let [(key, target)] = given[..] else {
            let found: Vec<_> = given.iter().map(|(key, _)| *key).collect();
            let found = if found.is_empty() { "no law".to_owned() } else { found.join(" and ") };
            let span = given.get(1).map_or(self.span.clone(), |(key, _)| self.spans(key).key);
            return Err(Flaw::new(Problem::Laws { id, found, known: keys.join(", ") }, span));
        };
        if self.input == Input::Force && matches!(target, Target::Voltage | Target::Heat) {
            return Err(self.impossible(&id, key, Refusal::NoCircuit));
        }
        let parameters = self.coefficients()?;
        let text = self.text(key)?.expect("the key is given");
        let names: Vec<String> = parameters.iter().map(|(name, _)| name.clone()).collect();
        Law::parse(*target, text, &names).map_err(|error| {
            let string = self.spans(key).value;
            let at =
                string.start + offset_in_source(&self.document.text[string.clone()], error.at());
            // The character itself is underlined; at the end of the law, its closing quote.
            let length = self.document.text[at..].chars().next().map_or(0, char::len_utf8);
            Flaw::new(Problem::Law { key: self.below(key), error }, at..at + length)
        })?;
        let law = Some(LawData::Typed { target: *target, text: text.to_owned() });
        Ok(EffectData { kind, id, law, parameters })
    }

    fn coefficients(&self) -> Result<Vec<(String, f64)>, Flaw> {
        let all = match self.get("parameters") {
            None => return Ok(Vec::new()),
            Some(EffectValue::Coefficients(all)) => all,
            Some(_) => return Err(self.of_type("parameters", "a table such as { c = 1.0e-7 }")),
        };
        if let Some((name, _)) = all.iter().find(|(name, _)| !is_name(name)) {
            let table = self.table.get("parameters").and_then(|p| p.get_ref().as_table());
            let spans = table.and_then(|table| Document::spans(table, name));
            let span = spans.map_or_else(|| self.spans("parameters").value, |spans| spans.key);
            return Err(self.not_a_name("parameters", name, span));
        }
        Ok(all.clone())
    }
}
