//! What tells faults apart: symptoms, isolation matrices, sizes.

use maud::{Markup, PreEscaped, html};
use serde_json::{Map, Value};

use super::read::{fault, rows, scalar, text, word_of};
use crate::report::page::{label, minus};
use crate::report::plot::{Axis, Figure, Ink, Layer, Panel};
use crate::report::words::percent;

/// Height of the picture of the symptoms, pixels.
const HEIGHT: f64 = 340.0;
const INKS: [Ink; 6] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Vermilion, Ink::Purple, Ink::Text];

/// The cloud of symptoms of every fault.
pub(super) fn symptoms(results: &Value) -> Markup {
    let all = rows(results, "symptoms");
    let cloud = |(place, of): (usize, &Value)| {
        let one = of.get("fault").unwrap_or(of);
        let point = |pair: &Value| Some((pair.get(0)?.as_f64()?, pair.get(1)?.as_f64()?));
        Layer::Cloud {
            name: label(text(one, "label")),
            points: rows(of, "points").iter().filter_map(point).collect(),
            ink: INKS[place % INKS.len()],
            below: place % 2 == 1,
        }
    };
    let figure = Figure {
        id: "symptoms".to_owned(),
        title: "Distribution of the symptoms of every fault".to_owned(),
        description: "Residual over control signal, a cloud of points a fault".to_owned(),
        x: Axis::new("control signal C_m", "V"),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new("residual r", word_of(results, "drive", "tacho_unit")),
            layers: all.iter().enumerate().map(cloud).collect(),
            strip: None,
        }],
    };
    html! {
        @if !all.is_empty() {
            section aria-labelledby="symptoms-h" {
                h2 #symptoms-h { "Symptoms" }
                figure { div.scroll role="region" tabindex="0" aria-label="Symptoms" { (PreEscaped(figure.svg())) } }
            }
        }
    }
}

/// Every isolation matrix that is there.
pub(super) fn isolation(results: &Value) -> Markup {
    let none = Map::new();
    let all = results.as_object().unwrap_or(&none);
    let tables = all.iter().filter(|(key, it)| {
        key.starts_with("isolation") && it.get("matrix").is_some_and(Value::is_array)
    });
    html! {
        @for (key, of) in tables {
            section aria-labelledby=(key) {
                h2 id=(key) { (title(key)) }
                (matrix(of))
            }
        }
    }
}

fn title(key: &str) -> String {
    match key.strip_prefix("isolation") {
        Some("") | None => "Isolation, every fault a class".to_owned(),
        Some(rest) => format!("Isolation, classes: {}", rest.replace('_', " ").trim()),
    }
}

fn matrix(of: &Value) -> Markup {
    let (classes, lines) = (rows(of, "classes"), rows(of, "matrix"));
    let faults = rows(of, "faults");
    let width = lines.iter().map(|line| line.as_array().map_or(0, Vec::len)).max().unwrap_or(0);
    let column =
        |k: usize| classes.get(k).map_or_else(|| "unknown".to_owned(), |it| scalar(Some(it)));
    let row = |k: usize| {
        faults.get(k).or_else(|| classes.get(k)).map_or_else(String::new, |it| scalar(Some(it)))
    };
    html! {
        div.scroll role="region" tabindex="0" aria-label="Shares of answers" {
            table.heat {
                caption { "Shares in per cent: rows the true fault, columns the answer" }
                thead { tr {
                    th.name scope="col" { "Fault" }
                    @for k in 0..width { th scope="col" { (minus(&column(k))) } }
                } }
                tbody { @for (k, line) in lines.iter().enumerate() {
                    tr {
                        th scope="row" { (minus(&row(k))) }
                        @for value in line.as_array().map_or(&[][..], Vec::as_slice) {
                            @let share = value.as_f64().unwrap_or(0.0);
                            td class={ "h" ((share.clamp(0.0, 1.0) * 10.0).round()) } {
                                @if share < 5e-4 { "\u{2013}" } @else { (percent(share, 1)) }
                            }
                        }
                    }
                } }
            }
        }
    }
}

/// Sizes of the faults with whatever the results say of them.
pub(super) fn sizes(results: &Value) -> Markup {
    let all = rows(results, "identification");
    let mut keys: Vec<&String> = Vec::new();
    for row in all.iter().filter_map(Value::as_object) {
        keys.extend(
            row.keys().filter(|key| *key != "fault" && !keys.contains(key)).collect::<Vec<_>>(),
        );
    }
    html! {
        @if !all.is_empty() {
            section aria-labelledby="sizes-h" {
                h2 #sizes-h { "Sizes" }
                div.scroll role="region" tabindex="0" aria-label="Sizes of the faults" {
                    table {
                        thead { tr {
                            th.name scope="col" { "Fault" }
                            @for key in &keys { th scope="col" { (key.replace('_', " ")) } }
                        } }
                        tbody { @for row in all {
                            tr {
                                th scope="row" { (row.get("fault").map(fault).unwrap_or_default()) }
                                @for key in &keys { td { (scalar(row.get(key.as_str()))) } }
                            }
                        } }
                    }
                }
            }
        }
    }
}
