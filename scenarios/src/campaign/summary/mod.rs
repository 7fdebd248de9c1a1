//! What a campaign found: detection against size, delays, false alarms, what it depends on, and the
//! worst scenarios.
//!
//! Shares come with Wilson's 95 % intervals. Shares and false alarms count every scenario; quantiles
//! and sensitivities rest on every n-th where there are more than half a million.

mod detection;
mod gather;
mod naming;
mod sensitivity;
mod table;
mod worst;

use serde::Serialize;

use super::parts::{FolderError, Part};
use crate::shares::{Share, Spread};
pub use detection::{KindRow, SizeRow};
use gather::{Gathered, Judged};
use naming::Names;
pub use naming::{Count, NamedKind, Naming};
pub use sensitivity::Sensitivity;
pub use worst::Worst;

/// What a campaign found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// SHA-256 of what it ran with: see [`crate::campaign::Plan`].
    pub plan_digest: String,
    /// Version of the program that made it.
    pub version: String,
    /// Scenarios that are there, and those of the plan.
    pub scenarios: u64,
    /// Scenarios of the plan.
    pub planned: u64,
    /// Those without any fault.
    pub healthy: u64,
    /// Those whose state grew without bound, the first of them by number.
    pub not_finite: Vec<u64>,
    /// Those that ended the process that ran them, the first of them by number.
    pub aborted: Vec<u64>,
    /// Every n-th scenario entered quantiles and sensitivities.
    pub every: u64,
    /// What each method found.
    pub methods: Vec<MethodSummary>,
}

/// What a method found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodSummary {
    /// Its name in the columns.
    pub method: String,
    /// Faulty scenarios in which the fault was declared.
    pub detected: Share,
    /// The same by what failed.
    pub kinds: Vec<KindRow>,
    /// Declarations before a fault, or without one.
    pub false_alarms: u64,
    /// Judged time before faults, or without one, h.
    pub healthy_hours: f64,
    /// Scenarios without a false alarm.
    pub silent: Share,
    /// Share of healthy samples outside, r_fd.
    pub outside_healthy: Spread,
    /// What it named, if it names faults.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub naming: Option<Naming>,
    /// What its findings depend on.
    pub sensitivity: Vec<Sensitivity>,
    /// Scenarios that are worth a look.
    pub worst: Vec<Worst>,
}

impl MethodSummary {
    /// Mean time between false alarms, h; infinite where there was none.
    pub fn hours_between(&self) -> f64 {
        self.healthy_hours / self.false_alarms as f64
    }
}

/// Sums up the scenarios of those parts.
///
/// # Errors
/// A part that is damaged.
pub fn summarise(parts: &[Part]) -> Result<Summary, FolderError> {
    let planned = parts.first().map_or(0, Part::scenarios);
    let mut gathered = Gathered::new(planned);
    for part in parts {
        part.rows(&mut |rows| {
            gathered.take(&rows);
            Ok(())
        })?;
    }
    let of = |value: fn(&Part) -> &str| parts.first().map_or("", value).to_owned();
    let method = |(number, name): (usize, &String)| method(&gathered, number, name);
    Ok(Summary {
        plan_digest: of(Part::plan_digest),
        version: of(Part::version),
        scenarios: gathered.scenarios,
        planned,
        healthy: gathered.healthy,
        not_finite: gathered.not_finite.clone(),
        aborted: gathered.aborted.clone(),
        every: gathered.every,
        methods: gathered.methods.iter().enumerate().map(method).collect(),
    })
}

fn method(gathered: &Gathered, number: usize, name: &str) -> MethodSummary {
    let counts = &gathered.counts[number];
    let judged = || gathered.kept.iter().map(move |row| (row, &row.methods[number]));
    MethodSummary {
        method: name.to_owned(),
        detected: Share::new(counts.detected, counts.faulty),
        kinds: detection::kinds(gathered, number),
        false_alarms: counts.false_alarms,
        healthy_hours: counts.healthy_s / 3600.0,
        silent: Share::new(counts.silent, counts.judged),
        outside_healthy: Spread::of(
            judged()
                .map(|(_, found): (_, &Judged)| found.outside_healthy)
                .filter(|it| it.is_finite()),
        ),
        naming: gathered.names[number].as_ref().map(Names::summary),
        sensitivity: sensitivity::sensitivity(gathered, number),
        worst: worst::worst(gathered, number),
    }
}
