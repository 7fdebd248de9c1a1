//! The columns of a recording: what each looks like, what it is, and the values that it makes.

use drivescope_recording::{
    Choice, ColumnNote, ColumnPreview, Preview, Recording, Taken as How, choices, in_words,
};
use maud::{Markup, html};

use super::spark::{range, spark};
use crate::page::incomplete::{Incomplete, Repair};
use crate::page::recordings::Taken;

/// The units of every signal, for the unit boxes of all columns.
pub(super) fn unit_lists() -> Markup {
    html! {
        @for choice in choices() {
            datalist id={ "units-" (choice.signal) } {
                @for unit in choice.units() { option value=(unit) {} }
            }
        }
    }
}

/// What is missing, and the clicks that give it.
pub(super) fn completion(number: usize, taken: &Taken, incomplete: &Incomplete) -> Markup {
    html! {
        div.offer role="alert" {
            p { strong { (taken.name) " is to be completed. " } (incomplete.missing) }
            @for repair in &incomplete.repairs {
                @match repair {
                    Repair::Column { column, signal, unit, words } => {
                        button type="button" data-do="column" data-recording=(number) data-column=(column)
                            data-signal=(signal) data-unit=(unit) { (words) }
                    }
                    Repair::Again => {
                        button type="button" data-do="again" data-recording=(number) {
                            "Forget it and guess again"
                        }
                    }
                }
            }
            @if incomplete.asks_period {
                (period(number, "rows_every", "The rows are sampled every", "Take them so", 1.0))
            }
        }
    }
}

/// Asks for a sampling time.
pub(super) fn period(number: usize, what: &str, words: &str, button: &str, ms: f64) -> Markup {
    html! {
        form.sampling data-recording=(number) data-what=(what) {
            label.line { (words) " "
                input name="ms" type="text" inputmode="decimal" size="6" value=(ms) autocomplete="off";
                " ms" }
            button type="submit" { (button) }
        }
    }
}

/// One row a column.
pub(super) fn columns(number: usize, taken: &Taken, preview: &Preview) -> Markup {
    html! {
        div.scroll role="region" tabindex="0" aria-label={ "Columns of " (taken.name) } {
            table.columns {
                thead { tr {
                    th.name scope="col" { "Column" } th.name scope="col" { "looks like" }
                    th.name scope="col" { "is the" } th.name scope="col" { "in" }
                    th.name scope="col" { "which makes" } th.name scope="col" { "How it is known" }
                } }
                tbody {
                    @for (k, column) in preview.columns.iter().enumerate() {
                        (row(number, taken, column, note(taken, preview, k)))
                    }
                }
            }
        }
    }
}

/// What became of column `k`.
fn note<'a>(taken: &'a Taken, preview: &Preview, k: usize) -> Option<&'a ColumnNote> {
    let name = &preview.columns[k].name;
    let before = preview.columns[..k].iter().filter(|it| it.name == *name).count();
    let notes = taken.report.iter().flat_map(|it| &it.columns);
    notes.filter(|it| it.column == *name).nth(before)
}

fn row(number: usize, taken: &Taken, column: &ColumnPreview, note: Option<&ColumnNote>) -> Markup {
    let map = taken
        .options
        .columns
        .iter()
        .find(|it| it.foreign == column.key || it.foreign == column.text);
    let signal = match (note, map) {
        (Some(note), _) => Some(note.signal.as_str()),
        (None, Some(map)) => Some(map.canonical.as_str()),
        (None, None) => column.guess.filter(|_| taken.incomplete.is_some()),
    };
    let choice = signal.and_then(|name| choices().find(|it| it.signal == name));
    let said = map.and_then(|it| it.unit.as_deref()).or(column.unit.as_deref());
    let unit = note.and_then(|it| it.given_unit.as_deref()).or(said);
    let unit = unit.or(choice.as_ref().map(|it| it.bare_unit)).unwrap_or_default();
    html! {
        tr data-recording=(number) data-column=(column.key) {
            th scope="row" { (column.text) }
            td { (spark(column)) }
            td.name { (signals(number, column, choice.as_ref())) }
            td.name {
                @if let Some(choice) = &choice {
                    input.unit type="text" list={ "units-" (choice.signal) } value=(unit) size="9"
                        autocomplete="off" spellcheck="false" data-unit-of=(column.key)
                        data-recording=(number) aria-label={ "unit of column " (column.text) };
                } @else { (unit) }
            }
            td.name.makes { (makes(taken, column, note, choice.as_ref())) }
            td.name { (how(taken, column, note, map.is_some())) }
        }
    }
}

fn signals(number: usize, column: &ColumnPreview, now: Option<&Choice>) -> Markup {
    html! {
        select.signal data-signal-of=(column.key) data-recording=(number)
            aria-label={ "what column " (column.text) " is" } {
            @for choice in choices() {
                option value=(choice.signal) selected[now == Some(&choice)] {
                    (choice.words)
                    @if choice.words != choice.signal { ", " (choice.signal) }
                }
            }
            option value="" selected[now.is_none()] { "not used" }
        }
    }
}

/// The values of its signal.
fn makes(
    taken: &Taken,
    column: &ColumnPreview,
    note: Option<&ColumnNote>,
    choice: Option<&Choice>,
) -> String {
    let (Some(note), Some(choice), Some(recording)) = (note, choice, &taken.recording) else {
        return String::new();
    };
    match values(recording, note) {
        Some(found) => range(found, &note.unit),
        // Runs number the segments; they are no signal.
        None => range((column.least, column.greatest), choice.bare_unit),
    }
}

fn values(recording: &Recording, note: &ColumnNote) -> Option<(f64, f64)> {
    if note.signal == "time" {
        return Some((recording.time(0), recording.time(recording.len().saturating_sub(1))));
    }
    let values = &recording.signal(&note.signal)?.values;
    let finite = values.iter().copied().filter(|it| it.is_finite());
    Some(finite.fold((f64::NAN, f64::NAN), |(low, high), it| (low.min(it), high.max(it))))
}

fn how(taken: &Taken, column: &ColumnPreview, note: Option<&ColumnNote>, mapped: bool) -> Markup {
    let words = match note.map(|it| it.taken) {
        _ if mapped => "said by you",
        Some(How::Named) if note.is_some_and(|it| it.given_unit.is_none()) => {
            "named, its unit assumed"
        }
        Some(How::Named) => "named in the file",
        Some(How::Mapped) => "said by you",
        Some(How::Guessed) => "a guess by its name",
        Some(How::Kept) => "not known",
        None if taken.incomplete.is_some() && column.guess.is_some() => "a guess by its name",
        None => "not known",
    };
    let unit = column
        .unit
        .as_deref()
        .filter(|it| note.is_some_and(|note| note.given_unit.as_deref() != Some(it)));
    html! {
        (words)
        @if let Some(unit) = unit { "; its header says " (unit) }
    }
}

/// The signals of a recording that was simulated.
pub(super) fn simulated(recording: &Recording) -> Markup {
    let one = |it: &drivescope_recording::Signal| format!("{} [{}]", in_words(&it.name), it.unit);
    let all: Vec<String> = recording.signals.iter().map(one).collect();
    html! { p.note { "Simulated, with the noise of its sensors: " (all.join(", ")) "." } }
}
