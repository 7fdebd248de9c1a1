//! Sizes of the symptoms, (27), beside the paper's.

use drivescope_scenarios::results::{IdentificationRow, StudyResults};
use maud::{Markup, html};

use crate::report::page::{self, figure, label, minus, table};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::fault;

/// The section.
pub(super) fn section(study: &StudyResults) -> Markup {
    let rows = &study.identification;
    page::section(
        "identification",
        "Size of the symptom (Table 3 of the paper)",
        &html! {
            @if rows.is_empty() {
                p.note { "No sizes were computed." }
            } @else {
                (figure("sizes", chart(rows).svg(), "Sizes of the symptoms", &html! {
                    "S: mean of |r| over the constant threshold while the fault acts, (27). It is "
                    "measured in thresholds, so a tighter threshold gives a larger S for the same "
                    "fault: compare the order of the faults, not the numbers."
                }))
                (data(rows))
                p.note {
                    "Groups are relative to the twelve faults: the three that leave the least scatter of "
                    "ln S within them. The same rule applied to the paper's S gives the paper's groups."
                }
            }
        },
    )
}

fn chart(rows: &[IdentificationRow]) -> Rows {
    let series =
        |label: &str, mark, lane| Series { label: label.into(), ink: Ink::Blue, mark, lane };
    Rows {
        id: "sizes-plot".into(),
        title: "Size of the symptom S, each fault".into(),
        description: "One row a fault: ours and the paper's, as bars. The numbers are in the \
                      table below."
            .into(),
        axis: Axis::new("S", "thresholds"),
        reference: None,
        series: vec![series("ours", Mark::Bar, 0), series("paper", Mark::HollowBar, 1)],
        rows: rows
            .iter()
            .map(|row| {
                let name = format!("{}  {}", minus(&fault(&row.fault)), label(&row.fault.label));
                (name, vec![Value::Number(row.s), Value::Number(row.s_paper)])
            })
            .collect(),
    }
}

fn data(rows: &[IdentificationRow]) -> Markup {
    let head = html! {
        tr {
            th.name scope="col" { "Fault" }
            th.name scope="col" { "Label" }
            th scope="col" { "S, ours [\u{2013}]" }
            th.theirs scope="col" { "S, paper [\u{2013}]" }
            th.name scope="col" { "group, ours" }
            th.name.theirs scope="col" { "group, paper" }
        }
    };
    let body = html! {
        @for row in rows {
            tr {
                th scope="row" { (minus(&fault(&row.fault))) }
                td.name { (label(&row.fault.label)) }
                td { (format!("{:.2}", row.s)) }
                td.theirs { (format!("{:.2}", row.s_paper)) }
                td.name { (row.group.label()) }
                td.name.theirs { (row.group_paper.label()) }
            }
        }
    };
    table("Size of the symptom S, ours beside the paper's", &head, &body)
}
