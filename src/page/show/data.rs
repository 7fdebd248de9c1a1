//! Recordings with their columns and units, and what looks wrong with these.

use drivescope_recording::{ColumnNote, Taken as How, Unit};
use maud::{Markup, html};

use crate::page::bench::State;
use crate::page::recordings::{Taken, UnitFix, units_like};
use crate::report::words::given;

/// Signals that a column may be taken as.
const SIGNALS: [&str; 10] = ["time", "u", "i", "omega", "theta", "v", "x", "T_l", "reference", "T"];

/// Recordings with their columns, and the drive.
pub(super) fn data(state: &State) -> Markup {
    html! {
        @if let Some(drive) = &state.drive {
            p { "Model to begin with: " code { (drive.name) }
                @if !drive.drive.name.is_empty() { " (" (drive.drive.name) ")" } }
        }
        @for fix in &state.fixes { (offer(fix, &state.recordings)) }
        @for (number, taken) in state.recordings.iter().enumerate() { (recording(number, taken)) }
        @if let Some(gathered) = &state.gathered {
            p.note { (gathered.split) }
            @for doubt in &gathered.doubts { p.note.alert { (doubt) } }
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

fn recording(number: usize, taken: &Taken) -> Markup {
    let length = taken.recording.len();
    let period = taken.recording.period_s;
    html! {
        details.recording open[taken.report.as_ref().is_some_and(|it| !it.guesses().is_empty() || !it.suspicions.is_empty())] {
            summary {
                strong { (taken.name) } " "
                (length) " samples every " (given(period * 1e3)) " ms, "
                (given(length as f64 * period)) " s"
            }
            @match &taken.report {
                None => {
                    p.note { "Simulated, with the noise of its sensors: "
                        (taken.recording.signals.iter().map(|it| it.header()).collect::<Vec<_>>().join(", ")) "." }
                }
                Some(report) => {
                    (columns(number, &report.columns))
                    @for warning in report.warnings() { p.note.alert { (warning) } }
                }
            }
            button type="button" data-do="remove" data-recording=(number) { "Remove " (taken.name) }
        }
    }
}

/// Columns with what they are taken as, to be corrected.
fn columns(recording: usize, notes: &[ColumnNote]) -> Markup {
    html! {
        div.scroll role="region" tabindex="0" aria-label="Columns" {
            table.columns {
                thead { tr {
                    th.name scope="col" { "Column" } th.name scope="col" { "is the signal" }
                    th.name scope="col" { "in" } th.name scope="col" { "How it is known" }
                } }
                tbody { @for note in notes { (column(recording, note)) } }
            }
        }
    }
}

fn column(recording: usize, note: &ColumnNote) -> Markup {
    let unit = note.given_unit.as_deref().unwrap_or(&note.unit);
    let units = units_like(&note.unit);
    let how = match note.taken {
        How::Named if note.given_unit.is_none() => "named, its unit assumed",
        How::Named => "named in the file",
        How::Mapped => "set by you",
        How::Guessed => "a guess by its name",
        How::Kept => "not known, kept as it is",
    };
    let same = |other: &str| {
        units_like(other).contains(&unit) && other == unit
            || Unit::parse(other) == Unit::parse(unit)
    };
    html! {
        tr data-recording=(recording) data-column=(note.column) {
            th scope="row" { (note.column) }
            td.name {
                select.signal aria-label={ "signal of column " (note.column) } {
                    @if !SIGNALS.contains(&note.signal.as_str()) {
                        option value=(note.signal) selected { (note.signal) }
                    }
                    @for signal in SIGNALS {
                        option value=(signal) selected[signal == note.signal] { (signal) }
                    }
                }
            }
            td.name {
                select.unit aria-label={ "unit of column " (note.column) } {
                    @if !units.iter().any(|it| same(it)) { option value=(unit) selected { (unit) } }
                    @for one in &units { option value=(one) selected[same(one)] { (one) } }
                }
                @if note.converted { span.note { " \u{2192} " (note.unit) } }
            }
            td.name { (how) }
        }
    }
}
