//! What a diagnosis says.

use std::collections::BTreeMap;
use std::path::PathBuf;

use drivescope_monitor::{Declaration, Fault, Found, Method, UNKNOWN};
use drivescope_recording::rounded;
use serde::Serialize;

use super::stream::Stream;
use super::words;

/// What a diagnosis says.
#[derive(Debug, Serialize)]
pub(crate) struct Answer {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) diagnoser: Option<PathBuf>,
    pub(crate) recording: String,
    pub(crate) samples: usize,
    /// How the rows of a stream arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stream: Option<Stream>,
    pub(crate) run_up: usize,
    /// Samples at operating points that the detectors of the residual were not designed on.
    pub(crate) beyond_range: usize,
    /// `healthy`, `fault`, `abnormal` or `not_judged`, by the method that was asked for.
    pub(crate) verdict: &'static str,
    /// Why nothing was judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) why: Option<String>,
    pub(crate) method: Method,
    pub(crate) declarations: Vec<Declaration>,
    /// Share of judged values outside; none if nothing was judged.
    pub(crate) share_outside: Option<f64>,
    /// The fault of the declaration that stood longest; none where no fault is known by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fault: Option<Fault>,
    /// Where the machine was learned from, and what it differs by from the drive, as fractions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) baseline: Option<BaselineAnswer>,
    pub(crate) methods: Vec<Found>,
}

/// What a bank learned of the machine.
#[derive(Debug, Serialize)]
pub(crate) struct BaselineAnswer {
    pub(crate) recording: String,
    /// Samples of it.
    pub(crate) samples: usize,
    pub(crate) machine: BTreeMap<String, f64>,
}

impl Answer {
    /// As text for a person.
    pub(crate) fn text(&self) -> String {
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
        for Found { method, verdict, beta, judged, outside, declared, dropped, .. } in &self.methods
        {
            let designed = beta.map_or_else(String::new, |beta| {
                format!(" (healthy: {} %)", rounded(100.0 * beta))
            });
            let times: Vec<String> = declared
                .iter()
                .map(|at| format!("{:.3} s (sample {})", at.time, at.sample))
                .collect();
            let earlier = match dropped {
                0 => String::new(),
                _ => format!(", and {dropped} times before"),
            };
            let declared = match times.is_empty() {
                true => "no fault declared".to_owned(),
                false => format!("declared at {}{earlier}", times.join(", ")),
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
            text += &format!("fault: {}\n", words::line(declaration));
        }
        for declaration in self.declarations.iter().filter(|it| it.mechanism == UNKNOWN) {
            text += &format!("no known cause: {}\n", words::line(declaration));
        }
        if let Some(fault) = &self.fault {
            text += &format!("fault: {}\n", words::fault(fault));
        }
        let why = self.why.as_ref().map_or_else(String::new, |why| format!(": {why}"));
        let verdict = self.verdict.replace('_', " ");
        text + &format!("verdict ({}): {verdict}{why}\n", self.method.label())
    }
}
