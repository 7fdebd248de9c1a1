//! The `[[effect]]` tables against the registry.

use std::ops::Range;

use toml::de::DeTable;

use super::curve::LEARNED;
use super::document::{Document, Spans};
use super::error::{Flaw, Problem};
use super::law_text::offset_in_source;
use super::layout::{EffectTable, EffectValue};
use crate::drive::{EffectData, Input, LawData, Motion, fields};
use crate::effects::custom::{Law, Target};
use crate::effects::law::Parameter;
use crate::effects::refusal::Refusal;
use crate::effects::registry::{Entry, REGISTRY};
use crate::parameters::nearest;
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

/// Names of tables: `controller.K_p` must not be ambiguous.
fn reserved() -> Vec<&'static str> {
    let mut sections: Vec<_> = fields().map(|field| field.section).collect();
    sections.dedup();
    sections
}

fn is_name(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && letters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// One table with its place.
pub(super) struct Reader<'r, 'a> {
    document: &'r Document<'a>,
    pub(super) table: &'r DeTable<'a>,
    span: Range<usize>,
    values: &'r [(String, EffectValue)],
    pub(super) motion: Motion,
    pub(super) input: Input,
    /// Name in messages: the id or the kind as far as known.
    name: String,
}

/// Reads every effect.
pub(super) fn effects(
    document: &Document<'_>,
    tables: &[EffectTable],
    motion: Motion,
    input: Input,
) -> Result<Vec<EffectData>, Flaw> {
    let mut effects: Vec<EffectData> = Vec::new();
    for (number, EffectTable(values)) in tables.iter().enumerate() {
        let (table, span) = document.effect(number).expect("serde has read this table");
        let name = "effect".to_owned();
        let mut reader = Reader { document, table, span, values, motion, input, name };
        let effect = reader.read()?;
        if let Some(first) = effects.iter().position(|other| other.id == effect.id) {
            let first = document.effect(first).map_or(1, |(_, span)| document.line(span.start));
            let key = if effect.id == effect.kind { "kind" } else { "id" };
            let span = reader.spans(key).value;
            return Err(Flaw::new(Problem::Twice { id: effect.id, first }, span));
        }
        let kinds = effects.iter().map(|other| other.kind.as_str());
        let excluded = Entry::find(&effect.kind).and_then(|entry| entry.info.excluded_by(kinds));
        if let Some(first) = excluded {
            let line = document.effect(first).map_or(1, |(_, span)| document.line(span.start));
            let (id, other) = (effect.id, effects[first].id.clone());
            let span = reader.spans("kind").value;
            return Err(Flaw::new(Problem::Excluded { id, other, first: line }, span));
        }
        effects.push(effect);
    }
    Ok(effects)
}

impl Reader<'_, '_> {
    pub(super) fn spans(&self, key: &str) -> Spans {
        let whole = || Spans { key: self.span.clone(), value: self.span.clone() };
        Document::spans(self.table, key).unwrap_or_else(whole)
    }

    pub(super) fn get(&self, key: &str) -> Option<&EffectValue> {
        self.values.iter().find(|(k, _)| k == key).map(|(_, value)| value)
    }

    pub(super) fn below(&self, key: &str) -> String {
        format!("{}.{key}", self.name)
    }

    pub(super) fn of_type(&self, key: &str, expected: &str) -> Flaw {
        let span = self.spans(key).value;
        let value = self.table.get(key).expect("the key was read").get_ref();
        let found = super::document::shown(self.document.text, value, span.clone());
        let key = self.below(key);
        Flaw::new(Problem::Type { key, found, expected: expected.to_owned() }, span)
    }

    pub(super) fn missing(&self, key: &str, why: &str) -> Flaw {
        let problem = Problem::Missing { key: self.below(key), why: why.to_owned() };
        Flaw::new(problem, self.span.clone())
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&str>, Flaw> {
        match self.get(key) {
            None => Ok(None),
            Some(EffectValue::Text(text)) => Ok(Some(text)),
            Some(_) => Err(self.of_type(key, "a text in quotes")),
        }
    }

    /// Refuses every key that is not among these.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), Flaw> {
        let Some((key, _)) = self.values.iter().find(|(key, _)| !known.contains(&key.as_str()))
        else {
            return Ok(());
        };
        let problem = Problem::UnknownKey {
            key: self.below(key),
            nearest: nearest(key, known.iter().copied()),
            known: known.join(", "),
        };
        Err(Flaw::new(problem, self.spans(key).key))
    }

    fn read(&mut self) -> Result<EffectData, Flaw> {
        let kinds = || REGISTRY.iter().map(|entry| entry.info.id).chain([CUSTOM, LEARNED]);
        let known = kinds().collect::<Vec<_>>().join(", ");
        let Some(kind) = self.text("kind")? else {
            return Err(self.missing("kind", &format!(", one of {known}")));
        };
        let kind = kind.to_owned();
        let id = match self.text("id")? {
            Some(id) if is_name(id) && !reserved().contains(&id) => id.to_owned(),
            Some(id) => return Err(self.not_a_name("id", id, self.spans("id").value)),
            None => kind.clone(),
        };
        self.name.clone_from(&id);
        if let Some(entry) = Entry::find(&kind) {
            self.registered(kind, id, entry)
        } else if kind == CUSTOM {
            self.custom(kind, id)
        } else if kind == LEARNED {
            self.learned(kind, id)
        } else {
            let nearest = nearest(&kind, kinds());
            let span = self.spans("kind").value;
            Err(Flaw::new(Problem::UnknownEffect { kind, nearest, known }, span))
        }
    }

    fn not_a_name(&self, key: &str, found: &str, span: Range<usize>) -> Flaw {
        let reserved = reserved().join(", ");
        Flaw::new(Problem::Name { key: self.below(key), found: found.to_owned(), reserved }, span)
    }

    pub(super) fn impossible(&self, id: &str, key: &str, why: Refusal) -> Flaw {
        let problem = Problem::Impossible { id: id.to_owned(), why };
        Flaw::new(problem, self.spans(key).value)
    }

    fn registered(&self, kind: String, id: String, entry: &Entry) -> Result<EffectData, Flaw> {
        let names = entry.parameters.iter().map(|parameter| parameter.name);
        self.only(&["kind", "id"].into_iter().chain(names).collect::<Vec<_>>())?;
        if let Some(why) = entry.info.impossible(self.motion, self.input) {
            return Err(self.impossible(&id, "kind", why));
        }
        let value = |parameter: &Parameter| match self.get(parameter.name) {
            Some(EffectValue::Number(value)) => Ok((parameter.name.to_owned(), *value)),
            Some(_) => Err(self.of_type(parameter.name, "a number")),
            None => Err(self.missing(parameter.name, &format!(", {}", parameter.description))),
        };
        let parameters = entry.parameters.iter().map(value).collect::<Result<_, _>>()?;
        Ok(EffectData { kind, id, parameters, law: None })
    }

    fn custom(&self, kind: String, id: String) -> Result<EffectData, Flaw> {
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
