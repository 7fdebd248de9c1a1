//! Whether the FMU computes what the drive computes, here and in another program.

use drivescope_scenarios::results::{DetectorKind, StudyResults};

use super::words::rows_of;
use crate::answer::block::{Align, Block, Column, HTML, Table};

/// The section. Of runs in fmpy `tools/compare_fmpy` tells, which puts its table into the slot.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let columns = vec![
        Column::new(Align::Name, "Against"),
        Column::new(Align::Number, "runs"),
        Column::new(Align::Number, "difference [-]"),
    ];
    let mut table = Table::new("FMU against other runs, greatest relative difference", columns);
    let runs = rows_of(&study.detection, DetectorKind::Mem).len();
    let native = study.fmu.max_relative_difference_native;
    table.push(vec!["native runs".into(), runs.to_string().into(), difference(native).into()]);
    let about = "Every run above is a run of the exported FMU. Native runs are those of the same drive \
                 with the same noise; differences are relative to the greatest magnitude of each signal";
    let fmpy = "Not run in fmpy: tools/compare_fmpy DIR runs the same faults there, FMI 2.0 and 3.0, and \
                adds its rows";
    vec![
        Block::In(HTML, vec![Block::Sentence(about.to_owned())]),
        Block::Table(table),
        Block::Slot { name: "fmpy", blocks: vec![Block::Note(fmpy.to_owned())] },
    ]
}

/// A relative difference: equal bits are said.
fn difference(relative: f64) -> String {
    if relative == 0.0 { "0 (equal)".into() } else { format!("{relative:.1e}") }
}
