//! The rows of a part, by their columns.

use drivescope_recording::dataset::{Column, Values};

/// Rows by the names of their columns.
pub(super) struct Table<'a>(&'a [Column]);

impl<'a> Table<'a> {
    pub(super) fn of(columns: &'a [Column]) -> Self {
        Self(columns)
    }

    pub(super) fn column(&self, name: &str) -> Option<&Column> {
        self.0.iter().find(|column| column.name == name)
    }

    pub(super) fn text(&self, name: &str, k: usize) -> &str {
        match self.column(name).map(|column| &column.values) {
            Some(Values::Texts(values)) => &values[k],
            _ => "",
        }
    }

    pub(super) fn number(&self, name: &str, k: usize) -> f64 {
        match self.column(name).map(|column| &column.values) {
            Some(Values::Numbers(values)) => values[k],
            Some(Values::Integers(values)) => values[k] as f64,
            _ => f64::NAN,
        }
    }

    pub(super) fn flag(&self, name: &str, k: usize) -> Option<bool> {
        match self.column(name).map(|column| &column.values) {
            Some(Values::Flags(values)) => values[k],
            _ => None,
        }
    }

    /// What fails; several together are joined.
    pub(super) fn kind(&self, k: usize) -> Option<String> {
        let kinds = self.0.iter().filter(|column| column.name.ends_with("_kind"));
        let words: Vec<&str> = kinds
            .filter_map(|column| match &column.values {
                Values::Texts(values) => Some(values[k].as_str()).filter(|word| *word != "none"),
                _ => None,
            })
            .collect();
        (!words.is_empty()).then(|| words.join(" + "))
    }
}
