//! Table 1: detection of each fault, beside the paper's; the delays as a picture; the other
//! readings of the torque fault.

use drivescope_scenarios::results::{
    DESCRIBED, DetectionRow, DetectorKind, FaultName, IN_PAPER, Pictures, ReadingRows, StudyResults,
};
use maud::{Markup, html};

use super::picture;
use crate::report::page::{self, figure, label, math, minus, table};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::{fault, paper_delay, paper_row, percent, rows_of, torque};

/// The axis of delays reaches at least so far, samples: twice the usual rule and some more.
const LEAST_AXIS: f64 = 120.0;

/// The section.
pub(super) fn section(study: &StudyResults, pictures: &[Pictures]) -> Markup {
    page::section(
        "detection",
        "Detection of each fault (Table 1 of the paper)",
        &html! {
            (table_1(study, pictures))
            p.note {
                (math("r_td")) ": share of faulty samples outside the threshold. " (math("t_dt"))
                ": sample of the declaration, which counts for the fault if most of its run of "
                (study.window) " samples lies in it: chance may put it before the fault's begin + "
                (study.window) ". † after a false alarm, so that the fault does not count as detected "
                "(the paper's: declared before its begin). Sizes are of the "
                "sensor or mechanism that fails; the label is the paper's."
            }
            (others(study))
            (beyond(study))
            (further(study))
            (figure("delays", delays(study).svg(), "Delays to declaration", &html! {
                "Delay from the fault's begin to its declaration. A mark near the dashed line means "
                "that the residual left its band at once. Arrows carry the numbers of marks that lie off the axis; to the left are "
                "declarations made before the fault began."
            }))
        },
    )
}

/// Runs with other kinds of faults, or several at once.
fn further(study: &StudyResults) -> Markup {
    let head = html! { tr {
        th.name scope="col" { "Faults" } th.name scope="col" { "Method" }
        th scope="col" { "delay [samples]" } th scope="col" { (math("r_td [%]")) }
        th scope="col" { "false alarms" }
    } };
    let body = html! { @for row in study.further.iter().flat_map(|run| &run.detection) { tr {
        th scope="row" { (row.fault.label) }
        td.name { (row.method.label()) }
        td { (row.delay.map_or_else(|| "\u{2013}".to_owned(), |delay| delay.to_string())) }
        td { (percent(row.r_td, 1)) }
        td { (row.false_alarms) }
    } } };
    html! { @if !study.further.is_empty() { (table("Beside the twelve", &head, &body)) } }
}

fn table_1(study: &StudyResults, pictures: &[Pictures]) -> Markup {
    let head = html! {
        tr {
            th.name rowspan="3" scope="col" { "Fault" }
            th.name rowspan="3" scope="col" { "Label" }
            @for method in IN_PAPER {
                th.group.start colspan="6" scope="colgroup" { (title(method)) }
            }
        }
        tr {
            @for _ in IN_PAPER {
                th.group.start colspan="2" scope="colgroup" { (math("r_td [%]")) }
                th.group.start colspan="2" scope="colgroup" { (math("t_dt [sample]")) }
                th.group.start colspan="2" scope="colgroup" { "delay [samples]" }
            }
        }
        tr {
            @for _ in 0..3 * IN_PAPER.len() {
                th.start scope="col" { "ours" }
                th.theirs scope="col" { "paper" }
            }
        }
    };
    let faults = rows_of(&study.detection, DetectorKind::Mem);
    let body = html! {
        @for (place, row) in faults.iter().enumerate() {
            @let part = place > 0 && faults[place - 1].fault.kind != row.fault.kind;
            tr.part[part] {
                th scope="row" { (linked(&row.fault, pictures)) }
                td.name { (label(&row.fault.label)) }
                @for method in IN_PAPER {
                    (cells(study, &row.fault, method))
                }
            }
        }
    };
    table("Table 1. Detection, ours beside the paper's", &head, &body)
}

fn title(method: DetectorKind) -> String {
    let mut title = method.label().to_owned();
    title[..1].make_ascii_uppercase();
    title
}

/// The fault's name, a link to its picture where there is one.
fn linked(name: &FaultName, pictures: &[Pictures]) -> Markup {
    let place = pictures.iter().position(|picture| picture.fault.as_ref() == Some(name));
    html! {
        @if let Some(place) = place {
            a href={ "#" (picture::id(place)) } { (minus(&fault(name))) }
        } @else {
            (minus(&fault(name)))
        }
    }
}

fn row_of<'a>(
    study: &'a StudyResults,
    name: &FaultName,
    method: DetectorKind,
) -> Option<&'a DetectionRow> {
    study.detection.iter().find(|row| row.method == method && row.fault == *name)
}

/// Six cells: r_td, t_dt and delay, each ours and the paper's.
fn cells(study: &StudyResults, name: &FaultName, method: DetectorKind) -> Markup {
    let dagger = html! { span.dagger { "†" } };
    let none = html! { "\u{2013}" };
    let row = row_of(study, name, method);
    let paper = paper_row(study, &name.label, method);
    let delay = paper.map(|row| paper_delay(study, row));
    html! {
        td.start { @if let Some(row) = row { (percent(row.r_td, 1)) } @else { (none) } }
        td.theirs { @if let Some(row) = paper { (percent(row.r_td, 1)) } @else { (none) } }
        td.start {
            @match row.and_then(|row| row.t_dt.map(|t_dt| (row, t_dt))) {
                Some((row, t_dt)) => {
                    (t_dt) @if !row.detected() { (dagger) }
                }
                None => { span.alert { "none" } }
            }
        }
        td.theirs {
            @match (paper, delay) {
                (Some(row), Some(delay)) => { (row.t_dt) @if delay < 0 { (dagger) } }
                _ => { (none) }
            }
        }
        td.start {
            @match row.and_then(|row| row.delay) { Some(delay) => { (delay) } None => { (none) } }
        }
        td.theirs {
            @match delay { Some(delay) => { (minus(&delay.to_string())) } None => { (none) } }
        }
    }
}

fn delays(study: &StudyResults) -> Rows {
    let ours = |name: &FaultName, method| match row_of(study, name, method) {
        Some(row @ DetectionRow { delay: Some(delay), .. }) if row.detected() => {
            Value::Number(*delay as f64)
        }
        Some(DetectionRow { t_dt: Some(_), .. }) => Value::Missing("after a false alarm".into()),
        _ => Value::Missing("not declared".into()),
    };
    let paper = |name: &FaultName, method| match paper_row(study, &name.label, method) {
        Some(row) => Value::Number(paper_delay(study, row) as f64),
        None => Value::Missing("not in the paper".into()),
    };
    let faults = rows_of(&study.detection, DetectorKind::Mem);
    let most = study.detection.iter().filter_map(|row| row.delay).max().unwrap_or(0) as f64;
    let series = |label: &str, ink, mark, lane| Series { label: label.into(), ink, mark, lane };
    Rows {
        id: "delay-plot".into(),
        title: "Delay to declaration, each fault".into(),
        description: "One row a fault; ours and the paper's, for model error modelling and \
                      constant thresholds. The numbers are those of Table 1."
            .into(),
        axis: Axis::new("delay", "samples").from_to(0.0, (1.1 * most).max(LEAST_AXIS)),
        reference: Some((study.window as f64, format!("the rule takes {} samples", study.window))),
        series: vec![
            series("model error modelling, ours", Ink::Blue, Mark::Disc, 0),
            series("the same, paper", Ink::Blue, Mark::Circle, 0),
            series("constant thresholds, ours", Ink::Orange, Mark::Diamond, 1),
            series("the same, paper", Ink::Orange, Mark::HollowDiamond, 1),
        ],
        rows: faults
            .iter()
            .map(|row| {
                let name = &row.fault;
                let values = IN_PAPER.into_iter().flat_map(|m| [ours(name, m), paper(name, m)]);
                let title = format!("{}  {}", minus(&fault(name)), label(&name.label));
                (title, values.collect())
            })
            .collect(),
    }
}

/// The methods that the paper describes without figures for this motor.
fn others(study: &StudyResults) -> Markup {
    let caption = "The paper's other methods, of which it gives no figures";
    html! {
        (side_by_side(study, caption, &DESCRIBED))
        p.note {
            "The recurrent error model takes the place of the ARX one in (6), (7). The GMDH network "
            "(Section 2.3) brings its own intervals (19): they hold for every parameter that the healthy "
            "data allow, know no significance level, and are wider for it."
        }
    }
}

/// The detectors that the paper does not know.
fn beyond(study: &StudyResults) -> Markup {
    let of_paper = |kind: &DetectorKind| IN_PAPER.contains(kind) || DESCRIBED.contains(kind);
    let kinds: Vec<_> = DetectorKind::ALL.into_iter().filter(|kind| !of_paper(kind)).collect();
    html! {
        @if !kinds.is_empty() { (side_by_side(study, "Detectors beside the paper's", &kinds)) }
    }
}

/// Every fault under each of those methods.
fn side_by_side(study: &StudyResults, caption: &str, methods: &[DetectorKind]) -> Markup {
    let head = html! {
        tr {
            th.name rowspan="2" scope="col" { "Fault" }
            @for method in methods {
                th.group.start colspan="3" scope="colgroup" { (title(*method)) }
            }
        }
        tr {
            @for _ in methods {
                th.start scope="col" { (math("r_td [%]")) }
                th scope="col" { (math("t_dt [sample]")) }
                th scope="col" { "delay [samples]" }
            }
        }
    };
    let body = html! {
        @for row in rows_of(&study.detection, DetectorKind::Mem) {
            tr {
                th scope="row" { (minus(&fault(&row.fault))) }
                @for method in methods {
                    @let row = row_of(study, &row.fault, *method);
                    td.start { @if let Some(row) = row { (percent(row.r_td, 1)) } @else { "\u{2013}" } }
                    td {
                        @match row.and_then(|row| row.t_dt) {
                            Some(t_dt) => {
                                (t_dt)
                                @if row.is_some_and(|row| !row.detected()) { span.dagger { "†" } }
                            }
                            None => { span.alert { "none" } }
                        }
                    }
                    td {
                        @match row.and_then(|row| row.delay) {
                            Some(delay) => { (delay) }
                            None => { "\u{2013}" }
                        }
                    }
                }
            }
        }
    };
    table(caption, &head, &body)
}

/// The section on other significance levels.
pub(super) fn levels(study: &StudyResults) -> Markup {
    let head = html! {
        tr {
            th.name scope="col" { "Level" }
            th.name scope="col" { "Method" }
            th scope="col" { "detected" }
            th scope="col" { (math("lowest r_td [%]")) }
            th scope="col" { "longest delay [samples]" }
            th scope="col" { (math("r_fd [%]")) }
            th scope="col" { "false alarms" }
        }
    };
    let own = (study.beta, &study.detection, study.r_fd, study.healthy.alarms);
    let others = study.levels.iter().map(|l| (l.beta, &l.detection, l.r_fd, l.alarms));
    let body = html! {
        @for (beta, detection, r_fd, alarms) in std::iter::once(own).chain(others) {
            @for (place, method) in DetectorKind::ALL.into_iter().enumerate() {
                tr.part[place == 0] {
                    th scope="row" { (math("beta =")) " " (percent(beta, 0)) " %" }
                    td.name { (method.label()) }
                    (found(&rows_of(detection, method)))
                    td { (percent(r_fd.of(method), 2)) }
                    td { span.alert[alarms.of(method) > 0] { (alarms.of(method)) } }
                }
            }
        }
    };
    page::section(
        "levels",
        "Significance levels",
        &html! {
            (table("The same runs, bands designed for other levels", &head, &body))
            p.note { "All rows of every level and reading are in study.json." }
        },
    )
}

/// Three cells: faults found, lowest share outside, longest delay.
fn found(rows: &[&DetectionRow]) -> Markup {
    let found = rows.iter().filter(|row| row.detected()).count();
    let lowest = rows.iter().map(|row| row.r_td).fold(f64::INFINITY, f64::min);
    let longest = rows.iter().filter_map(|row| row.delay).max();
    html! {
        td.start { span.alert[found < rows.len()] { (found) " of " (rows.len()) } }
        td { @if lowest.is_finite() { (percent(lowest, 1)) } @else { "\u{2013}" } }
        td { @match longest { Some(delay) => { (delay) } None => { "\u{2013}" } } }
    }
}

/// The section on the other readings of the torque fault.
pub(super) fn readings(study: &StudyResults) -> Markup {
    page::section(
        "readings",
        "Other readings of the torque fault",
        &html! {
            p {
                "The paper raises and lowers \u{201c}motor torque\u{201d} without saying by what. "
                "The tables above read it as " (math(torque(study.torque))) "."
            }
            @if study.readings.is_empty() {
                p.note { "No other reading was run." }
            } @else {
                (readings_table(&study.readings))
                p.note { "A fault after a false alarm in its run does not count as detected." }
            }
        },
    )
}

fn readings_table(readings: &[ReadingRows]) -> Markup {
    let head = html! {
        tr {
            th.name rowspan="2" scope="col" { "Reading" }
            @for method in DetectorKind::ALL {
                th.group.start colspan="3" scope="colgroup" { (title(method)) }
            }
        }
        tr {
            @for _ in DetectorKind::ALL {
                th.start scope="col" { "detected" }
                th scope="col" { (math("lowest r_td [%]")) }
                th scope="col" { "longest delay [samples]" }
            }
        }
    };
    let body = html! {
        @for reading in readings {
            tr {
                th scope="row" { (math(torque(reading.torque))) }
                @for method in DetectorKind::ALL {
                    (found(&rows_of(&reading.detection, method)))
                }
            }
        }
    };
    table("Detection under each reading of the torque fault", &head, &body)
}
