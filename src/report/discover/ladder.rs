//! The ladder: what was added, and how the error fell.

use drivescope_discovery::{BothUnexplained, OutputFits, Unexplained};
use drivescope_plant::drive::Motion;
use maud::{Markup, PreEscaped, html};

use crate::report::page::{minus, table};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::{balances, in_units_of_noise, number, percent};

/// A step of the ladder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Step {
    /// What was done.
    pub(crate) label: String,
    /// What the balances of the validation data leave unexplained.
    pub(crate) unexplained: BothUnexplained,
    /// Fit of each output of the validation data, %.
    pub(crate) fits: OutputFits,
    /// Error on the estimation data, in units of the noise.
    pub(crate) error: f64,
    /// Error on the validation data.
    pub(crate) validation_error: f64,
    /// How many steps stand above it.
    pub(crate) depth: usize,
}

/// A balance of which something is unexplained, and what every step leaves of it.
type OfBalance = (&'static str, Vec<Option<Unexplained>>);

/// The balances of which these steps tell what is unexplained.
fn by_balance(motion: Motion, steps: &[Step]) -> Vec<OfBalance> {
    let all: Vec<_> = steps.iter().map(|step| balances(motion, &step.unexplained)).collect();
    let Some(first) = all.first() else { return Vec::new() };
    let of = |place: usize| (first[place].0, all.iter().map(|it| it[place].1).collect());
    let measured = |(_, each): &OfBalance| each.iter().any(Option::is_some);
    (0..first.len()).map(of).filter(measured).collect()
}

/// The table of the steps and its picture; `action` is what may be done with the step of a number.
pub(crate) fn ladder(motion: Motion, steps: &[Step], action: &dyn Fn(usize) -> Markup) -> Markup {
    let unexplained = by_balance(motion, steps);
    let in_reach = |step: &Step| in_units_of_noise(step.error.max(step.validation_error));
    let outputs: Vec<&str> =
        steps.first().map_or(Vec::new(), |it| it.fits.keys().copied().collect());
    let errors = unexplained.is_empty() || steps.iter().any(in_reach);
    let actions: Vec<Markup> = (0..steps.len()).map(action).collect();
    let any = actions.iter().any(|it| !it.0.is_empty());
    let head = html! {
        tr {
            th.name scope="col" { "Step" }
            @for (balance, _) in &unexplained {
                th scope="col" { "Unexplained " (balance) ", %" }
            }
            @for name in &outputs {
                th scope="col" { "Fit of " (name) ", %" }
            }
            @if errors {
                th scope="col" { "Error, estimation" }
                th scope="col" { "Error, validation" }
            }
            @if any { th.name scope="col" { span.unseen { "what can be done" } } }
        }
    };
    let body = html! {
        @for ((place, step), action) in steps.iter().enumerate().zip(&actions) {
            tr data-step=(place) {
                th scope="row" { span.branch { ("\u{2003}".repeat(step.depth)) } (place) ": " (step.label) }
                @for (_, each) in &unexplained {
                    td { (each[place].map_or("-".to_owned(), |it| percent(it.share, 1))) }
                }
                @for name in &outputs {
                    td { (fit(step, name)) }
                }
                @if errors {
                    td { (number(step.error)) }
                    td { (number(step.validation_error)) }
                }
                @if any { td.name { (action) } }
            }
        }
    };
    let mut title = Vec::new();
    if !unexplained.is_empty() {
        title.push("What the balances leave unexplained of the recordings that judge");
    }
    if !outputs.is_empty() {
        title.push("how well the model follows each output of them");
    }
    if errors {
        title.push("errors in units of the sensors\u{2019} noise, 1 is the floor");
    }
    html! {
        div.scroll role="region" tabindex="0" aria-label="Steps" {
            (table(&title.join("; "), &head, &body))
        }
        @if steps.len() > 1 {
            div.scroll role="region" tabindex="0" aria-label="Errors, step by step" {
                (PreEscaped(if errors { of_errors(steps) } else { of_unexplained(steps, &unexplained) }.svg()))
            }
        }
    }
}

/// How well a step follows an output, %.
fn fit(step: &Step, output: &str) -> String {
    let known = step.fits.get(output).copied().flatten();
    known.map_or("-".to_owned(), |it| minus(&format!("{it:.2}")))
}

fn picture(
    (description, axis, reference): (&str, Axis, Option<(f64, String)>),
    series: Vec<Series>,
    rows: Vec<(String, Vec<Value>)>,
) -> Rows {
    Rows {
        id: "ladder-plot".to_owned(),
        title: "Errors, step by step".to_owned(),
        description: description.to_owned(),
        axis,
        reference,
        series,
        rows,
    }
}

fn series(label: &str, ink: Ink, mark: Mark) -> Series {
    Series { label: label.to_owned(), ink, mark, lane: 0 }
}

fn of_errors(steps: &[Step]) -> Rows {
    let row = |(number, step): (usize, &Step)| {
        let values = vec![Value::Number(step.error), Value::Number(step.validation_error)];
        (format!("{number}: {}", step.label), values)
    };
    let about = (
        "Estimation and validation error of every step of the ladder",
        Axis::new("error", "noise sd"),
        Some((1.0, "noise floor".to_owned())),
    );
    let both = vec![
        series("estimation", Ink::Blue, Mark::Disc),
        series("validation", Ink::Vermilion, Mark::HollowDiamond),
    ];
    picture(about, both, steps.iter().enumerate().map(row).collect())
}

fn of_unexplained(steps: &[Step], unexplained: &[OfBalance]) -> Rows {
    let row = |(number, step): (usize, &Step)| {
        let value = |(_, each): &OfBalance| {
            let none = || Value::Missing("not told".to_owned());
            each[number].map_or_else(none, |it| Value::Number(100.0 * it.share))
        };
        (format!("{number}: {}", step.label), unexplained.iter().map(value).collect())
    };
    let about = (
        "What the balances leave unexplained at every step of the ladder",
        Axis::new("unexplained", "%"),
        None,
    );
    let looks = [(Ink::Blue, Mark::Disc), (Ink::Vermilion, Mark::HollowDiamond)];
    let each =
        unexplained.iter().zip(looks).map(|((balance, _), (ink, mark))| series(balance, ink, mark));
    picture(about, each.collect(), steps.iter().enumerate().map(row).collect())
}
