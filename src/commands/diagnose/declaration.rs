//! A declared fault: since when, until when, what and how large.

use serde::Serialize;

use crate::report::words::number;

/// Mechanism of a declaration that nothing known explains.
pub(super) const UNKNOWN: &str = "unknown";

/// A fault as it stands in the answer and in the lines of a live run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Declaration {
    /// Time of its first sample, s.
    pub(super) from: f64,
    /// Time of its last sample, s; none while it stands.
    pub(super) to: Option<f64>,
    /// Time at which it was noticed, s.
    pub(super) noticed: f64,
    /// Samples from the start of the recording until then, that one included.
    #[serde(skip)]
    pub(super) sample: usize,
    /// What failed, or `unknown`.
    pub(super) mechanism: String,
    /// Everything that it may be: the mechanism and those that it cannot be told from.
    pub(super) set: Vec<String>,
    /// Size in `unit`; none where nothing is named, or the method tells no size.
    pub(super) size: Option<f64>,
    /// Its 95 % interval.
    pub(super) interval: Option<[f64; 2]>,
    /// Unit of the size, `1` for a fraction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) unit: Option<String>,
    /// Change of the size a second, where it grows, and its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) growth: Option<[f64; 2]>,
}

impl Declaration {
    /// A fault of which nothing but its begin is known.
    pub(super) fn unknown(from: f64, noticed: f64) -> Self {
        Self {
            from,
            to: None,
            noticed,
            sample: 0,
            mechanism: UNKNOWN.to_owned(),
            set: Vec::new(),
            size: None,
            interval: None,
            unit: None,
            growth: None,
        }
    }

    /// What it is, in words.
    pub(super) fn what(&self) -> String {
        let mut text = self.mechanism.clone();
        if let (Some(size), Some([low, high])) = (self.size, self.interval) {
            let (per, unit) = match self.unit.as_deref() {
                Some("1") | None => (100.0, "%"),
                Some(unit) => (1.0, unit),
            };
            let signed = |x: f64| {
                let x = number(per * x);
                if x.starts_with('-') { x } else { format!("+{x}") }
            };
            text += &format!(" {} {unit} ({} to {})", signed(size), signed(low), signed(high));
            if let Some([rate, _]) = self.growth {
                text += &format!(", growing by {} {unit} a second", number(per * rate));
            }
        }
        let others: Vec<&str> =
            self.set.iter().map(String::as_str).filter(|it| **it != self.mechanism).collect();
        if !others.is_empty() {
            text += &format!("; it cannot be told from {}", others.join(", "));
        }
        text
    }

    /// One line of it.
    pub(super) fn text(&self) -> String {
        let until = self.to.map_or_else(|| "the end".to_owned(), |to| format!("{to:.3} s"));
        format!("{:.3} s to {until}: {}", self.from, self.what())
    }
}
