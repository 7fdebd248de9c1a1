//! What a session shows, as pieces of HTML by the places of the page that they fill.

mod columns;
mod data;
mod failing;
mod spark;

use std::collections::BTreeMap;

use maud::{Markup, html};

use data::data;
pub(super) use failing::within;
use failing::{over_what, when, white};

use super::bench::State;
use super::command_line::file_of;
use super::session_step::SessionStep;
use crate::answer::block::{Block, Key};
use crate::answer::compare::summary;
use crate::answer::discover::{Step, ladder};
use crate::answer::{html, not_told, parameters};

/// What the browser looks at.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) step: usize,
    pub(super) recording: usize,
}

/// The pieces, by the places that they fill.
pub(super) fn pieces(state: &State, view: View) -> BTreeMap<&'static str, String> {
    let mut pieces = BTreeMap::from([("data", data(state).into_string())]);
    let Some(step) = state.steps.get(view.step) else { return pieces };
    let found = state.missing.get(&view.step);
    let on_page = |blocks: &[Block]| html::page(blocks, &offered);
    let compared = &step.compared;
    let shown = [
        ("verdict", on_page(&summary(compared, &step.about))),
        ("spans", on_page(&when(compared, view.recording))),
        ("where", on_page(&over_what(compared, step.about.motion))),
        ("white", on_page(&white(compared, view.recording))),
        (
            "cards",
            match found {
                Some(missing) => on_page(&missing.blocks(&compared.curves)),
                None => html! {
                    p { "What this model lacks has not been asked yet. "
                        button type="button" data-do="learn" { "Ask the library" } }
                },
            },
        ),
        ("ladder", steps(state, view.step)),
        ("parameters", of_step(step)),
        ("take", take(view.step, step)),
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

/// What may be done with what is shown.
fn offered(key: &Key) -> Option<Markup> {
    Some(match key {
        Key::Effect(effect) => {
            let words = if effect == "learned" { "the curve" } else { effect };
            html! { button.add type="button" data-do="add" data-effect=(effect) { "Add " (words) } }
        }
        Key::Law { target, text, head } => {
            html! { code data-law=(text) data-target=(target) { (head) } }
        }
        Key::Parameter { name, unit, value } => html! {
            input.value type="text" inputmode="decimal" value=(plain(*value)) size="11"
                data-parameter=(name) aria-label={ "value of " (name) ", " (unit) };
        },
        Key::Span { from, to, sentence } => html! {
            button.link type="button" data-from=(from) data-to=(to) { (sentence) }
        },
        Key::Step(_) | Key::Anchor(_) => return None,
    })
}

/// Every step, to go back to, fork and compare.
fn steps(state: &State, now: usize) -> Markup {
    let each = state.steps.iter().enumerate();
    let all: Vec<Step> =
        each.map(|(number, step)| step.shown(SessionStep::depth(&state.steps, number))).collect();
    html::page(&ladder(state.steps[now].drive.motion, &all), &|key| match key {
        Key::Step(number) if *number == now => Some(html! { strong { "shown" } }),
        Key::Step(number) => Some(html! {
            button type="button" data-step=(number) { "Go to" } " "
            button type="button" data-ghost=(number) { "Compare" }
        }),
        _ => None,
    })
}

/// The parameters of a step, and what the recordings do not tell of them.
fn of_step(step: &SessionStep) -> Markup {
    let known = step.parameters.iter().map(|it| (it, String::new()));
    let mut blocks = vec![Block::Heading("Parameters of this step".to_owned()), parameters(known)];
    blocks.extend(not_told(&step.not_identifiable));
    html! {
        (html::page(&blocks, &offered))
        p {
            button type="button" data-do="fit" { "Fit again" }
            span.note { " A value that you change makes a new step, nothing fitted." }
        }
    }
}

/// What can be taken away.
fn take(number: usize, step: &SessionStep) -> Markup {
    html! {
        h3 { "Take it along" }
        p.exports {
            a.button href={ "take/drive.toml?step=" (number) } download=(file_of(number)) { "Drive file" }
            a.button href={ "take/drive.fmu?fmi=2&step=" (number) } download="drive_fmi2.fmu" { "FMU, FMI 2.0" }
            a.button href={ "take/drive.fmu?fmi=3&step=" (number) } download="drive_fmi3.fmu" { "FMU, FMI 3.0" }
            a.button href={ "take/report.html?step=" (number) } download="report.html" { "Report" }
        }
        p.command {
            "The same on a command line: "
            button type="button" data-copy="command" { "Copy" }
        }
        pre #command tabindex="0" { (step.command) }
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
