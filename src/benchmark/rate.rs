//! A rate with its interval.

use drivescope_numerics::wilson_95;
use serde::Serialize;

/// A rate with its 95 % interval (Wilson, 1927), and the bar that it is held against.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Rate {
    pub(super) what: String,
    pub(super) hits: usize,
    pub(super) of: usize,
    /// Fraction; absent where there are no cases.
    rate: Option<f64>,
    interval: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bar: Option<Bar>,
}

/// What a rate has to be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Bar {
    /// That or more.
    AtLeast(f64),
    /// That or less.
    AtMost(f64),
}

impl Rate {
    pub(super) fn new(what: &str, hits: usize, of: usize) -> Self {
        let rate = (of > 0).then(|| hits as f64 / of as f64);
        let interval = rate.map(|_| wilson_95(hits, of));
        Self { what: what.to_owned(), hits, of, rate, interval, bar: None }
    }

    pub(super) fn with(self, bar: Bar) -> Self {
        Self { bar: Some(bar), ..self }
    }

    /// Fraction; absent where there are no cases.
    pub(super) fn share(&self) -> Option<f64> {
        self.rate
    }

    /// A line of a table, in per cent.
    pub(super) fn line(&self) -> String {
        let what = &self.what;
        let (Some(p), Some([low, high])) = (self.rate, self.interval) else {
            return format!("  {what:<52}   no case");
        };
        let [p, low, high] = [p, low, high].map(|share| 100.0 * share);
        let bar = match self.bar {
            None => String::new(),
            Some(Bar::AtLeast(bar)) => format!("  (bar: at least {:.0} %)", 100.0 * bar),
            Some(Bar::AtMost(bar)) => format!("  (bar: at most {:.0} %)", 100.0 * bar),
        };
        let count = format!("{} of {}", self.hits, self.of);
        format!("  {what:<52} {p:>6.1} %  [{low:>5.1}, {high:>5.1}]  {count:<12}{bar}")
            .trim_end()
            .to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_rate_interval_and_bar() {
        let line = Rate::new("named right", 9, 10).with(Bar::AtLeast(0.97)).line();
        assert!(line.contains("90.0 %  [ 59.6,  98.2]  9 of 10"), "{line}");
        assert!(line.ends_with("(bar: at least 97 %)"), "{line}");
        assert!(Rate::new("none", 0, 0).line().ends_with("no case"));
    }
}
