//! One column as its cells arrive: numbers, a clock, or text that is set aside at the end.

use super::clock::{DAY, Stamp, billionths, seconds, stamp};
use super::encoding::text;
use super::number::{LONGEST_NUMBER, Mark, is_missing, with_comma};
use crate::place::{Counted, Lines};
use crate::stretches::Stretches;

/// What the first rows say that a column holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Numbers, or text as it turns out.
    Number(Mark),
    /// Dates and times of day.
    Clock {
        /// Whether `05/03/2024` is the third of May.
        month_first: bool,
    },
    /// Dates without a time of day, which stand beside a clock.
    Date,
    /// Large decimal numbers of a clock, whose differences are taken before they are rounded.
    Stamp,
}

/// A column that is being read.
pub(super) struct Column {
    kind: Kind,
    /// A blank and the unit that stand behind every number.
    suffix: Vec<u8>,
    values: Vec<f64>,
    /// Cells without anything in them.
    empty: usize,
    /// Rows of words that stand for 0 and 1.
    switches: Vec<usize>,
    /// Cells that hold neither number nor gap.
    strange: Stretches,
    first_strange: String,
    /// Whether all strange cells could be hexadecimal numbers of one length.
    hexadecimal: bool,
    clock: Clock,
}

/// What became of a column.
pub(super) enum Outcome {
    /// Values, and what had to be said of them.
    Values(Vec<f64>, Vec<String>),
    /// Nothing in any cell.
    Empty,
    /// Text, with an example and its line.
    Text(String, u64),
}

/// A clock that is read as time since its first stamp.
#[derive(Default)]
struct Clock {
    first: Option<i128>,
    last: i128,
    /// What the clock lost by starting again at midnight.
    past: i128,
}

impl Column {
    /// A column of cells of one kind, with `unit` behind every number where it is not empty.
    pub(super) fn new(kind: Kind, unit: &str) -> Column {
        let suffix = if unit.is_empty() { Vec::new() } else { format!(" {unit}").into_bytes() };
        Column {
            kind,
            suffix,
            values: Vec::new(),
            empty: 0,
            switches: Vec::new(),
            strange: Stretches::default(),
            first_strange: String::new(),
            hexadecimal: true,
            clock: Clock::default(),
        }
    }

    pub(super) fn kind(&self) -> Kind {
        self.kind
    }

    /// The first stamp in billionths of its unit, for a column of [`Kind::Stamp`].
    pub(super) fn first_stamp(&self) -> Option<i128> {
        self.clock.first
    }

    pub(super) fn reserve(&mut self, more: usize) {
        self.values.reserve_exact(more);
    }

    /// The number in a cell as far as it is one before more is known of it.
    pub(super) fn quick(&self, cell: &[u8]) -> Option<f64> {
        let cell = self.bare(cell);
        match self.kind {
            Kind::Number(Mark::Comma) => with_comma(cell),
            Kind::Number(_) => std::str::from_utf8(cell).ok()?.parse().ok(),
            _ => None,
        }
    }

    /// The cell without the unit that its column carries.
    fn bare<'c>(&self, cell: &'c [u8]) -> &'c [u8] {
        cell.strip_suffix(self.suffix.as_slice()).unwrap_or(cell)
    }

    pub(super) fn push(&mut self, value: f64) {
        self.values.push(value);
    }

    /// Whether a cell holds what its column is made of; a day before midnight counts as well.
    pub(super) fn fits(&self, cell: &[u8]) -> bool {
        let cell = self.bare(cell);
        match self.kind {
            Kind::Number(mark) => !is_missing(cell) && { mark }.number(cell).is_some(),
            Kind::Clock { .. } | Kind::Date => stamp(&text(cell), true).is_some(),
            Kind::Stamp => billionths(&text(cell)).is_some(),
        }
    }

    /// Takes any cell; `day` is the date that stands in another column of the row.
    pub(super) fn push_cell(&mut self, cell: &[u8], line: u64, day: Option<i128>) {
        let row = self.values.len();
        let cell = self.bare(cell);
        self.empty += usize::from(cell.is_empty());
        let value = match &mut self.kind {
            _ if is_missing(cell) => Some(f64::NAN),
            Kind::Number(mark) => mark.number(cell),
            Kind::Clock { month_first } => {
                stamp(&text(cell), *month_first).and_then(|it| self.clock.since_first(it, day))
            }
            Kind::Date => Some(0.0),
            Kind::Stamp => billionths(&text(cell)).map(|at| {
                let first = *self.clock.first.get_or_insert(at);
                seconds(at - first)
            }),
        };
        let value = value.or_else(|| switch(cell).inspect(|_| self.switches.push(row)));
        self.values.push(value.unwrap_or_else(|| {
            let cell = text(cell);
            if self.strange.is_empty() {
                self.first_strange = cell.chars().take(LONGEST_NUMBER).collect();
            }
            self.hexadecimal &= cell.len() == self.first_strange.len()
                && cell.bytes().all(|it| it.is_ascii_hexdigit());
            self.strange.add(row, line);
            f64::NAN
        }));
    }

    /// Takes back the last row.
    pub(super) fn pop(&mut self) {
        self.values.pop();
    }

    /// What the column is, all told.
    pub(super) fn finish(mut self, name: &str, lines: &Lines) -> Outcome {
        let rows = self.values.len();
        let filled = rows - self.empty.min(rows);
        if filled == 0 && rows > 0 {
            return Outcome::Empty;
        }
        let mut notes = Vec::new();
        let words = self.strange.samples + self.switches.len();
        if self.switches.len() == filled && filled > 0 {
            notes.push(format!("column `{name}` holds words for on and off, read as 1 and 0"));
            return Outcome::Values(self.values, notes);
        }
        let identifiers =
            self.hexadecimal && self.strange.samples > 1 && self.first_strange.len() > 1;
        if 2 * words > filled || identifiers {
            let example = match self.switches.first() {
                Some(_) if self.strange.is_empty() => "words for on and off".to_owned(),
                _ => self.first_strange,
            };
            let first = self.strange.listed.first().map(|it| it.first);
            let line = first.or(self.switches.first().map(|row| lines.line(*row)));
            return Outcome::Text(example, line.unwrap_or_default());
        }
        for row in self.switches {
            self.values[row] = f64::NAN;
            self.strange.add(row, lines.line(row));
        }
        if !self.strange.is_empty() {
            let (cells, places) = (self.strange.samples, self.strange.text(Counted::Lines));
            let such = if self.first_strange.is_empty() {
                String::new()
            } else {
                format!(", such as `{}`,", self.first_strange)
            };
            let (hold, count) =
                if cells == 1 { ("cell holds", "counts") } else { ("cells hold", "count") };
            notes.push(format!(
                "column `{name}`: {cells} {hold} no number{such} and {count} as missing, {places}"
            ));
        }
        Outcome::Values(self.values, notes)
    }
}

impl Clock {
    /// Time since the first stamp, s; `None` for a date where the column has times.
    fn since_first(&mut self, stamp: Stamp, day: Option<i128>) -> Option<f64> {
        let at = match (stamp, day) {
            (Stamp::Moment(at), _) => at,
            (Stamp::Clock { at, span: DAY }, Some(day)) => day * DAY + at,
            (Stamp::Clock { at, span }, _) => {
                // Back by more than half a turn: past midnight; by less: time runs back.
                if self.first.is_some() && self.last - (at + self.past) > span / 2 {
                    self.past += span;
                }
                at + self.past
            }
            (Stamp::Day(day), _) => day * DAY,
        };
        self.last = at;
        let first = *self.first.get_or_insert(at);
        Some(seconds(at - first))
    }
}

/// 1 for a word that says on, 0 for one that says off.
fn switch(cell: &[u8]) -> Option<f64> {
    let is = |words: &[&str]| words.iter().any(|it| cell.eq_ignore_ascii_case(it.as_bytes()));
    if is(&["true", "yes", "on", "wahr", "ja", "ein", "vrai", "oui", "verdadero", "vero"]) {
        return Some(1.0);
    }
    let off = ["false", "no", "off", "falsch", "nein", "aus", "faux", "non", "falso"];
    is(&off).then_some(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(kind: Kind, cells: &[&str]) -> (Vec<f64>, Vec<String>) {
        let mut column = Column::new(kind, "");
        for (k, cell) in cells.iter().enumerate() {
            column.push_cell(cell.as_bytes(), k as u64 + 2, None);
        }
        match column.finish("a", &Lines::new("a", Counted::Lines)) {
            Outcome::Values(values, notes) => (values, notes),
            Outcome::Empty => (vec![], vec!["empty".into()]),
            Outcome::Text(example, _) => (vec![], vec![example]),
        }
    }

    const PLAIN: Kind = Kind::Number(Mark::Unknown);

    #[test]
    fn text_is_set_aside_and_a_stray_word_is_a_hole() {
        let (values, notes) = column(PLAIN, &["1", "---", "3", "OVR", "", "6"]);
        assert_eq!((values[0], values[2], values[5]), (1.0, 3.0, 6.0));
        assert!(values[1].is_nan() && values[3].is_nan() && values[4].is_nan());
        assert!(notes[0].contains("2 cells") && notes[0].contains("line 3, line 5"), "{notes:?}");
        assert_eq!(column(PLAIN, &["1", "OK", "bad"]).1, ["OK"]);
        assert_eq!(column(PLAIN, &["", "", "OK"]).1, ["OK"]);
        assert_eq!(column(PLAIN, &["", "", ""]).1, ["empty"]);
        assert_eq!(column(PLAIN, &["nan", "nan"]).0.len(), 2, "holes that are said are values");
        assert_eq!(column(PLAIN, &["0012", "1E05", "00A3", "0014", "0B15"]).1, ["00A3"]);
    }

    #[test]
    fn words_for_on_and_off_are_numbers() {
        assert_eq!(column(PLAIN, &["true", "FALSE", "", "ja"]).0[..2], [1.0, 0.0]);
        let (values, notes) = column(PLAIN, &["1", "2", "3", "off"]);
        assert!(values[3].is_nan() && notes[0].contains("line"), "{notes:?}");
    }

    #[test]
    fn a_clock_runs_on_past_midnight_and_loses_no_digit() {
        let clock = Kind::Clock { month_first: true };
        let cells = ["23:59:59.998", "23:59:59.999", "00:00:00.000", "00:00:00.001"];
        assert_eq!(column(clock, &cells).0, [0.0, 0.001, 0.002, 0.003]);
        let minutes = ["59:59.5", "00:00.0", "00:00.5"];
        assert_eq!(column(clock, &minutes).0, [0.0, 0.5, 1.0]);
        let back = ["12:00:01", "12:00:00", "12:00:02"];
        assert_eq!(column(clock, &back).0, [0.0, -1.0, 1.0]);
        let stamps = ["1714730401.123456", "1714730401.124456"];
        assert_eq!(column(Kind::Stamp, &stamps).0, [0.0, 0.001]);
    }
}
