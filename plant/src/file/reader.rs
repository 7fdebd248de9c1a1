//! One `[[effect]]` table, with the places of what stands in it.

use std::ops::Range;

use toml::de::DeTable;

use super::document::{Document, Spans};
use super::error::{Flaw, Problem};
use super::layout::EffectValue;
use crate::drive::{Input, Motion, fields};
use crate::effects::refusal::Refusal;
use crate::parameters::nearest;

/// One table with its place.
pub(super) struct Reader<'r, 'a> {
    pub(super) document: &'r Document<'a>,
    pub(super) table: &'r DeTable<'a>,
    pub(super) span: Range<usize>,
    pub(super) values: &'r [(String, EffectValue)],
    pub(super) motion: Motion,
    pub(super) input: Input,
    /// Name in messages: the id or the kind as far as known.
    pub(super) name: String,
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

    pub(super) fn not_a_name(&self, key: &str, found: &str, span: Range<usize>) -> Flaw {
        let reserved = reserved().join(", ");
        Flaw::new(Problem::Name { key: self.below(key), found: found.to_owned(), reserved }, span)
    }

    pub(super) fn impossible(&self, id: &str, key: &str, why: Refusal) -> Flaw {
        let problem = Problem::Impossible { id: id.to_owned(), why };
        Flaw::new(problem, self.spans(key).value)
    }
}

/// Names of tables: `controller.K_p` must not be ambiguous.
pub(super) fn reserved() -> Vec<&'static str> {
    let mut sections: Vec<_> = fields().map(|field| field.section).collect();
    sections.dedup();
    sections
}

pub(super) fn is_name(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && letters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}
