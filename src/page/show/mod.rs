//! What a session shows, as pieces of HTML by the places of the page that they fill.

mod columns;
mod data;
mod failing;
mod spark;

use std::collections::BTreeMap;

use drivescope_discovery::{BothUnexplained, OutputFits};
use maud::{Markup, html};

use data::data;
pub(super) use failing::within;
use failing::{panels, spans, white};

use super::bench::State;
use super::command_line::file_of;
use super::rung::Rung;
use crate::report::compare::{remark, tables, verdict};
use crate::report::discover::{Step, cards, ladder, parameters};
use crate::report::page::minus;
use crate::report::words::number;

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
                p.second { (remark(&rung.compared, rung.about.step)) }
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

/// Every rung, to go back to, fork and compare.
fn steps(state: &State, now: usize) -> Markup {
    let all: Vec<Step> = state
        .rungs
        .iter()
        .enumerate()
        .map(|(number, rung)| Step {
            label: rung.label.clone(),
            // A narrow window has no room for more than the errors; the report tells it.
            unexplained: BothUnexplained { torque: None, voltage: None },
            fits: OutputFits::new(),
            error: rung.error,
            validation_error: rung.validation_error,
            depth: Rung::depth(&state.rungs, number),
        })
        .collect();
    ladder(state.rungs[now].drive.motion, &all, &|number| {
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
