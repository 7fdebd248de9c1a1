//! What was named of what failed: the confusion table of a method, and the sizes that it estimated.

use drivescope_scenarios::campaign::summary::{MethodSummary, NamedKind, Naming};
use maud::{Markup, html};

use super::not_learned;
use super::tables::shown;
use crate::report::page::{section, table};
use crate::report::words::number;

/// The section of a method that names faults; nothing of others.
pub(super) fn naming(method: &MethodSummary) -> Markup {
    let Some(naming) = &method.naming else { return html! {} };
    let name = &method.method;
    section(
        &format!("naming-{name}"),
        &format!("What was named: {name}"),
        &html! {
            p {
                "The first judgement within a fault, or of a false alarm where nothing fails. "
                code { "unknown" } ": no mechanism explains it; " code { "none" } ": no alarm; "
                code { "retracted" } ": every alarm was taken back; " code { "undecided" }
                ": the run ended before the alarm was judged."
            }
            @if let Some(said) = not_learned(method) { p.note { (said) "." } }
            (confusion(name, naming))
            (sizes(name, naming))
        },
    )
}

fn confusion(name: &str, naming: &Naming) -> Markup {
    let mut columns: Vec<&str> =
        naming.kinds.iter().flat_map(|kind| &kind.named).map(|it| it.what.as_str()).collect();
    columns.sort_unstable();
    columns.dedup();
    let of = |kind: &NamedKind, column: &str| {
        kind.named.iter().find(|it| it.what == column).map_or(0, |it| it.scenarios)
    };
    let head = html! {
        tr { th { "what fails" } @for column in &columns { th { (column) } } }
    };
    let body = html! {
        @for kind in &naming.kinds {
            tr {
                th scope="row" { (kind.kind) }
                @for column in &columns { td { (of(kind, column)) } }
            }
        }
    };
    table(&format!("Scenarios by what fails and what was named, {name}"), &head, &body)
}

fn sizes(name: &str, naming: &Naming) -> Markup {
    let head = html! {
        tr {
            th { "what fails" } th { "named first" } th { "within the confusion set" }
            th { "95 % interval holds the size" } th { "error of the size, rms" }
        }
    };
    let body = html! {
        @for kind in naming.kinds.iter().filter(|kind| kind.in_set.of > 0) {
            tr {
                th scope="row" { (kind.kind) } td { (shown(&kind.right)) } td { (shown(&kind.in_set)) }
                td { (shown(&kind.covered)) }
                td { (kind.size_error.map_or_else(|| "\u{2013}".to_owned(), number)) }
            }
        }
    };
    let caption = format!("Of the judged faults: name, confusion set and size, {name}");
    table(&caption, &head, &body)
}
