//! Other significance levels, and other readings of the torque fault.

use drivescope_scenarios::results::{DetectionRow, DetectorKind, StudyResults};

use super::words::{false_alarms, rows_of};
use crate::answer::block::{Align, Block, Cell, Column, HTML, Table, Tone};
use crate::report::words::{given, percent, torque};

/// Headings of what [`found`] says.
const FOUND: [&str; 3] = ["detected", "least r_td [%]", "longest delay [samples]"];

/// The section on other significance levels.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let number = |heading: &str| Column::new(Align::Number, heading);
    let mut columns = vec![Column::new(Align::Name, "Method"), number("beta")];
    columns.extend(FOUND.map(number));
    columns.extend([number("r_fd [%]"), number("false alarms").only(HTML)]);
    let mut table = Table::new("All methods and levels", columns);
    let own = (study.beta, &study.detection, study.r_fd, study.healthy.alarms);
    let others = study.levels.iter().map(|l| (l.beta, &l.detection, l.r_fd, l.alarms));
    for (beta, detection, r_fd, alarms) in std::iter::once(own).chain(others) {
        table.part();
        for method in DetectorKind::ALL {
            let mut cells = vec![method.label().into(), given(beta).into()];
            cells.extend(found(&rows_of(detection, method)));
            cells.push(percent(r_fd.of(method), 2).into());
            cells.push(false_alarms(alarms.of(method)));
            table.push(cells);
        }
    }
    let about = "The same runs, with bands designed for each level: beta is the share of healthy \
                 samples outside. All rows of every level and reading are in study.json";
    vec![Block::Table(table), Block::In(HTML, vec![Block::Note(about.to_owned())])]
}

/// Faults found, lowest share outside, longest delay.
fn found(rows: &[&DetectionRow]) -> [Cell; 3] {
    let found = rows.iter().filter(|row| row.detected()).count();
    let lowest = rows.iter().map(|row| row.r_td).reduce(f64::min);
    let longest = rows.iter().filter_map(|row| row.delay).max();
    let none = || "-".to_owned();
    [
        Cell::from(format!("{found} of {}", rows.len())).toned(Tone::Alert, found < rows.len()),
        lowest.map_or_else(none, |lowest| percent(lowest, 1)).into(),
        longest.map_or_else(none, |longest| longest.to_string()).into(),
    ]
}

/// The section on the other readings of the torque fault.
pub(super) fn readings(study: &StudyResults) -> Vec<Block> {
    let mut blocks = vec![Block::Sentence(format!(
        "The paper raises and lowers \u{201c}motor torque\u{201d} without saying by what. The tables \
         above read it as {}",
        torque(study.torque)
    ))];
    if study.readings.is_empty() {
        blocks.push(Block::Note("No other reading was run".to_owned()));
    } else {
        blocks.push(Block::Table(readings_table(study)));
        let about = "A fault after a false alarm in its run does not count as detected";
        blocks.push(Block::Note(about.to_owned()));
    }
    vec![Block::In(HTML, blocks)]
}

fn readings_table(study: &StudyResults) -> Table {
    let of = |method: DetectorKind| {
        FOUND.map(|heading| Column::new(Align::Number, heading).under(method.label()))
    };
    let mut columns = vec![Column::new(Align::Words, "Reading")];
    columns.extend(DetectorKind::ALL.into_iter().flat_map(of));
    let mut table = Table::new("Detection under each reading of the torque fault", columns);
    for reading in &study.readings {
        let mut cells: Vec<Cell> = vec![torque(reading.torque).into()];
        let each = DetectorKind::ALL.into_iter();
        cells.extend(each.flat_map(|method| found(&rows_of(&reading.detection, method))));
        table.push(cells);
    }
    table
}
