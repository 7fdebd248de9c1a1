//! What a TDMS file is made of: itself, groups and channels, each with properties.

use std::collections::BTreeMap;

use super::values::Type;

/// The file, a group or a channel: a path of no, one or two names.
#[derive(Debug, Default)]
pub(super) struct Object {
    pub(super) path: Vec<String>,
    pub(super) properties: BTreeMap<String, Property>,
    pub(super) stored: Option<Type>,
    pub(super) values: Vec<f64>,
    /// Values in a chunk, and their bytes where these differ from one to the next.
    pub(super) chunk: (u64, Option<u64>),
}

/// A property's value.
#[derive(Debug)]
pub(super) enum Property {
    Number(f64),
    Text(String),
    Other,
}

impl Object {
    pub(super) fn property(&self, name: &str) -> Option<&Property> {
        self.properties.get(name)
    }

    /// What a channel holds that is not numbers.
    pub(super) fn no_numbers(&self) -> Option<&'static str> {
        self.stored.and_then(Type::no_number)
    }

    pub(super) fn in_seconds(&self) -> bool {
        self.stored == Some(Type::TimeStamp)
    }

    /// Bytes of its part of a chunk.
    pub(super) fn chunk_bytes(&self) -> u64 {
        let (count, bytes) = self.chunk;
        let size = self.stored.map_or(0, Type::size) as u64;
        bytes.unwrap_or_else(|| count.saturating_mul(size))
    }
}

/// The names in a path such as `/'bench'/'it''s'`.
pub(super) fn names(path: &str) -> Vec<String> {
    let (mut names, mut name, mut inside) = (Vec::new(), String::new(), false);
    let mut letters = path.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '\'' if inside && letters.peek() == Some(&'\'') => {
                letters.next();
                name.push('\'');
            }
            '\'' => {
                inside = !inside;
                if !inside {
                    names.push(std::mem::take(&mut name));
                }
            }
            letter if inside => name.push(letter),
            _ => {}
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_have_no_one_or_two_names() {
        assert!(names("/").is_empty());
        assert_eq!(names("/'bench'"), ["bench"]);
        assert_eq!(names("/'it''s/here'/'u'"), ["it's/here", "u"]);
    }
}
