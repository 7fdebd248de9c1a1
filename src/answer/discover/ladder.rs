//! The ladder: what was added, and how the error fell.

use drivescope_discovery::{BothUnexplained, LadderStep, OutputFits, Unexplained};
use drivescope_plant::drive::Motion;

use crate::answer::block::{
    ALL, Align, Block, Cell, Column, HTML, Key, Media, PAGE, Picture, Plot, REPORT, Row, Table,
    WIDE,
};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::{balances, error, fit_percent, in_units_of_noise, percent};

/// A step of the ladder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Step {
    /// What was done.
    pub(crate) label: String,
    /// What the balances of the validation data leave unexplained.
    pub(crate) unexplained: BothUnexplained,
    /// Fit of each output of the validation data, %.
    pub(crate) fits: OutputFits,
    /// Error on the estimation data, in units of the noise.
    pub(crate) error: f64,
    /// Error on the validation data.
    pub(crate) validation_error: f64,
    /// How many steps of a tree stand above it.
    pub(crate) depth: usize,
}

impl From<&LadderStep> for Step {
    fn from(step: &LadderStep) -> Self {
        let added = step.added.as_ref();
        Self {
            label: added.map_or("the base, fitted".to_owned(), |it| format!("+ {it}")),
            unexplained: step.validation_unexplained,
            fits: step.validation_fit_percent.clone(),
            error: step.error,
            validation_error: step.validation_error,
            depth: 0,
        }
    }
}

/// A balance of which something is unexplained, and what every step leaves of it.
type OfBalance = (&'static str, Vec<Option<Unexplained>>);

/// The balances of which these steps tell what is unexplained.
fn by_balance(motion: Motion, steps: &[Step]) -> Vec<OfBalance> {
    let all: Vec<_> = steps.iter().map(|step| balances(motion, &step.unexplained)).collect();
    let Some(first) = all.first() else { return Vec::new() };
    let of = |place: usize| (first[place].0, all.iter().map(|it| it[place].1).collect());
    let measured = |(_, each): &OfBalance| each.iter().any(Option::is_some);
    (0..first.len()).map(of).filter(measured).collect()
}

/// Whether errors are told everywhere: where the noise is in reach, or nothing else is known.
pub(super) fn has_errors(motion: Motion, steps: &[Step]) -> bool {
    let in_reach = |step: &Step| in_units_of_noise(step.error.max(step.validation_error));
    let has_fit = |step: &Step| step.fits.values().any(Option::is_some);
    let known = !by_balance(motion, steps).is_empty() || steps.iter().any(has_fit);
    steps.iter().any(in_reach) || !known
}

/// The steps as a table, and their picture.
pub(crate) fn ladder(motion: Motion, steps: &[Step]) -> Vec<Block> {
    let mut blocks = vec![Block::Table(table(motion, steps))];
    if steps.len() > 1 {
        let figure =
            |rows| Block::Figure(Picture { plot: Plot::Rows(rows), caption: String::new() });
        let errors: Media = if has_errors(motion, steps) { HTML } else { PAGE };
        blocks.push(Block::In(errors, vec![figure(of_errors(steps))]));
        if errors == PAGE {
            blocks.push(Block::In(REPORT, vec![figure(of_unexplained(motion, steps))]));
        }
    }
    blocks
}

/// The table alone. The page has room for the errors only.
pub(crate) fn table(motion: Motion, steps: &[Step]) -> Table {
    let unexplained = by_balance(motion, steps);
    let outputs: Vec<&str> =
        steps.first().map_or(Vec::new(), |it| it.fits.keys().copied().collect());
    let errors: Media = if has_errors(motion, steps) { ALL } else { PAGE };
    let number = |heading: String, media| Column::new(Align::Number, heading).only(media);
    let mut columns = vec![Column::new(Align::Name, "Step")];
    let of = |(balance, _): &OfBalance| number(format!("Unexplained {balance}"), WIDE);
    columns.extend(unexplained.iter().map(of));
    columns.extend(outputs.iter().map(|name| number(format!("Fit of {name}"), WIDE)));
    columns.push(number("Error on estimation".to_owned(), errors));
    columns.push(number("Error on validation".to_owned(), errors));
    columns.push(Column::new(Align::Name, "What can be done").only(PAGE));
    let caption = "What the recordings that judge leave unexplained, how well the model follows \
                   them, and errors in units of the noise, floor 1";
    let mut table = Table::new(caption, columns);
    for (place, step) in steps.iter().enumerate() {
        let branch = "\u{2003}".repeat(step.depth);
        let mut cells: Vec<Cell> = vec![format!("{branch}{place}: {}", step.label).into()];
        let share = |it: &Unexplained| format!("{} %", percent(it.share, 1));
        let remainder = |(_, each): &OfBalance| each[place].as_ref().map_or("-".to_owned(), share);
        cells.extend(unexplained.iter().map(|it| remainder(it).into()));
        let fit = |name: &&str| step.fits.get(name).copied().flatten();
        cells.extend(outputs.iter().map(|it| fit(it).map_or("-".to_owned(), fit_percent).into()));
        cells.push(error(step.error).into());
        cells.push(error(step.validation_error).into());
        let key = Some(Key::Step(place));
        cells.push(Cell::of("", key.clone()));
        table.rows.push(Row { key, cells });
    }
    table
}

fn picture(
    (description, axis, reference): (&str, Axis, Option<(f64, String)>),
    series: Vec<Series>,
    rows: Vec<(String, Vec<Value>)>,
) -> Rows {
    Rows {
        id: "ladder-plot".to_owned(),
        title: "Errors, step by step".to_owned(),
        description: description.to_owned(),
        axis,
        reference,
        series,
        rows,
    }
}

fn series(label: &str, ink: Ink, mark: Mark) -> Series {
    Series { label: label.to_owned(), ink, mark, lane: 0 }
}

fn of_errors(steps: &[Step]) -> Rows {
    let row = |(number, step): (usize, &Step)| {
        let values = vec![Value::Number(step.error), Value::Number(step.validation_error)];
        (format!("{number}: {}", step.label), values)
    };
    let about = (
        "Estimation and validation error of every step of the ladder",
        Axis::new("error", "noise sd"),
        Some((1.0, "noise floor".to_owned())),
    );
    let both = vec![
        series("estimation", Ink::Blue, Mark::Disc),
        series("validation", Ink::Vermilion, Mark::HollowDiamond),
    ];
    picture(about, both, steps.iter().enumerate().map(row).collect())
}

fn of_unexplained(motion: Motion, steps: &[Step]) -> Rows {
    let unexplained = by_balance(motion, steps);
    let row = |(number, step): (usize, &Step)| {
        let value = |(_, each): &OfBalance| {
            let none = || Value::Missing("not told".to_owned());
            each[number].map_or_else(none, |it| Value::Number(100.0 * it.share))
        };
        (format!("{number}: {}", step.label), unexplained.iter().map(value).collect())
    };
    let about = (
        "What the balances leave unexplained at every step of the ladder",
        Axis::new("unexplained", "%"),
        None,
    );
    let looks = [(Ink::Blue, Mark::Disc), (Ink::Vermilion, Mark::HollowDiamond)];
    let each =
        unexplained.iter().zip(looks).map(|((balance, _), (ink, mark))| series(balance, ink, mark));
    picture(about, each.collect(), steps.iter().enumerate().map(row).collect())
}
