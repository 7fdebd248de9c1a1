//! Sizes of the symptoms, (27), beside the paper's.

use drivescope_scenarios::results::{IdentificationRow, StudyResults};

use super::words::labelled;
use crate::answer::block::{Align, Block, Column, HTML, Picture, Plot, Table};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::fault;

/// The section.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let rows = &study.identification;
    if rows.is_empty() {
        return vec![Block::In(HTML, vec![Block::Note("No sizes were computed".to_owned())])];
    }
    let caption = "S: mean of |r| over the constant threshold while the fault acts, (27). It is \
                   measured in thresholds, so a tighter threshold gives a larger S for the same fault: \
                   compare the order of the faults, not the numbers.";
    let about = "Groups are relative to the twelve faults: the three that leave the least scatter of \
                 ln S within them. The same rule applied to the paper's S gives the paper's groups";
    let picture = Picture { plot: Plot::Rows(chart(rows)), caption: caption.to_owned() };
    vec![
        Block::Figure(picture),
        Block::Table(table(rows)),
        Block::In(HTML, vec![Block::Note(about.to_owned())]),
    ]
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
                (labelled(&row.fault), vec![Value::Number(row.s), Value::Number(row.s_paper)])
            })
            .collect(),
    }
}

fn table(rows: &[IdentificationRow]) -> Table {
    let columns = vec![
        Column::new(Align::Name, "Fault"),
        Column::new(Align::Symbol, "Label"),
        Column::new(Align::Number, "S [-]"),
        Column::new(Align::Number, "paper [-]").beside(),
        Column::new(Align::Name, "group").only(HTML),
        Column::new(Align::Name, "group, paper").only(HTML).beside(),
    ];
    let mut table = Table::new("Size of the symptom, S of (27)", columns);
    for row in rows {
        table.push(vec![
            fault(&row.fault).into(),
            row.fault.label.as_str().into(),
            format!("{:.2}", row.s).into(),
            format!("{:.2}", row.s_paper).into(),
            row.group.label().into(),
            row.group_paper.label().into(),
        ]);
    }
    table
}
