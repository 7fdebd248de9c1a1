//! What a diagnosis says.

use std::collections::BTreeMap;
use std::path::PathBuf;

use drivescope_diagnoser::{Answer as Class, KnownFaults, Named};
use drivescope_recording::rounded;
use drivescope_scenarios::results::SizeGroup;
use serde::Serialize;

use super::declaration::{Declaration, UNKNOWN};
use super::method::Method;
use crate::report::words::{number, percent};

#[derive(Debug, Serialize)]
pub(super) struct Answer {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) diagnoser: Option<PathBuf>,
    pub(super) recording: String,
    pub(super) samples: usize,
    pub(super) run_up: usize,
    /// Samples at operating points that the detectors of the residual were not designed on.
    pub(super) beyond_range: usize,
    /// `healthy`, `fault`, `abnormal` or `not_judged`, by the method that was asked for.
    pub(super) verdict: &'static str,
    /// Why nothing was judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) why: Option<String>,
    pub(super) method: Method,
    pub(super) declarations: Vec<Declaration>,
    /// Share of judged values outside; none if nothing was judged.
    pub(super) share_outside: Option<f64>,
    /// The fault of the declaration that stood longest; none where no fault is known by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fault: Option<Fault>,
    /// Where the machine was learned from, and what it differs by from the drive, as fractions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) baseline: Option<BaselineAnswer>,
    pub(super) methods: Vec<Found>,
}

/// What a bank learned of the machine.
#[derive(Debug, Serialize)]
pub(super) struct BaselineAnswer {
    pub(super) recording: String,
    /// Samples of it.
    pub(super) samples: usize,
    pub(super) machine: BTreeMap<String, f64>,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct Found {
    pub(super) method: Method,
    pub(super) verdict: &'static str,
    /// None for a method that knows no such level.
    pub(super) beta: Option<f64>,
    pub(super) judged: usize,
    pub(super) outside: usize,
    /// None if nothing was judged.
    pub(super) exceedance_rate: Option<f64>,
    pub(super) declared: Vec<Declared>,
    pub(super) declarations: Vec<Declaration>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Declared {
    /// Samples from the start of the recording, the one that completes the window included.
    pub(super) sample: usize,
    /// Its time, s.
    pub(super) time: f64,
    /// What was declared, where faults are known by name and the method is the one asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fault: Option<Fault>,
}

/// A fault by its name and size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Fault {
    /// The known faults that it may be, or `unknown`.
    pub(super) class: String,
    /// Samples at which it stood declared.
    pub(super) samples: usize,
    /// Share of these samples that were answered so.
    pub(super) share: f64,
    /// Its size (27).
    #[serde(rename = "S")]
    pub(super) s: f64,
    /// Its size relative to the known faults.
    pub(super) group: SizeGroup,
}

/// Between the faults of a class.
const BETWEEN: &str = " | ";

impl Fault {
    /// What the symptoms of a standing fault came to.
    pub(super) fn new(known: &KnownFaults, named: &Named) -> Self {
        let unknown = named.shares.len() - 1;
        let (class, place) = match named.answer {
            Class::Class(class) => (known.class(class).join(BETWEEN), class),
            Class::Unknown => (UNKNOWN.to_owned(), unknown),
        };
        let Named { samples, size, group, .. } = *named;
        Self { class, samples, share: named.shares[place], s: size, group: group.into() }
    }

    /// The known faults that it may be.
    pub(super) fn names(&self) -> Vec<String> {
        let known = (self.class != UNKNOWN).then(|| self.class.split(BETWEEN));
        known.into_iter().flatten().map(str::to_owned).collect()
    }

    /// One line of it.
    pub(super) fn text(&self) -> String {
        format!(
            "{} ({} % of {} samples), size S = {} thresholds, {} among the known faults",
            self.class,
            percent(self.share, 0),
            self.samples,
            number(self.s),
            self.group.label()
        )
    }
}

impl Answer {
    /// As text for a person.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}: {} samples\n", self.recording, self.samples);
        if let Some(BaselineAnswer { recording, samples, machine }) = &self.baseline {
            let differs: Vec<String> =
                machine.iter().map(|(name, by)| format!("{name} {:+.1} %", 100.0 * by)).collect();
            text += &format!(
                "machine learned from {samples} samples of {recording}: {}\n",
                differs.join(", ")
            );
        }
        if self.beyond_range > 0 {
            text += &format!(
                "{} samples at operating points that were never shown: not judged there, but by the \
                 bank\n",
                self.beyond_range
            );
        }
        for Found { method, verdict, beta, judged, outside, declared, .. } in &self.methods {
            let designed = beta.map_or_else(String::new, |beta| {
                format!(" (healthy: {} %)", rounded(100.0 * beta))
            });
            let times: Vec<String> = declared
                .iter()
                .map(|at| format!("{:.3} s (sample {})", at.time, at.sample))
                .collect();
            let declared = match times.is_empty() {
                true => "no fault declared".to_owned(),
                false => format!("declared at {}", times.join(", ")),
            };
            let shares = match judged {
                0 => "not used or nothing to judge".to_owned(),
                _ => format!(
                    "{:.2} % of {judged} outside{designed}",
                    100.0 * *outside as f64 / *judged as f64
                ),
            };
            let verdict = if *verdict == "abnormal" { "; abnormal" } else { "" };
            text += &format!("{}: {shares}, {declared}{verdict}\n", method.label());
        }
        for declaration in self.declarations.iter().filter(|it| it.mechanism != UNKNOWN) {
            text += &format!("fault: {}\n", declaration.text());
        }
        for declaration in self.declarations.iter().filter(|it| it.mechanism == UNKNOWN) {
            text += &format!("no known cause: {}\n", declaration.text());
        }
        if let Some(fault) = &self.fault {
            text += &format!("fault: {}\n", fault.text());
        }
        let why = self.why.as_ref().map_or_else(String::new, |why| format!(": {why}"));
        let verdict = self.verdict.replace('_', " ");
        text + &format!("verdict ({}): {verdict}{why}\n", self.method.label())
    }
}
