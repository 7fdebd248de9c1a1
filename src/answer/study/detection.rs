//! Table 1: detection of each fault, beside the paper's; the delays as a picture; other detectors and
//! other kinds of faults.

use drivescope_scenarios::results::{
    DESCRIBED, DetectionRow, DetectorKind, FaultName, IN_PAPER, PaperRow, Pictures, StudyResults,
};

use super::runs;
use super::words::{false_alarms, labelled, paper_delay, paper_row, row_of, rows_of};
use crate::answer::block::{
    Align, Block, Cell, Column, HTML, Key, Picture, Plot, Said, Table, Tone,
};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::{fault, given, percent};

/// The axis of delays reaches at least so far, samples: twice the usual rule and some more.
const LEAST_AXIS: f64 = 120.0;

/// The section.
pub(super) fn blocks(study: &StudyResults, pictures: &[Pictures]) -> Vec<Block> {
    let about = format!(
        "r_td: share of faulty samples outside the threshold. t_dt: sample of the declaration, which \
         counts for the fault if most of its run of {0} samples lies in it: chance may put it before \
         the fault's begin + {0}. After a false alarm a fault does not count as detected (the \
         paper's: declared before its begin). Sizes are of the sensor or mechanism that fails; the \
         label is the paper's",
        study.window
    );
    vec![
        Block::Table(table_1(study, pictures)),
        Block::Note(format!(
            "t_dt and delay in samples of {} ms; in brackets: after a false alarm",
            given(1e3 * study.drive.period_s)
        )),
        Block::In(HTML, [Block::Note(about)].into_iter().chain(others(study)).collect()),
        Block::Table(further(study)),
        Block::In(HTML, vec![picture(study)]),
    ]
}

/// What is told of a method under a fault, and what the paper tells.
fn columns(method: DetectorKind, with_paper: bool) -> Vec<Column> {
    let of = |heading: &str| {
        let ours = Column::new(Align::Number, heading).under(method.label());
        let paper = Column::new(Align::Number, "paper").under(method.label()).beside();
        [ours].into_iter().chain(with_paper.then_some(paper))
    };
    ["r_td [%]", "t_dt", "delay"].into_iter().flat_map(of).collect()
}

fn table_1(study: &StudyResults, pictures: &[Pictures]) -> Table {
    let mut all = vec![Column::new(Align::Name, "Fault"), Column::new(Align::Symbol, "Label")];
    all.extend(IN_PAPER.into_iter().flat_map(|method| columns(method, true)));
    let mut table = Table::new("Table 1", all);
    let faults = rows_of(&study.detection, DetectorKind::Mem);
    for (place, row) in faults.iter().enumerate() {
        if place > 0 && faults[place - 1].fault.kind != row.fault.kind {
            table.part();
        }
        let run = pictures.iter().position(|picture| picture.fault.as_ref() == Some(&row.fault));
        let key = run.map(|run| Key::Anchor(runs::id(run)));
        let name = Cell::of(fault(&row.fault), key);
        let mut cells = vec![name, row.fault.label.as_str().into()];
        for method in IN_PAPER {
            let ours = of_row(row_of(study, &row.fault, method));
            let paper = of_paper(study, paper_row(study, &row.fault.label, method));
            cells.extend(ours.into_iter().zip(paper).flat_map(|(ours, paper)| [ours, paper]));
        }
        table.push(cells);
    }
    table
}

fn none() -> Cell {
    "-".into()
}

/// Share outside, declaration and delay of a row of ours.
fn of_row(row: Option<&DetectionRow>) -> [Cell; 3] {
    let Some(row) = row else { return [none(), none(), none()] };
    let [t_dt, delay] = match (row.t_dt, row.delay) {
        (Some(t_dt), Some(delay)) if row.detected() => {
            [t_dt.to_string().into(), delay.to_string().into()]
        }
        (Some(t_dt), _) => [format!("({t_dt})").into(), none()],
        (None, _) => [Cell::from("none").toned(Tone::Alert, true), none()],
    };
    [percent(row.r_td, 1).into(), t_dt, delay]
}

/// The same of a row of the paper.
fn of_paper(study: &StudyResults, row: Option<&PaperRow>) -> [Cell; 3] {
    let Some(row) = row else { return [none(), none(), none()] };
    let [t_dt, delay] = match paper_delay(study, row) {
        early if early < 0 => [format!("({})", row.t_dt).into(), none()],
        delay => [row.t_dt.to_string().into(), delay.to_string().into()],
    };
    [percent(row.r_td, 1).into(), t_dt, delay]
}

/// The methods of which the paper gives no figures, and those that it does not know.
fn others(study: &StudyResults) -> Vec<Block> {
    let about = "The recurrent error model takes the place of the ARX one in (6), (7). The GMDH \
                 network (Section 2.3) brings its own intervals (19): they hold for every parameter \
                 that the healthy data allow, know no significance level, and are wider for it";
    let caption = "The paper's other methods, of which it gives no figures";
    let described = Block::Table(side_by_side(study, caption, &DESCRIBED));
    let mut blocks = vec![described, Block::Note(about.to_owned())];
    let of_paper = |kind: &DetectorKind| IN_PAPER.contains(kind) || DESCRIBED.contains(kind);
    let kinds: Vec<_> = DetectorKind::ALL.into_iter().filter(|kind| !of_paper(kind)).collect();
    if !kinds.is_empty() {
        blocks.push(Block::Table(side_by_side(study, "Detectors beside the paper's", &kinds)));
    }
    blocks
}

/// Every fault under each of those methods.
fn side_by_side(study: &StudyResults, caption: &str, methods: &[DetectorKind]) -> Table {
    let mut all = vec![Column::new(Align::Name, "Fault")];
    all.extend(methods.iter().flat_map(|method| columns(*method, false)));
    let mut table = Table::new(caption, all);
    for row in rows_of(&study.detection, DetectorKind::Mem) {
        let mut cells: Vec<Cell> = vec![fault(&row.fault).into()];
        cells.extend(methods.iter().flat_map(|it| of_row(row_of(study, &row.fault, *it))));
        table.push(cells);
    }
    table
}

/// Runs with other kinds of faults, or several at once.
fn further(study: &StudyResults) -> Table {
    let name = |heading| Column::new(Align::Name, heading);
    let number = |heading| Column::new(Align::Number, heading);
    let columns: &[(Column, Said<&DetectionRow>)] = &[
        (name("Faults"), |row| row.fault.label.as_str().into()),
        (name("Method"), |row| row.method.label().into()),
        (number("delay"), |row| {
            let delay = row.delay.map_or_else(|| "none".to_owned(), |delay| delay.to_string());
            Cell::from(delay).toned(Tone::Alert, row.delay.is_none())
        }),
        (number("r_td [%]"), |row| percent(row.r_td, 1).into()),
        (number("false alarms"), |row| false_alarms(row.false_alarms)),
    ];
    let rows = study.further.iter().flat_map(|run| &run.detection);
    Table::of("Beside the twelve: delay in samples, share outside [%]", columns, rows)
}

fn picture(study: &StudyResults) -> Block {
    let caption = "Delay from the fault's begin to its declaration. A mark near the dashed line means \
                   that the residual left its band at once. Arrows carry the numbers of marks that lie \
                   off the axis; to the left are declarations made before the fault began";
    Block::Figure(Picture { plot: Plot::Rows(delays(study)), caption: caption.to_owned() + "." })
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
                (labelled(name), values.collect())
            })
            .collect(),
    }
}
