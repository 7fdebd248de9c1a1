//! What a session shows, as pieces of HTML by the places of the page that they fill.

use std::collections::BTreeMap;

use drivescope_discovery::compare::{Comparison, Curve};
use drivescope_recording::{ColumnNote, Taken as How};
use maud::{Markup, PreEscaped, html};

use super::bench::State;
use super::recordings::{Taken, UnitFix, units_like};
use super::rung::Rung;
use super::work::file_of;
use crate::report::compare::{pictures, remark, tables, verdict};
use crate::report::discover::{Step, cards, ladder, parameters};
use crate::report::page::minus;
use crate::report::words::number;

/// Width and height of the panels, pixels.
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 130.0;
/// Signals that a column may be taken as.
const SIGNALS: [&str; 10] = ["time", "u", "i", "omega", "theta", "v", "x", "T_l", "reference", "T"];

/// What the browser looks at.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// The rung.
    pub(super) rung: usize,
    /// The recording.
    pub(super) recording: usize,
}

/// The pieces, by the places that they fill.
pub(super) fn pieces(state: &State, view: View) -> BTreeMap<&'static str, String> {
    let mut pieces = BTreeMap::from([("data", data(state).into_string())]);
    let Some(rung) = state.rungs.get(view.rung) else { return pieces };
    let found = state.missing.get(&view.rung);
    let shown = [
        (
            "verdict",
            html! {
                p.verdict { (verdict(&rung.compared)) }
                p.second { (remark(&rung.compared)) }
                (tables::tiles(&rung.compared, &rung.about))
            },
        ),
        ("spans", spans(&rung.compared, view.recording)),
        (
            "where",
            html! {
                h3 { "Where it fails" }
                (tables::findings(&rung.compared))
                (panels(&rung.compared, "where"))
            },
        ),
        ("white", white(&rung.compared, view.recording)),
        (
            "cards",
            match found {
                Some(missing) => cards(missing, &rung.compared.curves, &add_button),
                None => html! {
                    p { "What this model lacks has not been asked yet. "
                        button type="button" data-do="learn" { "Ask the library" } }
                },
            },
        ),
        ("ladder", steps(state, view.rung)),
        (
            "parameters",
            html! {
                h3 { "Parameters of this step" }
                (parameters(&rung.parameters, &|it| html! {
                    input.value type="text" inputmode="decimal" value=(plain(it.value)) size="11"
                        data-parameter=(it.name) aria-label={ "value of " (it.name) ", " (it.unit) };
                }))
                (untold(rung))
            },
        ),
        ("take", take(view.rung, rung)),
    ];
    pieces.extend(shown.map(|(place, piece)| (place, piece.into_string())));
    pieces
}

/// A value to be edited: enough digits to come back to the same drive.
fn plain(value: f64) -> String {
    let text = format!("{value:.6e}");
    let short: f64 = text.parse().unwrap_or(value);
    if (1e-3..1e5).contains(&short.abs()) { short.to_string() } else { format!("{short:e}") }
}

fn add_button(effect: &str) -> Markup {
    let words = if effect == "learned" { "the curve".to_owned() } else { effect.replace('_', " ") };
    html! { button.add type="button" data-do="add" data-effect=(effect) { "Add " (words) } }
}

/// Recordings with their columns, and the drive.
fn data(state: &State) -> Markup {
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
                (length) " samples every " (number_of(period * 1e3)) " ms, "
                (number_of(length as f64 * period)) " s"
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

fn number_of(value: f64) -> String {
    crate::report::words::given(value)
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
            || drivescope_recording::Unit::parse(other) == drivescope_recording::Unit::parse(unit)
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

/// The spans of a recording, each with its sentence.
fn spans(compared: &Comparison, recording: usize) -> Markup {
    let spans = compared.recordings.get(recording).map_or(&[][..], |it| &it.spans);
    html! {
        h3 { "When it fails" }
        @if spans.is_empty() {
            p.note { "No span of time stands out." }
        } @else {
            ol.spans {
                @for span in spans {
                    li {
                        button.link type="button" data-from=(span.from) data-to=(span.to) { (span.sentence) }
                        " " span.note { "error " (number(span.error)) }
                    }
                }
            }
        }
    }
}

/// What is missing over each variable: the variables that were found first, then those whose
/// curve leaves zero out most.
fn panels(compared: &Comparison, place: &str) -> Markup {
    let rank = |curve: &Curve| {
        let found = compared.findings.iter().position(|it| {
            it.variable == curve.variable
                || (it.variable == "omega_sign" && curve.variable == "omega")
        });
        let ends = curve.lower.iter().zip(&curve.upper);
        let outside = ends.filter(|(low, high)| **low > 0.0 || **high < 0.0).count();
        (found.unwrap_or(usize::MAX), -(outside as f64 / curve.x.len().max(1) as f64))
    };
    let mut order: Vec<usize> = (0..compared.curves.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (rank(&compared.curves[*a]), rank(&compared.curves[*b]));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    html! {
        div.panels {
            @for number in order {
                @let curve = &compared.curves[number];
                figure {
                    (PreEscaped(pictures::curve_at(curve, &format!("{place}-{number}"), HEIGHT).svg_of(WIDTH)))
                    figcaption { (pictures::caption(curve)) }
                    (curve_data(curve))
                }
            }
        }
    }
}

fn curve_data(curve: &Curve) -> Markup {
    html! {
        details {
            summary { "Data" }
            div.scroll role="region" tabindex="0" aria-label={ "Data: " (curve.words) } {
                table {
                    thead { tr {
                        th scope="col" { (curve.variable) " [" (curve.x_unit) "]" }
                        th scope="col" { "missing [" (curve.unit) "]" }
                        th scope="col" { "95 % from" } th scope="col" { "to" }
                    } }
                    tbody {
                        @for (k, x) in curve.x.iter().enumerate() {
                            tr {
                                @for value in [*x, curve.value[k], curve.lower[k], curve.upper[k]] {
                                    td { (minus(&number(value))) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The residual's correlations.
fn white(compared: &Comparison, recording: usize) -> Markup {
    html! {
        @if let Some(it) = compared.recordings.get(recording) {
            details {
                summary {
                    "Is the residual white? "
                    @for output in &it.outputs {
                        span.note {
                            (output.name) ": "
                            (if output.autocorrelation.correlated { "no" } else { "yes" })
                            (if output.input_correlation.correlated { ", it knows the input. " } else { ". " })
                        }
                    }
                }
                figure { (PreEscaped(pictures::correlations(it, recording).svg())) }
            }
        }
    }
}

/// Where the model fails within a brushed window.
pub(super) fn within(compared: &Comparison, (from, to): (f64, f64)) -> String {
    html! {
        section.within aria-labelledby="within-h" {
            h3 #within-h { "Within " (number_of(from)) " to " (number_of(to)) " s" }
            p { (verdict(compared)) " Its error is " (number(compared.error)) " in units of the noise." }
            (panels(compared, "within"))
            @if let Some(it) = compared.recordings.first() {
                figure { (PreEscaped(pictures::correlations(it, 1000).svg())) }
            }
        }
    }
    .into_string()
}

/// Every rung, to go back to, fork and compare.
fn steps(state: &State, now: usize) -> Markup {
    let all: Vec<Step> = state
        .rungs
        .iter()
        .enumerate()
        .map(|(number, rung)| Step {
            label: rung.label.clone(),
            error: rung.error,
            validation_error: rung.validation_error,
            depth: Rung::depth(&state.rungs, number),
        })
        .collect();
    ladder(&all, &|number| {
        html! {
            @if number == now { strong { "shown" } }
            @else {
                button type="button" data-rung=(number) { "Go to" } " "
                button type="button" data-ghost=(number) { "Compare" }
            }
        }
    })
}

fn untold(rung: &Rung) -> Markup {
    html! {
        @for it in &rung.not_identifiable {
            p.note {
                (it.parameter) " is not told by these recordings"
                @if !it.with.is_empty() { " apart from " (it.with.join(", ")) }
                ": it was kept at " (minus(&number(it.kept))) "."
            }
        }
        p {
            button type="button" data-do="fit" { "Fit again" }
            span.note { " A value that you change makes a new step, nothing fitted." }
        }
    }
}

/// What can be taken away.
fn take(number: usize, rung: &Rung) -> Markup {
    html! {
        h3 { "Take it along" }
        p.exports {
            a.button href={ "take/drive.toml?rung=" (number) } download=(file_of(number)) { "Drive file" }
            a.button href={ "take/drive.fmu?fmi=2&rung=" (number) } download="drive_fmi2.fmu" { "FMU, FMI 2.0" }
            a.button href={ "take/drive.fmu?fmi=3&rung=" (number) } download="drive_fmi3.fmu" { "FMU, FMI 3.0" }
            a.button href={ "take/report.html?rung=" (number) } download="report.html" { "Report" }
        }
        p.command {
            "The same on a command line: "
            button type="button" data-copy="command" { "Copy" }
        }
        pre #command tabindex="0" { (rung.command) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edited_value_comes_back() {
        for value in [1.25, -0.004_567_891_2, 8.2e-5, 123_456_789.0] {
            let back: f64 = plain(value).parse().expect("a number");
            assert!((back / value - 1.0).abs() < 1e-6, "{value} {back}");
        }
        assert_eq!(plain(0.06), "0.06");
        assert_eq!(plain(8.2e-5), "8.2e-5");
    }
}
