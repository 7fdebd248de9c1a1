//! Tables of recognition: what was answered to the symptoms of every fault.

use drivescope_scenarios::results::{IsolationTable, StudyResults};

use crate::answer::block::{Align, Block, Cell, Column, Table, Tone};
use crate::report::words::percent;

/// Share below which it reads 0.
const SHOWN: f64 = 5e-4;

/// How often the classifiers are right, for each choice of classes.
pub(super) fn summary(study: &StudyResults) -> Table {
    let column = |heading: &str| Column::new(Align::Number, heading);
    let columns = vec![
        Column::new(Align::Name, "Classes"),
        column("right [%]"),
        column("mean [%]"),
        column("unknown [%]"),
        column("QDA [%]"),
    ];
    let caption = "Isolation, lowest share of right answers (QDA: quadratic discriminant)";
    let mut table = Table::new(caption, columns);
    for (name, of) in [
        ("the paper's ten", &study.isolation_paper),
        ("those of our test", &study.isolation_merged),
        ("every fault its own", &study.isolation),
    ] {
        let right: Vec<f64> = (0..of.faults.len()).map(|fault| of.right(fault)).collect();
        let unknown = of.matrix.iter().filter_map(|row| row.last());
        let rows = right.len().max(1) as f64;
        let lowest = |shares: &[f64]| percent(shares.iter().copied().fold(1.0, f64::min), 1);
        table.push(vec![
            format!("{name} ({})", of.classes.len()).into(),
            lowest(&right).into(),
            percent(right.iter().sum::<f64>() / rows, 1).into(),
            percent(unknown.sum::<f64>() / rows, 1).into(),
            lowest(&of.discriminant).into(),
        ]);
    }
    table
}

/// Table 2 with the paper's classes, ours and the paper's; then with other classes.
pub(super) fn all(study: &StudyResults) -> Vec<Block> {
    let (paper, merged, each) = (&study.isolation_paper, &study.isolation_merged, &study.isolation);
    let ours = "Table 2. Recognition with the paper's classes, ours [%]";
    let mut blocks = vec![
        matrix(ours, paper, None),
        matrix("Table 2 of the paper [%]", paper, Some(&study.paper.isolation)),
        classes(paper),
    ];
    if study.separability.classes != study.separability.classes_paper {
        blocks.push(matrix("Recognition with the classes of our test [%]", merged, None));
        blocks.push(classes(merged));
    }
    blocks.push(matrix("Recognition with every fault a class of its own [%]", each, None));
    blocks.push(classes(each));
    blocks
}

fn symbol(class: usize) -> String {
    format!("C_{}", class + 1)
}

/// What the classes are.
fn classes(of: &IsolationTable) -> Block {
    let all = of.classes.iter().enumerate();
    let named: Vec<String> = all.map(|(k, name)| format!("{}: {name}", symbol(k))).collect();
    Block::Note(named.join("; "))
}

/// A table of shares; `paper` puts the paper's in the place of ours.
fn matrix(caption: &str, of: &IsolationTable, paper: Option<&Vec<Vec<f64>>>) -> Block {
    let answers = paper.unwrap_or(&of.matrix);
    let unknown = paper.is_none().then(|| "unknown".to_owned());
    let headings = (0..of.classes.len()).map(symbol).chain(unknown);
    let mut columns = vec![Column::new(Align::Name, "Fault")];
    columns.extend(headings.map(|heading| Column::new(Align::Number, heading)));
    let width = columns.len();
    let mut table = Table::new(caption, columns);
    for (fault, name) in of.faults.iter().enumerate() {
        let shares = answers.get(fault).map_or(&[][..], Vec::as_slice);
        let share = |(class, value): (usize, &f64)| {
            let text = if *value < SHOWN { "-".to_owned() } else { percent(*value, 1) };
            Cell::from(text).toned(Tone::Strong, of.class_of.get(fault) == Some(&class))
        };
        let mut cells = vec![name.as_str().into()];
        cells.extend(shares.iter().enumerate().map(share));
        cells.resize_with(width, || "-".into());
        table.push(cells);
    }
    Block::Table(table)
}
