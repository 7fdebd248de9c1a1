//! Scenarios that are worth a look.

use serde::Serialize;

use super::gather::{Gathered, Kept};

/// How many of each kind.
const EACH: usize = 3;

/// A scenario in which a method did badly.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worst {
    /// Its number.
    pub scenario: u64,
    /// `missed`, `late` or `false_alarms`.
    pub what: &'static str,
    /// What failed; nothing for health.
    pub kind: Option<String>,
    /// Magnitude of the fault.
    pub size: Option<f64>,
    /// Delay, s, or false alarms.
    pub value: Option<f64>,
}

/// The greatest faults that were missed, kind by kind; the latest declarations; the most false alarms.
pub(super) fn worst(gathered: &Gathered, method: usize) -> Vec<Worst> {
    let found = |row: &Kept| row.methods[method];
    let told = |row: &Kept, what, value: Option<f64>| Worst {
        scenario: row.scenario,
        what,
        kind: row.kind.map(|kind| gathered.kinds[kind].clone()),
        size: Some(row.size).filter(|it| it.is_finite()),
        value,
    };
    let mut worst = Vec::new();
    for kind in 0..gathered.kinds.len() {
        let of_kind = gathered.kept.iter().filter(|row| row.kind == Some(kind));
        let missed = of_kind.filter(|row| found(row).detected == Some(false));
        let largest = missed.max_by(|a, b| a.size.total_cmp(&b.size));
        worst.extend(largest.map(|row| told(row, "missed", None)));
    }
    worst.sort_by(|a, b| b.size.unwrap_or(0.0).total_cmp(&a.size.unwrap_or(0.0)));
    let mut late: Vec<&Kept> =
        gathered.kept.iter().filter(|row| found(row).delay_s.is_finite()).collect();
    late.sort_by(|a, b| found(b).delay_s.total_cmp(&found(a).delay_s));
    worst.extend(late.iter().take(EACH).map(|row| told(row, "late", Some(found(row).delay_s))));
    let mut noisy: Vec<&Kept> =
        gathered.kept.iter().filter(|row| found(row).false_alarms > 0.0).collect();
    noisy.sort_by(|a, b| found(b).false_alarms.total_cmp(&found(a).false_alarms));
    let alarms = |row: &&Kept| told(row, "false_alarms", Some(found(row).false_alarms));
    worst.extend(noisy.iter().take(EACH).map(alarms));
    worst
}
