//! `campaign PLAN --only K`: one scenario again, its row in words, and its signals.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use drivescope_recording::dataset::{Column, Values};
use drivescope_scenarios::campaign::{Campaign, Design, Plan};

use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::output;
use crate::session::Session;

/// Runs that scenario alone.
///
/// # Errors
/// No detectors, or a recording that cannot be written.
pub(super) fn only(
    plan: Plan,
    file: &Path,
    scenario: u64,
    recording: Option<PathBuf>,
    session: &Session,
) -> miette::Result<Ending> {
    session.check_writable(&recording.iter().collect::<Vec<_>>())?;
    let design = Design::new(&plan).map_err(into_report)?;
    let campaign = Campaign::new(plan, design);
    let rows = campaign
        .run(scenario..scenario + 1, &|_| false)
        .unwrap_or_else(|| campaign.aborted(scenario));
    let mut text = String::new();
    let mut json = BTreeMap::new();
    for column in &rows.columns {
        let (said, value) = told_value(column);
        let _ = writeln!(text, "{:<24} {said}", column.name);
        json.insert(column.name.clone(), value);
    }
    let next = match &recording {
        Some(path) => {
            output::write_recording(path, &campaign.trace(scenario).map_err(into_report)?)?;
            Next::new("serve").with(path.display())
        }
        None => Next::new("campaign").with(file.display()).options(&format!(
            " --only {scenario} -o {}",
            Next::word(&format!("scenario-{scenario}.csv"))
        )),
    };
    session.say(&text, &json, &next)?;
    Ok(Ending::Done)
}

/// The one value of a column, in words and as JSON.
fn told_value(column: &Column) -> (String, serde_json::Value) {
    let unit = match column.unit.as_str() {
        "" | "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let none = || ("-".to_owned(), serde_json::Value::Null);
    match &column.values {
        Values::Integers(values) => {
            values.first().map_or_else(none, |it| (it.to_string(), (*it).into()))
        }
        Values::Numbers(values) => match values.first() {
            Some(it) if it.is_finite() => (format!("{it:.6}{unit}"), (*it).into()),
            _ => none(),
        },
        Values::Flags(values) => match values.first() {
            Some(Some(it)) => (if *it { "yes" } else { "no" }.to_owned(), (*it).into()),
            _ => none(),
        },
        Values::Texts(values) => {
            values.first().map_or_else(none, |it| (it.clone(), it.as_str().into()))
        }
    }
}
