//! From the TOML tree to the structs of [`super::layout`] by serde, keeping what serde knows of
//! an error (the key, the keys that are allowed) and the place, which its text would lose.

use std::fmt;

use serde::de::{
    self, DeserializeSeed, Deserializer, Expected, IntoDeserializer, Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::document::{Document, shown};
use super::error::{Flaw, Problem};
use crate::drive::fields;
use crate::parameters::nearest;

/// Deserialises the whole document.
pub(super) fn deserialize<T: de::DeserializeOwned>(document: &Document<'_>) -> Result<T, Flaw> {
    let context = Context { text: document.text, path: String::new() };
    let flawed = T::deserialize(Table { entries: sorted(&document.root), context: &context });
    // The start of the file is meant by an error of the outermost table.
    flawed.map_err(|trouble| trouble.at(&context, "a table".to_owned(), 0..0))
}

/// What serde reports, until the place is known.
#[derive(Debug)]
pub(super) enum Trouble {
    UnknownKey { key: String, known: &'static [&'static str] },
    Missing(&'static str),
    Type(String),
    Located(Box<Flaw>),
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

impl std::error::Error for Trouble {}

impl de::Error for Trouble {
    fn custom<T: fmt::Display>(expected: T) -> Self {
        Self::Type(expected.to_string())
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::Type(readable(&expected.to_string()))
    }

    fn invalid_value(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::Type(readable(&expected.to_string()))
    }

    fn unknown_variant(_: &str, expected: &'static [&'static str]) -> Self {
        let words: Vec<_> = expected.iter().map(|word| format!("\"{word}\"")).collect();
        Self::Type(words.join(" or "))
    }

    fn unknown_field(field: &str, known: &'static [&'static str]) -> Self {
        Self::UnknownKey { key: field.to_owned(), known }
    }

    fn missing_field(field: &'static str) -> Self {
        Self::Missing(field)
    }
}

/// serde's names of types for people who do not program.
fn readable(expected: &str) -> String {
    match expected {
        "f64" => "a number",
        "i64" => "a whole number",
        "a string" => "a text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        other => other,
    }
    .to_owned()
}

impl Trouble {
    /// Adds the place of the value that was being read, unless a narrower one is known.
    fn at(self, context: &Context<'_>, found: String, span: std::ops::Range<usize>) -> Flaw {
        let problem = match self {
            Self::Located(flaw) => return *flaw,
            Self::UnknownKey { key, known } => Problem::UnknownKey {
                nearest: nearest(&key, known.iter().copied()),
                key: context.below(&key),
                known: known.join(", "),
            },
            Self::Missing(key) => {
                let field = fields().find(|f| f.section == context.path && f.key == key);
                let why = field.map_or_else(String::new, |f| format!(", {}", f.description));
                Problem::Missing { key: context.below(key), why }
            }
            Self::Type(expected) => Problem::Type { key: context.path.clone(), found, expected },
        };
        Flaw::new(problem, span)
    }
}

/// The text, and the path of keys to where the reader stands.
struct Context<'t> {
    text: &'t str,
    path: String,
}

impl Context<'_> {
    fn below(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}

type Entry<'d> = (&'d str, std::ops::Range<usize>, &'d Spanned<DeValue<'d>>);

/// The entries in the order of the file, which the tree does not keep.
fn sorted<'d>(table: &'d DeTable<'d>) -> std::vec::IntoIter<Entry<'d>> {
    let mut entries: Vec<Entry<'d>> =
        table.iter().map(|(key, value)| (key.get_ref().as_ref(), key.span(), value)).collect();
    entries.sort_by_key(|(_, span, _)| span.start);
    entries.into_iter()
}

/// A table as a map.
struct Table<'d, 'c> {
    entries: std::vec::IntoIter<Entry<'d>>,
    context: &'c Context<'c>,
}

impl<'de> Deserializer<'de> for Table<'_, '_> {
    type Error = Trouble;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Trouble> {
        visitor.visit_map(Entries { remaining: self.entries, value: None, context: self.context })
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}
struct Entries<'d, 'c> {
    remaining: std::vec::IntoIter<Entry<'d>>,
    value: Option<(&'d str, &'d Spanned<DeValue<'d>>)>,
    context: &'c Context<'c>,
}

impl<'de> de::MapAccess<'de> for Entries<'_, '_> {
    type Error = Trouble;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Trouble> {
        let Some((key, span, value)) = self.remaining.next() else { return Ok(None) };
        self.value = Some((key, value));
        let read = seed.deserialize(IntoDeserializer::<Trouble>::into_deserializer(key));
        read.map(Some)
            .map_err(|t| Trouble::Located(Box::new(t.at(self.context, key.to_owned(), span))))
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Trouble> {
        let (key, value) = self.value.take().expect("serde asks for a value after its key");
        let context = Context { text: self.context.text, path: self.context.below(key) };
        seed.deserialize(Value { value, context: &context })
    }
}

/// A value of any type.
struct Value<'d, 'c> {
    value: &'d Spanned<DeValue<'d>>,
    context: &'c Context<'c>,
}

impl Value<'_, '_> {
    fn locate<T>(&self, read: Result<T, Trouble>) -> Result<T, Trouble> {
        read.map_err(|trouble| {
            let span = self.value.span();
            let found = shown(self.context.text, self.value.get_ref(), span.clone());
            Trouble::Located(Box::new(trouble.at(self.context, found, span)))
        })
    }
}

impl<'de> Deserializer<'de> for Value<'_, '_> {
    type Error = Trouble;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Trouble> {
        let context = self.context;
        let read = match self.value.get_ref() {
            DeValue::String(text) => visitor.visit_str(text),
            DeValue::Integer(number) => {
                match i64::from_str_radix(number.as_str(), number.radix()) {
                    Ok(number) => visitor.visit_i64(number),
                    Err(_) => Err(Trouble::Type("a whole number of at most 63 bits".to_owned())),
                }
            }
            DeValue::Float(number) => match number.as_str().parse() {
                Ok(number) => visitor.visit_f64(number),
                Err(_) => Err(Trouble::Type("a number".to_owned())),
            },
            DeValue::Boolean(whether) => visitor.visit_bool(*whether),
            DeValue::Datetime(_) => {
                Err(de::Error::invalid_type(Unexpected::Other("a date"), &visitor))
            }
            DeValue::Array(list) => {
                let mut items = list.iter().map(|value| Value { value, context });
                visitor.visit_seq(Items(&mut items))
            }
            DeValue::Table(table) => {
                Table { entries: sorted(table), context }.deserialize_any(visitor)
            }
        };
        self.locate(read)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Trouble> {
        visitor.visit_some(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Trouble> {
        let read = match self.value.get_ref().as_str() {
            Some(word) => visitor.visit_enum(IntoDeserializer::<Trouble>::into_deserializer(word)),
            None => Err(de::Error::unknown_variant("", words)),
        };
        self.locate(read)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

/// The items of a list.
struct Items<'i, 'd, 'c>(&'i mut dyn Iterator<Item = Value<'d, 'c>>);

impl<'de> de::SeqAccess<'de> for Items<'_, '_, '_> {
    type Error = Trouble;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Trouble> {
        self.0.next().map(|value| seed.deserialize(value)).transpose()
    }
}
