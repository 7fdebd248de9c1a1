//! Files whose numbers are there and whose columns do not make a recording yet: what is missing,
//! and the likely ways out.

use drivescope_recording::{ColumnPreview, Error, Preview, choices, in_words};

/// Ways out of one kind that are offered at most.
const MOST_REPAIRS: usize = 4;

/// What a recording lacks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Incomplete {
    /// What is missing, a sentence.
    pub(super) missing: String,
    /// Likely ways out.
    pub(super) repairs: Vec<Repair>,
    /// Whether saying how far apart the rows lie would help.
    pub(super) asks_period: bool,
    /// The column whose unit is not one of its signal.
    pub(super) unit_of: Option<String>,
}

/// A way out, taken by a click.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Repair {
    /// Take the column as that signal in that unit; as none if the signal has no name.
    Column {
        column: String,
        signal: String,
        unit: String,
        /// What the button says.
        words: String,
    },
    /// Forget what was said of the file.
    Again,
}

impl Incomplete {
    /// What the error says is missing; nothing where no word about columns or time would help.
    pub(super) fn of(error: &Error, preview: &Preview) -> Option<Self> {
        let time = |missing: String| Self {
            repairs: preview.columns.iter().filter_map(as_time).take(MOST_REPAIRS).collect(),
            asks_period: true,
            ..Self::new(missing)
        };
        let columns =
            |missing: String, repairs: Vec<Repair>| Self { repairs, ..Self::new(missing) };
        Some(match error {
            Error::MissingTime { .. } => time(
                "No column is the time: say which one is, or how far apart the rows were sampled."
                    .to_owned(),
            ),
            Error::NoClock { jumps, rows, .. } => time(format!(
                "The time jumps {jumps} times in {rows} rows: say which other column is the time, \
                 or how far apart the rows were sampled."
            )),
            Error::TimeBackwards { .. } => time(
                "The time runs backwards from row to row: say which other column is the time, or \
                 how far apart the rows were sampled."
                    .to_owned(),
            ),
            Error::TimeNotFinite { .. } => time(
                "Most rows have no time: say which other column is the time, or how far apart the \
                 rows were sampled."
                    .to_owned(),
            ),
            Error::DuplicateColumn { name, first, second, .. } => {
                let keys = [first, second].into_iter().filter_map(|at| preview.columns.get(at - 1));
                columns(
                    format!(
                        "Columns {first} and {second} are both called `{name}`: say which one counts."
                    ),
                    keys.zip([first, second])
                        .map(|(it, at)| left_out(it, &format!("column {at}")))
                        .collect(),
                )
            }
            Error::DuplicateSignal { name, first, second, .. } => {
                let those =
                    preview.columns.iter().filter(|it| it.name == *first || it.name == *second);
                columns(
                    format!(
                        "`{first}` and `{second}` are both the {}: say which one counts.",
                        in_words(name)
                    ),
                    those.map(|it| left_out(it, &format!("`{}`", it.text))).collect(),
                )
            }
            Error::UnknownUnit { column, signal, unit, .. } => {
                let key = preview.columns.iter().find(|it| it.name == *column)?;
                let units = choices().find(|it| it.signal == signal).map(|it| it.units());
                let units = units.into_iter().flatten().take(MOST_REPAIRS);
                let known = units.map(|unit| Repair::Column {
                    column: key.key.clone(),
                    signal: signal.clone(),
                    unit: unit.to_owned(),
                    words: format!("Take `{column}` in {unit}"),
                });
                Self {
                    unit_of: Some(key.key.clone()),
                    ..columns(
                        format!(
                            "`{unit}` of column `{column}` is no unit of the {}: say its unit, or \
                             what else the column is.",
                            in_words(signal)
                        ),
                        known.chain([left_out(key, &format!("`{column}`"))]).collect(),
                    )
                }
            }
            Error::MappedColumn { column, .. } => columns(
                format!(
                    "What was said of this file before names a column `{column}`, which it does not have."
                ),
                vec![Repair::Again],
            ),
            Error::Period { period_s, .. } => columns(
                format!(
                    "It cannot be sampled every {period_s} s: that is no time within its length."
                ),
                vec![Repair::Again],
            ),
            _ => return None,
        })
    }

    fn new(missing: String) -> Self {
        Self { missing, repairs: Vec::new(), asks_period: false, unit_of: None }
    }
}

fn as_time(column: &ColumnPreview) -> Option<Repair> {
    let unit = column.as_time.clone()?;
    let words = format!("Take `{}` as time in {unit}", column.name);
    Some(Repair::Column { column: column.key.clone(), signal: "time".to_owned(), unit, words })
}

fn left_out(column: &ColumnPreview, called: &str) -> Repair {
    Repair::Column {
        column: column.key.clone(),
        signal: String::new(),
        unit: String::new(),
        words: format!("Leave out {called}"),
    }
}
