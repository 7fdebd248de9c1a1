//! The ladder: what was added, and how the error fell.

use maud::{Markup, PreEscaped, html};

use crate::report::page::table;
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::number;

/// A step of the ladder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Step {
    /// What was done.
    pub(crate) label: String,
    /// Error on the estimation data, in units of the noise.
    pub(crate) error: f64,
    /// Error on the validation data.
    pub(crate) validation_error: f64,
    /// How many steps stand above it.
    pub(crate) depth: usize,
}

/// The table of the steps and its picture; `action` is what may be done with the step of a number.
pub(crate) fn ladder(steps: &[Step], action: &dyn Fn(usize) -> Markup) -> Markup {
    let head = html! {
        tr {
            th.name scope="col" { "Step" }
            th scope="col" { "Error, estimation" }
            th scope="col" { "Error, validation" }
            th.name scope="col" { span.unseen { "what can be done" } }
        }
    };
    let body = html! {
        @for (place, step) in steps.iter().enumerate() {
            tr data-step=(place) {
                th scope="row" { span.branch { ("\u{2003}".repeat(step.depth)) } (place) ": " (step.label) }
                td { (number(step.error)) }
                td { (number(step.validation_error)) }
                td.name { (action(place)) }
            }
        }
    };
    html! {
        (table("Errors in units of the sensors\u{2019} noise; 1 is the floor", &head, &body))
        @if steps.len() > 1 {
            div.scroll role="region" tabindex="0" aria-label="Errors, step by step" {
                (PreEscaped(picture(steps).svg()))
            }
        }
    }
}

fn picture(steps: &[Step]) -> Rows {
    let series = |label: &str, ink, mark| Series { label: label.to_owned(), ink, mark, lane: 0 };
    let row = |(number, step): (usize, &Step)| {
        let values = vec![Value::Number(step.error), Value::Number(step.validation_error)];
        (format!("{number}: {}", step.label), values)
    };
    Rows {
        id: "ladder-plot".to_owned(),
        title: "Errors, step by step".to_owned(),
        description: "Estimation and validation error of every step of the ladder".to_owned(),
        axis: Axis::new("error", "noise sd"),
        reference: Some((1.0, "noise floor".to_owned())),
        series: vec![
            series("estimation", Ink::Blue, Mark::Disc),
            series("validation", Ink::Vermilion, Mark::HollowDiamond),
        ],
        rows: steps.iter().enumerate().map(row).collect(),
    }
}
