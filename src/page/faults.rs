//! The faults view: what the results of a study hold, whatever methods and classes these are.
//!
//! It reads names and numbers from the JSON of the results, not from types of this program, so
//! that a method or a class that is new appears without a change here.

use drivescope_scenarios::results::{Method, Pictures, StudyResults};
use maud::{Markup, PreEscaped, html};
use serde_json::{Map, Value};

use super::study::Shown;
use crate::report::page::{label, minus};
use crate::report::plot::{Axis, Figure, Ink, Layer, Panel};
use crate::report::words::{number, percent};

/// Height of the picture of the symptoms, pixels.
const HEIGHT: f64 = 340.0;
const INKS: [Ink; 6] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Vermilion, Ink::Purple, Ink::Text];

/// The whole view.
pub(super) fn view(shown: &Shown) -> String {
    let results = shown.results.as_deref();
    html! {
        section #study aria-labelledby="study-h" {
            h2 #study-h { "Faults" span.about { " twelve faults, every detector" } }
            @if let Some(problem) = &shown.problem { p.problem role="alert" { (problem) } }
            @match &shown.running {
                Some(running) => p {
                    "A study is running: " (running.doing)
                    @if running.of > 0 { ", " (running.done) " of " (running.of) " runs" } ". "
                    @if running.of > 0 {
                        progress max=(running.of) value=(running.done) aria-label="runs judged" {}
                    }
                    button type="button" data-study="cancel" { "Cancel" }
                },
                None => p {
                    button type="button" data-study="start" { "Run the study" }
                    label.file for="study-file" { " or open a " code { "study.json" } " "
                        input #study-file type="file" accept=".json"; }
                },
            }
            @if results.is_none() && shown.running.is_none() {
                p.note { "The study puts twelve faults into the drive, watches them with every \
                    detector, isolates and sizes them: the experiment of the reference paper." }
            }
        }
        @if let Some(results) = results {
            (detection(results, shown.traces.as_deref()))
            (symptoms(results))
            (isolation(results))
            (sizes(results))
        }
    }
    .into_string()
}

/// The traces of a run of that study.
pub(super) fn trace(
    (study, pictures): &(StudyResults, Vec<Pictures>),
    run: usize,
) -> Option<String> {
    let picture = pictures.get(run)?;
    Some(crate::report::study::run(study, picture, run).into_string())
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value.get(key).and_then(Value::as_str).unwrap_or_default()
}

fn rows<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// A fault in words: `tacho +5 %`.
fn fault(of: &Value) -> String {
    let size = of
        .get("size")
        .and_then(Value::as_f64)
        .map_or(String::new(), |size| format!(" {:+} %", (size * 1e4).round() / 100.0));
    minus(&format!("{}{size}", text(of, "kind").replace('_', " ")))
}

/// Values of a key, each once, in the order in which they come.
fn distinct<'a>(rows: &'a [Value], key: &str) -> Vec<&'a Value> {
    let mut all: Vec<&Value> = Vec::new();
    for value in rows.iter().filter_map(|row| row.get(key)) {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

fn detection(results: &Value, traces: Option<&(StudyResults, Vec<Pictures>)>) -> Markup {
    let rows = rows(results, "detection");
    let (faults, methods) = (distinct(rows, "fault"), distinct(rows, "method"));
    let cell = |fault: &Value, method: &Value| {
        rows.iter().find(|row| row.get("fault") == Some(fault) && row.get("method") == Some(method))
    };
    let run_of = |fault: &Value| {
        let pictures = &traces?.1;
        pictures
            .iter()
            .position(|it| it.fault.as_ref().is_some_and(|it| it.label == text(fault, "label")))
    };
    html! {
        section aria-labelledby="matrix-h" {
            h2 #matrix-h { "Detection" }
            p { (rest_of(results, "drive", "name")) }
            div.scroll role="region" tabindex="0" aria-label="Faults and detectors" {
                table.matrix {
                    caption { "\u{25cf} detected, with the delay in samples; \u{25cb} missed; \u{25b2} declared before the fault began" }
                    thead { tr {
                        th.name scope="col" { "Fault" } th.name scope="col" { "Label" }
                        @for method in &methods { th.name scope="col" { (name_of(method)) } }
                    } }
                    tbody { @for one in &faults {
                        tr {
                            th scope="row" {
                                @match run_of(one) {
                                    Some(run) => button.link type="button" data-run=(run) { (fault(one)) },
                                    None => (fault(one)),
                                }
                            }
                            td.name { (label(text(one, "label"))) }
                            @for method in &methods { (outcome(cell(one, method))) }
                        }
                    } }
                }
            }
            div #trace {}
            (healthy(results))
        }
    }
}

fn rest_of<'a>(results: &'a Value, section: &str, key: &str) -> &'a str {
    results.get(section).map_or("", |it| text(it, key))
}

/// What people call a method; one that nobody knows by its name in the results.
fn name_of(method: &Value) -> String {
    let known =
        Method::ALL.into_iter().find(|it| serde_json::to_value(it).is_ok_and(|it| it == *method));
    if let Some(known) = known {
        return known.label().to_owned();
    }
    method.as_str().map_or_else(|| method.to_string(), |name| name.replace('_', " "))
}

/// What became of a fault under a method: a shape, a word and a number, not a colour alone.
fn outcome(row: Option<&Value>) -> Markup {
    let Some(row) = row else { return html! { td { "\u{2013}" } } };
    let whole = |key: &str| row.get(key).and_then(Value::as_u64);
    let share = row.get("r_td").and_then(Value::as_f64);
    let title =
        share.map(|share| format!("outside the threshold in {} % of samples", percent(share, 1)));
    match (whole("t_dt"), whole("delay"), whole("false_alarms").unwrap_or(0)) {
        (_, None, alarms) if alarms > 0 => html! {
            td.name.false-alarm title=[title] { "\u{25b2} false alarm" }
        },
        (Some(_), Some(delay), alarms) => html! {
            td.name.detected title=[title] {
                "\u{25cf} " (delay) @if alarms > 0 { span.note { " \u{25b2}" (alarms) } }
            }
        },
        (Some(at), None, _) => html! { td.name.detected title=[title] { "\u{25cf} at " (at) } },
        _ => html! { td.name.missed title=[title] { "\u{25cb} missed" } },
    }
}

/// False alarms and false detection rates, by whatever methods are there.
fn healthy(results: &Value) -> Markup {
    let alarms = results.get("healthy").and_then(|it| it.get("alarms")).and_then(Value::as_object);
    let rates = results.get("r_fd").and_then(Value::as_object);
    let (none, runs) = (Map::new(), results.get("healthy").and_then(|it| it.get("runs")));
    let (alarms, rates) = (alarms.unwrap_or(&none), rates.unwrap_or(&none));
    let mut names: Vec<&String> = alarms.keys().collect();
    names.extend(rates.keys().filter(|name| !alarms.contains_key(*name)));
    html! {
        @if !names.is_empty() {
            div.scroll role="region" tabindex="0" aria-label="Healthy runs" {
                table {
                    caption { "Healthy runs" @if let Some(runs) = runs { ": " (runs) } }
                    thead { tr {
                        th.name scope="col" { "Detector" } th scope="col" { "Faults declared" }
                        th scope="col" { "Samples outside [%]" }
                    } }
                    tbody { @for name in names {
                        tr {
                            th scope="row" { (name_of(&Value::from(name.as_str()))) }
                            td { (scalar(alarms.get(name))) }
                            td { (rates.get(name).and_then(Value::as_f64).map_or("\u{2013}".to_owned(), |it| percent(it, 2))) }
                        }
                    } }
                }
            }
        }
    }
}

/// A number or a word as text; a dash for what is not there.
fn scalar(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => "\u{2013}".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(it)) if it.is_f64() => minus(&number(it.as_f64().unwrap_or(f64::NAN))),
        Some(Value::Array(ends)) => {
            ends.iter().map(|end| scalar(Some(end))).collect::<Vec<_>>().join(" to ")
        }
        Some(Value::Object(of)) if of.contains_key("kind") => value.map(fault).unwrap_or_default(),
        Some(other) => other.to_string(),
    }
}

fn symptoms(results: &Value) -> Markup {
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
            y: Axis::new("residual r", rest_of(results, "drive", "tacho_unit")),
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
fn isolation(results: &Value) -> Markup {
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
fn sizes(results: &Value) -> Markup {
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use scraper::{Html, Selector};

    use super::*;

    fn count(page: &Html, selector: &str) -> usize {
        page.select(&Selector::parse(selector).expect("a selector")).count()
    }

    fn shown(results: Value) -> Html {
        let shown = Shown { results: Some(Arc::new(results)), ..Shown::default() };
        let page = Html::parse_fragment(&view(&shown));
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        page
    }

    #[test]
    fn methods_and_classes_that_nobody_knew_appear() {
        let fault =
            |label: &str| serde_json::json!({"kind": "tacho", "size": 0.05, "label": label});
        let row = |label: &str, method: &str, delay: Option<u64>, alarms: u64| {
            let t_dt = delay.map(|delay| 4000 + delay);
            serde_json::json!({"fault": fault(label), "method": method, "r_td": 0.5, "t_dt": t_dt,
                               "delay": delay, "false_alarms": alarms})
        };
        let page = shown(serde_json::json!({
            "detection": [row("f_1^1", "mem", Some(57), 0), row("f_1^1", "spline_oracle", None, 0),
                          row("f_2^1", "mem", None, 2), row("f_2^1", "spline_oracle", Some(3), 0)],
            "healthy": {"runs": 20, "alarms": {"mem": 0, "spline_oracle": 1}},
            "isolation_by_oracle": {"classes": ["a", "<b>"], "matrix": [[0.9, 0.1, 0.0], [0.0, 0.97, 0.03]]},
            "identification": [{"fault": fault("f_1^1"), "size_percent": 5.1, "interval": [4.8, 5.4], "novel": 7}],
        }));
        assert_eq!(count(&page, "table.matrix tbody tr"), 2);
        assert_eq!(count(&page, "td.detected"), 2);
        assert_eq!((count(&page, "td.missed"), count(&page, "td.false-alarm")), (1, 1));
        let text: String = page.root_element().text().collect();
        for word in ["spline oracle", "by oracle", "<b>", "novel", "4.80 to 5.40", "57"] {
            assert!(text.contains(word), "{word} in {text}");
        }
    }

    #[test]
    fn the_study_of_this_program_is_drawn_whole() {
        let study = crate::report::testing::study();
        let page = shown(serde_json::to_value(study).expect("it is data"));
        assert_eq!(count(&page, "table.matrix tbody tr"), 12);
        assert_eq!(count(&page, "table.heat"), 3);
        assert_eq!(count(&page, "svg.plot"), 1);
    }

    #[test]
    fn nothing_is_shown_where_nothing_is() {
        let page = Html::parse_fragment(&view(&Shown::default()));
        assert_eq!(count(&page, "table"), 0);
        assert_eq!(count(&page, "[data-study=start]"), 1);
        let empty = shown(serde_json::json!({"detection": []}));
        assert_eq!(count(&empty, "table.matrix tbody tr"), 0);
    }
}
