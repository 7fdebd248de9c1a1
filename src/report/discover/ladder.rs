//! The ladder: what was added, and how the error fell.

use maud::{Markup, PreEscaped, html};

use crate::report::page::table;
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel};
use crate::report::words::number;

/// Width and height of its picture, pixels.
const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 110.0;

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
                th scope="row" { span.branch { ("\u{2003}".repeat(step.depth)) } (step.label) }
                td { (number(step.error)) }
                td { (number(step.validation_error)) }
                td.name { (action(place)) }
            }
        }
    };
    html! {
        (table("Errors in units of the sensors\u{2019} noise; 1 is the floor", &head, &body))
        @if steps.len() > 1 { (PreEscaped(picture(steps).svg_of(WIDTH))) }
    }
}

fn picture(steps: &[Step]) -> Figure {
    let line = |label: &str, of: &dyn Fn(&Step) -> f64, ink, dash| Layer::Line {
        label: label.to_owned(),
        points: steps.iter().enumerate().map(|(k, step)| (k as f64, of(step))).collect(),
        ink,
        dash,
    };
    let floor = Layer::Level {
        label: "noise floor".to_owned(),
        y: 1.0,
        ink: Ink::Text,
        dash: Dash::Dotted,
    };
    Figure {
        id: "ladder-plot".to_owned(),
        title: "Errors, step by step".to_owned(),
        description: "Estimation and validation error over the steps of the ladder".to_owned(),
        x: Axis::new("step", ""),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new("error", "noise sd"),
            layers: vec![
                floor,
                line("estimation", &|it| it.error, Ink::Blue, Dash::Solid),
                line("validation", &|it| it.validation_error, Ink::Vermilion, Dash::Dashed),
            ],
            strip: None,
        }],
    }
}
