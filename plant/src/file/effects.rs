//! The `[[effect]]` tables against the registry.

use super::curve::LEARNED;
use super::custom::CUSTOM;
use super::document::Document;
use super::error::{Flaw, Problem};
use super::layout::{EffectTable, EffectValue};
use super::reader::{Reader, is_name, reserved};
use crate::drive::{EffectData, Input, Motion};
use crate::effects::law::Parameter;
use crate::effects::registry::{Entry, REGISTRY};
use crate::parameters::nearest;

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
}
