//! What a diagnosis says.

use std::path::PathBuf;

use drivescope_diagnoser::{Answer as Class, KnownFaults, Named};
use drivescope_recording::rounded;
use drivescope_scenarios::results::{Method, SizeGroup};
use serde::Serialize;

use crate::report::words::{number, percent};

#[derive(Debug, Serialize)]
pub(super) struct Answer {
    pub(super) diagnoser: PathBuf,
    pub(super) recording: String,
    pub(super) samples: usize,
    pub(super) run_up: usize,
    pub(super) verdict: &'static str,
    pub(super) method: Method,
    /// The fault of the declaration that stood longest; none where no fault is known by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fault: Option<Fault>,
    pub(super) methods: Vec<Found>,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct Found {
    pub(super) method: Method,
    /// None for a method that knows no such level.
    pub(super) beta: Option<f64>,
    pub(super) outside: usize,
    /// None if nothing was judged.
    pub(super) exceedance_rate: Option<f64>,
    pub(super) declared: Vec<Declared>,
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

impl Fault {
    /// What the symptoms of a standing fault came to.
    pub(super) fn new(known: &KnownFaults, named: &Named) -> Self {
        let unknown = named.shares.len() - 1;
        let (class, place) = match named.answer {
            Class::Class(class) => (known.class(class).join(" | "), class),
            Class::Unknown => ("unknown".to_owned(), unknown),
        };
        let Named { samples, size, group, .. } = *named;
        Self { class, samples, share: named.shares[place], s: size, group: group.into() }
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
        let judged = self.samples - self.run_up;
        let mut text =
            format!("{}: {} samples, of which {judged} are judged\n", self.recording, self.samples);
        for Found { method, beta, outside, declared, .. } in &self.methods {
            let share = 100.0 * *outside as f64 / judged as f64;
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
            text += &format!("{}: {share:.2} % outside{designed}, {declared}\n", method.label());
        }
        if let Some(fault) = &self.fault {
            text += &format!("fault: {}\n", fault.text());
        }
        text + &format!("verdict ({}): {}\n", self.method.label(), self.verdict)
    }
}
