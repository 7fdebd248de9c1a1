//! The files among an FMU's resources.

use std::path::Path;

use drivescope_recording::{Break, Recording, Signal};
use serde::{Deserialize, Serialize};

use super::error::DiagnoserError;
use super::files::BASELINE_FILE;

/// A recording as TOML: numbers come back to the bit, and no reader of recordings is needed.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    name: String,
    start_s: f64,
    period_s: f64,
    /// First samples and start times of further segments.
    breaks: Vec<(usize, f64)>,
    signals: Vec<StoredSignal>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSignal {
    name: String,
    unit: String,
    values: Vec<f64>,
}

/// The text of a baseline, with those signals alone.
///
/// # Errors
/// A recording that TOML does not hold.
pub fn baseline_text(recording: &Recording, names: &[&str]) -> Result<String, toml::ser::Error> {
    let kept = recording.signals.iter().filter(|signal| names.contains(&&*signal.name));
    let signals = kept.map(|Signal { name, unit, values }| StoredSignal {
        name: name.clone(),
        unit: unit.clone(),
        values: values.clone(),
    });
    toml::to_string(&Stored {
        name: recording.name.clone(),
        start_s: recording.start_s,
        period_s: recording.period_s,
        breaks: recording.breaks.iter().map(|it| (it.at, it.start_s)).collect(),
        signals: signals.collect(),
    })
}

/// The baseline among the resources, if there is one.
pub(super) fn read_baseline(resources: &Path) -> Result<Option<Recording>, DiagnoserError> {
    let path = resources.join(BASELINE_FILE);
    if !path.exists() {
        return Ok(None);
    }
    let wrong = |what: String| DiagnoserError::Baseline { path: path.clone(), what };
    let text = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
    let stored: Stored = toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let Stored { name, start_s, period_s, breaks, signals } = stored;
    let signals = signals
        .into_iter()
        .map(|StoredSignal { name, unit, values }| Signal { name, unit, values })
        .collect();
    let mut recording = Recording::new(name, start_s, period_s, signals);
    recording.check().map_err(|error| wrong(error.to_string()))?;
    let breaks = breaks.into_iter().map(|(at, start_s)| Break { at, start_s });
    recording.breaks = breaks.filter(|it| it.at < recording.len()).collect();
    Ok(Some(recording))
}
