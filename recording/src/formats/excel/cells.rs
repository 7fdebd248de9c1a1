//! Cells of a sheet, as far as a recording goes, and rows made of them.

use std::io::{Read, Seek};

use calamine::{Data, DataRef, ExcelDateTime, XlsxCellReader};

const SECONDS_A_DAY: f64 = 86_400.0;
/// Columns of a sheet in Excel.
const MOST_COLUMNS: u32 = 16_384;

/// What a cell holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    Empty,
    Number(f64),
    /// Seconds since some day; only differences mean something.
    Moment(f64),
    /// Seconds.
    Duration(f64),
    Text(String),
}

/// A row with its number in the sheet; the first is 0.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) number: u32,
    pub(super) cells: Vec<Cell>,
}

impl Cell {
    /// Whether that can be a sample.
    pub(super) fn is_value(&self) -> bool {
        matches!(self, Cell::Number(_) | Cell::Moment(_) | Cell::Duration(_))
    }

    fn of_date(date: &ExcelDateTime) -> Cell {
        let seconds = date.as_f64() * SECONDS_A_DAY;
        if date.is_duration() { Cell::Duration(seconds) } else { Cell::Moment(seconds) }
    }

    fn of_iso(text: &str, kind: fn(f64) -> Cell) -> Cell {
        let seconds = if text.starts_with('P') { iso_duration(text) } else { iso_moment(text) };
        seconds.map_or_else(|| Cell::Text(text.to_owned()), kind)
    }
}

impl From<&Data> for Cell {
    fn from(data: &Data) -> Cell {
        match data {
            Data::Int(value) => Cell::Number(*value as f64),
            Data::Float(value) => Cell::Number(*value),
            Data::Bool(value) => Cell::Number(f64::from(u8::from(*value))),
            Data::String(text) => Cell::Text(text.clone()),
            Data::DateTime(date) => Cell::of_date(date),
            Data::DateTimeIso(text) => Cell::of_iso(text, Cell::Moment),
            Data::DurationIso(text) => Cell::of_iso(text, Cell::Duration),
            Data::Error(_) => Cell::Number(f64::NAN),
            Data::Empty => Cell::Empty,
        }
    }
}

impl From<&DataRef<'_>> for Cell {
    fn from(data: &DataRef<'_>) -> Cell {
        match data {
            DataRef::Int(value) => Cell::Number(*value as f64),
            DataRef::Float(value) => Cell::Number(*value),
            DataRef::Bool(value) => Cell::Number(f64::from(u8::from(*value))),
            DataRef::String(text) => Cell::Text(text.clone()),
            DataRef::SharedString(text) => Cell::Text((*text).to_owned()),
            DataRef::DateTime(date) => Cell::of_date(date),
            DataRef::DateTimeIso(text) => Cell::of_iso(text, Cell::Moment),
            DataRef::DurationIso(text) => Cell::of_iso(text, Cell::Duration),
            DataRef::Error(_) => Cell::Number(f64::NAN),
            DataRef::Empty => Cell::Empty,
        }
    }
}

/// Seconds of `2024-03-01T08:30:00.5`, counted so that differences are right.
fn iso_moment(text: &str) -> Option<f64> {
    let (date, time) = text.split_once(['T', ' ']).unwrap_or((text, "0:0:0"));
    let mut parts = date.splitn(3, '-').map(|it| it.parse::<i64>().ok());
    let (year, month, day) = (parts.next()??, parts.next()??, parts.next()??);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(0..=9999).contains(&year) {
        return None;
    }
    let mut parts = time.trim_end_matches('Z').splitn(3, ':').map(|it| it.parse::<f64>().ok());
    let (hours, minutes) = (parts.next()??, parts.next()??);
    let seconds = parts.next().unwrap_or(Some(0.0))?;
    // Years begin in March here, so that a leap day is the last one.
    let (years, months) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap_days = years.div_euclid(4) - years.div_euclid(100) + years.div_euclid(400);
    let days = 365 * years + leap_days + (153 * months + 2) / 5 + day;
    Some(days as f64 * SECONDS_A_DAY + hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Seconds of `PT01H02M03.5S`.
fn iso_duration(text: &str) -> Option<f64> {
    let (days, time) = text.strip_prefix('P')?.split_once('T')?;
    let days = if days.is_empty() { 0.0 } else { days.strip_suffix('D')?.parse().ok()? };
    let mut seconds = days * SECONDS_A_DAY;
    let mut rest = time;
    for (letter, unit) in [('H', 3600.0), ('M', 60.0), ('S', 1.0)] {
        if let Some((number, after)) = rest.split_once(letter) {
            seconds += number.parse::<f64>().ok()? * unit;
            rest = after;
        }
    }
    Some(seconds).filter(|_| rest.is_empty())
}

/// A cell with its row and column.
type Placed = ((u32, u32), Cell);

/// Rows out of a stream of cells.
pub(super) struct Rows<'a, R: Read + Seek> {
    cells: XlsxCellReader<'a, R>,
    /// The first cell of the next row.
    ahead: Option<Placed>,
    ended: bool,
}

impl<'a, R: Read + Seek> Rows<'a, R> {
    pub(super) fn new(cells: XlsxCellReader<'a, R>) -> Rows<'a, R> {
        Rows { cells, ahead: None, ended: false }
    }

    fn cell(&mut self) -> Result<Option<Placed>, String> {
        if let Some(ahead) = self.ahead.take() {
            return Ok(Some(ahead));
        }
        if self.ended {
            return Ok(None);
        }
        let next = self.cells.next_cell().map_err(|error| error.to_string())?;
        self.ended = next.is_none();
        Ok(next.map(|it| (it.get_position(), Cell::from(it.get_value()))))
    }

    fn row(&mut self) -> Result<Option<Row>, String> {
        let Some(((number, column), cell)) = self.cell()? else { return Ok(None) };
        self.ahead = Some(((number, column), cell));
        let mut cells = Vec::new();
        while let Some((position, cell)) = self.cell()? {
            if position.0 != number {
                if position.0 < number {
                    return Err(format!("row {} comes after row {}", position.0 + 1, number + 1));
                }
                self.ahead = Some((position, cell));
                break;
            }
            if position.1 >= MOST_COLUMNS {
                return Err(format!("row {} has more than {MOST_COLUMNS} columns", number + 1));
            }
            let at = position.1 as usize;
            cells.resize(cells.len().max(at + 1), Cell::Empty);
            cells[at] = cell;
        }
        Ok(Some(Row { number, cells }))
    }
}

impl<R: Read + Seek> Iterator for Rows<'_, R> {
    type Item = Result<Row, String>;

    fn next(&mut self) -> Option<Self::Item> {
        let row = self.row();
        self.ended |= row.is_err();
        row.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_differ_by_seconds() {
        let since = |a: &str, b: &str| iso_moment(b).unwrap() - iso_moment(a).unwrap();
        assert_eq!(since("2024-02-28T23:59:59.5", "2024-03-01T00:00:00"), 86_400.5);
        assert_eq!(since("2023-12-31", "2024-01-01 00:00:01Z"), 86_401.0);
        assert_eq!(since("2023-02-28", "2023-03-01"), 86_400.0);
        assert_eq!(iso_duration("PT01H02M03.5S"), Some(3723.5));
        assert_eq!(iso_duration("P1DT0.25S"), Some(86_400.25));
        for text in ["", "2024", "2024-13-01", "P", "PT1X", "PT5", "a-b-c"] {
            assert_eq!((iso_moment(text), iso_duration(text)), (None, None), "{text}");
        }
    }
}
