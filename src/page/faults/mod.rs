//! The faults view: what the results of a study hold, whatever methods and classes these are.
//!
//! It reads names and numbers from the JSON of the results, not from types of this program, so
//! that a method or a class that is new appears without a change here.

mod isolation;
mod read;

use drivescope_scenarios::results::{Pictures, StudyResults};
use maud::{Markup, html};
use serde_json::{Map, Value};

use super::study::Shown;
use crate::report::page::label;
use crate::report::words::percent;
use isolation::{isolation, sizes, symptoms};
use read::{distinct, fault, name_of, rows, scalar, text, word_of};

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
    let stated = [crate::answer::study::run(study, picture, run)];
    Some(crate::answer::html::page(&stated, &|_| None).into_string())
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
            p { (word_of(results, "drive", "name")) }
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
