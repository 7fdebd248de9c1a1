//! Recordings with their columns and units, and what looks wrong with these.

use maud::{Markup, html};

use super::columns::{columns, completion, period, simulated, unit_lists};
use crate::first_drive::held;
use crate::page::bench::State;
use crate::page::plain::plain;
use crate::page::recordings::Taken;
use crate::page::unit_fix::UnitFix;
use crate::report::words::given;

/// Recordings with their columns, and the drive.
pub(super) fn data(state: &State) -> Markup {
    html! {
        @if let Some(drive) = &state.drive {
            p { "Model to begin with: " code { (drive.name) }
                @if !drive.drive.name.is_empty() { " (" (drive.drive.name) ")" } }
        }
        @for fix in &state.fixes { (offer(fix, &state.recordings)) }
        @for (number, taken) in state.recordings.iter().enumerate() {
            (recording(number, taken, state.steps.is_empty()))
        }
        @if state.recordings.iter().any(|it| it.preview.is_some()) { (unit_lists()) }
        @if state.recordings.len() > 1 && state.recordings.iter().any(|it| it.incomplete.is_some()) {
            p.note { "The analysis begins when every recording is complete." }
        }
        @if let Some(gathered) = &state.gathered {
            p.note { (plain(&gathered.split)) }
            @for remark in gathered.remarks() { p.note { (plain(&remark)) } }
            @for doubt in &gathered.doubts { p.note.alert { (plain(doubt)) } }
        }
    }
}

/// What looks wrong, and the click that corrects it.
fn offer(fix: &UnitFix, recordings: &[Taken]) -> Markup {
    let name = recordings.get(fix.recording).map_or("", |it| &it.name);
    html! {
        div.offer role="alert" {
            p { strong { (name) ": " (fix.column) " looks like " (fix.unit) "." } " " (fix.words) }
            button type="button" data-do="column" data-recording=(fix.recording)
                data-column=(fix.column) data-signal=(fix.signal) data-unit=(fix.unit) {
                "Take " (fix.column) " as " (fix.unit)
            }
        }
    }
}

/// A recording; `searching` while nothing is known but its columns.
fn recording(number: usize, taken: &Taken, searching: bool) -> Markup {
    let report = taken.report.as_ref();
    let doubtful = report.is_some_and(|it| !it.guesses().is_empty() || !it.suspicions.is_empty());
    let open = !taken.is_made() && (taken.incomplete.is_some() || doubtful || searching);
    html! {
        @if let Some(incomplete) = &taken.incomplete { (completion(number, taken, incomplete)) }
        details.recording open[open] {
            summary { strong { (taken.name) } " " (extent(taken)) }
            @match (&taken.preview, &taken.recording) {
                (Some(preview), _) => { (columns(number, taken, preview)) }
                (None, Some(recording)) => { (simulated(recording)) }
                (None, None) => {}
            }
            @if let Some(report) = report {
                @for note in report.notes.iter().chain(&held(&report.constants)).chain(&report.warnings()) {
                    p.note.alert { (plain(note)) }
                }
                (sampling(number, taken))
            }
            @if let Some(kept) = &taken.kept { p.note { (plain(kept)) } }
            @if !taken.options.columns.is_empty() || taken.options.rows_every.is_some() {
                button type="button" data-do="again" data-recording=(number) { "Guess its columns again" } " "
            }
            button type="button" data-do="remove" data-recording=(number) { "Remove " (taken.name) }
        }
    }
}

/// How long it is.
fn extent(taken: &Taken) -> Markup {
    html! {
        @match (&taken.recording, &taken.preview) {
            (Some(recording), _) => {
                (recording.len()) " samples every " (given(recording.period_s * 1e3)) " ms, "
                (given(recording.len() as f64 * recording.period_s)) " s"
            }
            (None, Some(preview)) => { (preview.rows) " rows, " (preview.columns.len()) " columns" }
            (None, None) => {}
        }
    }
}

/// Asks for another sampling time.
fn sampling(number: usize, taken: &Taken) -> Markup {
    let period_s = taken.recording.as_ref().map_or(0.0, |it| it.period_s);
    let rounded = format!("{:.5e}", period_s * 1e3).parse().unwrap_or(period_s * 1e3);
    html! {
        (period(number, "resample", "Sample it every", "Resample", rounded))
        @if taken.options.resample.is_some() {
            button type="button" data-do="resample" data-recording=(number) { "As it was sampled" } " "
        }
    }
}
