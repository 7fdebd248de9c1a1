//! What `compare` answers.

use std::collections::BTreeMap;

use drivescope_discovery::compare::{Comparison, Curve, Finding, RecordingComparison, Span};
use drivescope_discovery::signals::SignalFinding;
use serde::Serialize;
use serde_json::Value;

use super::{Setting, blocks, verdict};
use crate::answer::block::Block;
use crate::answer::unusable;

#[derive(Debug, Serialize)]
struct Before {
    error: f64,
    validation_error: Option<f64>,
}

/// A span with its recording.
#[derive(Debug, Serialize)]
struct SpanOf<'a> {
    recording: &'a str,
    #[serde(flatten)]
    span: &'a Span,
}

/// The answer of `compare`.
#[derive(Debug, Serialize)]
pub(crate) struct CompareAnswer<'a> {
    drive: &'a str,
    /// What is wrong with the signals of the recordings.
    signals: &'a [SignalFinding],
    observer_hz: f64,
    noise_floor: f64,
    before: Before,
    error_if_fitted: f64,
    by_parameters: f64,
    fitted: bool,
    /// Whether its values are as good as those of least squares on the balances.
    by_balances: bool,
    /// By output, of the first recording, and `source`; each recording has its own below.
    noise: BTreeMap<&'a str, Value>,
    verdict: String,
    #[serde(rename = "where")]
    findings: &'a [Finding],
    tested: usize,
    block_s: f64,
    spans: Vec<SpanOf<'a>>,
    recordings: &'a [RecordingComparison],
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_force_error: Option<f64>,
    curves: &'a [Curve],
    doubts: &'a [String],
    seed: u64,
    #[serde(skip)]
    compared: &'a Comparison,
    #[serde(skip)]
    setting: &'a Setting,
}

impl<'a> CompareAnswer<'a> {
    pub(crate) fn new(
        compared: &'a Comparison,
        setting: &'a Setting,
        signals: &'a [SignalFinding],
        relative_force_error: Option<f64>,
    ) -> Self {
        let mut noise: BTreeMap<&str, Value> = BTreeMap::new();
        for it in &setting.noise {
            noise.insert(it.name, Value::from(it.sd));
            noise.insert("source", serde_json::to_value(it.source).unwrap_or_default());
        }
        let spans = compared
            .recordings
            .iter()
            .flat_map(|it| it.spans.iter().map(|span| SpanOf { recording: &it.name, span }));
        Self {
            drive: &setting.drive,
            signals,
            observer_hz: compared.observer_hz,
            noise_floor: compared.floor,
            before: Before { error: compared.error, validation_error: setting.validation_error },
            error_if_fitted: compared.error_if_fitted,
            by_parameters: compared.by_parameters,
            fitted: !compared.is_unfitted(),
            by_balances: compared.by_balances,
            noise,
            verdict: verdict(compared),
            findings: &compared.findings,
            tested: compared.tested,
            block_s: compared.block_s,
            spans: spans.collect(),
            recordings: &compared.recordings,
            relative_force_error,
            curves: &compared.curves,
            doubts: &setting.doubts,
            seed: setting.seed,
            compared,
            setting,
        }
    }

    /// The answer in blocks.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        let mut all = unusable(self.signals);
        all.extend(blocks(self.compared, self.setting));
        all
    }
}
