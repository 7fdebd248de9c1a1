//! A figure held against what it must reach.

use drivescope_scenarios::parity::Share;
use serde::Serialize;

use crate::report::words::{number, percent};

/// A figure and its bar.
#[derive(Debug, Serialize)]
pub(super) struct Bar {
    what: String,
    value: f64,
    bar: f64,
    met: bool,
}

impl Bar {
    /// The value must be that or more.
    pub(super) fn at_least(what: impl Into<String>, value: f64, bar: f64) -> Self {
        Self { what: what.into(), value, bar, met: value >= bar }
    }

    /// The value must be that or less.
    pub(super) fn at_most(what: impl Into<String>, value: f64, bar: f64) -> Self {
        Self { what: what.into(), value, bar, met: value <= bar }
    }

    /// What, value, bar, and whether it is met.
    pub(super) fn parts(&self) -> (&str, f64, f64, bool) {
        (&self.what, self.value, self.bar, self.met)
    }

    /// A line of it.
    pub(super) fn line(&self) -> String {
        let Self { what, value, bar, met } = self;
        let verdict = if *met { "met" } else { "MISSED" };
        format!("{what}: {} (bar {bar}): {verdict}\n", number(*value))
    }
}

/// `19/20 (76.39-99.11 %)`.
pub(super) fn share(share: &Share) -> String {
    let [low, high] = share.interval;
    format!("{}/{} ({}-{} %)", share.hits, share.of, percent(low, 2), percent(high, 2))
}
