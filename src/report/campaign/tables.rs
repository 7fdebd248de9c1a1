//! The tables of a campaign's report.

use drivescope_scenarios::campaign::summary::{MethodSummary, SizeRow, Summary, Worst};
use drivescope_scenarios::parity::{Share, Spread};
use maud::{Markup, html};

use super::rerun;
use crate::report::page::{figure, math, section, table};
use crate::report::words::{count, number, percent};

/// A share with its interval.
pub(super) fn shown(share: &Share) -> String {
    let [low, high] = share.interval;
    match share.of {
        0 => "\u{2013}".to_owned(),
        of => format!("{}/{of}, {} to {} %", share.hits, percent(low, 1), percent(high, 1)),
    }
}

fn spread(spread: &Spread, shown: impl Fn(f64) -> String) -> String {
    match spread.mean.is_finite() {
        false => "\u{2013}".to_owned(),
        true => {
            let [low, high] = spread.range.map(&shown);
            format!("{} ({low} to {high})", shown(spread.mean))
        }
    }
}

fn range(row: &SizeRow) -> String {
    match row.from == row.to {
        true => number(row.from),
        false => format!("{} to {}", number(row.from), number(row.to)),
    }
}

/// Detection and delay of a method, with its figure.
pub(super) fn detection(method: &MethodSummary, drawn: Option<String>) -> Markup {
    let name = &method.method;
    let head = html! {
        tr {
            th { "kind" } th { "magnitude" } th { "detected" }
            th { "delay, mean (5 to 95 %) [s]" }
        }
    };
    let body = html! {
        @for kind in &method.kinds {
            @for row in &kind.sizes {
                tr {
                    th scope="row" { (kind.kind) } td { (range(row)) } td { (shown(&row.detected)) }
                    td { (spread(&row.delay_s, |it| format!("{it:.3}"))) }
                }
            }
        }
    };
    let caption = format!("Detection and delay by kind and magnitude, {name}");
    section(
        &format!("detection-{name}"),
        &format!("Detection: {name}"),
        &html! {
            @if let Some(svg) = drawn {
                (figure(
                    &format!("detection-{name}-figure"),
                    svg,
                    &format!("Detection against size, {name}"),
                    &html! { "Share of scenarios in which the fault was declared." },
                ))
            }
            @if method.kinds.is_empty() { p.note { "No scenario has a fault." } }
            @else { (table(&caption, &head, &body)) }
        },
    )
}

/// False alarms of all methods.
pub(super) fn false_alarms(summary: &Summary) -> Markup {
    let head = html! {
        tr {
            th { "method" } th { "false alarms" } th { "health judged [h]" }
            th { "one in [h]" } th { "scenarios without any" } th { (math("r_fd, mean (5 to 95 %) [%]")) }
        }
    };
    let body = html! {
        @for method in &summary.methods {
            tr {
                th scope="row" { (method.method) } td { (method.false_alarms) }
                td { (number(method.healthy_hours)) }
                td { @if method.false_alarms == 0 { "\u{2013}" } @else { (number(method.hours_between())) } }
                td { (shown(&method.silent)) }
                td { (spread(&method.outside_healthy, |it| percent(it, 2))) }
            }
        }
    };
    let caption = "Declarations before a fault, or without one";
    section("false-alarms", "False alarms", &table(caption, &head, &body))
}

/// What detection and delay depend on.
pub(super) fn sensitivity(summary: &Summary) -> Markup {
    let index = |it: Option<f64>| it.map_or("\u{2013}".to_owned(), |it| format!("{it:.3}"));
    let head = html! { tr { th { "method" } th { "input" } th { "detected" } th { "delay" } } };
    let body = html! {
        @for method in &summary.methods {
            @for row in &method.sensitivity {
                tr {
                    th scope="row" { (method.method) } td { (row.input) }
                    td { (index(row.detected)) } td { (index(row.delay)) }
                }
            }
        }
    };
    section(
        "sensitivity",
        "What it depends on",
        &html! {
            p {
                "First-order Sobol indices: the share of the variance of \u{201c}detected\u{201d} (over \
                 faulty scenarios) and of the delay (over detected ones) that one input explains. \
                 Estimated by the correlation ratio over groups of equal values, or 16 of equal counts, \
                 less what chance gives (Kelley). What they leave is interaction and noise."
                @if summary.every > 1 { " One scenario in " (summary.every) " was taken." }
            }
            (table("First-order indices of each input", &head, &body))
        },
    )
}

/// The scenarios that are worth a look.
pub(super) fn worst(summary: &Summary, plan: &str) -> Markup {
    let head = html! {
        tr {
            th { "method" } th { "what" } th { "scenario" } th { "fault" } th { "command" }
        }
    };
    let what = |worst: &Worst| match (worst.what, worst.value) {
        ("late", Some(delay)) => format!("declared after {delay:.3} s"),
        ("false_alarms", Some(alarms)) => count(alarms as usize, "false alarm"),
        _ => "missed".to_owned(),
    };
    let fault = |worst: &Worst| match (&worst.kind, worst.size) {
        (Some(kind), Some(size)) => format!("{kind} of {}", number(size)),
        (Some(kind), None) => kind.clone(),
        (None, _) => "none".to_owned(),
    };
    let body = html! {
        @for method in &summary.methods {
            @for worst in &method.worst {
                tr {
                    th scope="row" { (method.method) } td { (what(worst)) } td { (worst.scenario) }
                    td { (fault(worst)) } td { code { (rerun(plan, worst.scenario)) } }
                }
            }
        }
    };
    section(
        "worst",
        "Scenarios worth a look",
        &html! {
            p { "The greatest missed fault of each kind, the latest declarations, the most false \
                 alarms. The command runs one again; with " code { "-o REC.csv" } " it keeps its signals." }
            (table("Worst scenarios of each method", &head, &body))
        },
    )
}

/// Scenarios without result.
pub(super) fn set_aside(summary: &Summary) -> Markup {
    let list = |numbers: &[u64]| numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    html! {
        @if !summary.not_finite.is_empty() {
            p.note { "The state grew without bound in scenarios " (list(&summary.not_finite)) "." }
        }
        @if !summary.aborted.is_empty() {
            p.note {
                "Scenarios that ended the process which ran them: " (list(&summary.aborted)) "."
            }
        }
    }
}
