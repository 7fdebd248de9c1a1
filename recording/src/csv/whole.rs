//! A whole file as columns: what is no row is left out with a word, what is no number set aside.

use std::io::Read;

use drivescope_units::is_counts;

use super::body::Body;
use super::column::{Kind, Outcome};
use super::fields::Fields;
use super::first_lines;
use super::kinds::kinds;
use super::lines::LineReader;
use super::settings::{Setting, counts_a_revolution, period_s, settings};
use crate::budget::Budget;
use crate::error::Error;
use crate::given::Given;
use crate::header;
use crate::mapping::ReadOptions;
use crate::table::Table;
use crate::time_unit;

/// Rows after which their mean length tells how many are to come.
const ROWS_TO_ESTIMATE: usize = 1000;

/// Reads columns and what is to be said of them.
pub(super) fn read(
    reader: impl Read,
    name: &str,
    bytes: Option<u64>,
    options: &ReadOptions,
) -> Result<Table, Error> {
    let mut lines = LineReader::new(reader, name)?;
    let (layout, mut seen) = first_lines::of_file(&mut lines)?;
    let settings = settings(&seen[..layout.header_at]);
    let header_line = seen.get(layout.header_at).map_or(0, |line| line.0);
    let utf_8 = seen.iter().all(|(_, line)| std::str::from_utf8(line).is_ok());
    let rows = seen.split_off(layout.rows_from.min(seen.len()));
    let (kinds, units) = kinds(&layout, &rows, &options.columns);
    lines.give_again(rows);
    let mut body = Body::new(&layout, kinds, &units, name, &options.columns);
    let mut fields = Fields::new(layout.delimiter);
    let mut budget = Budget::new(name);
    while let Some((line, content)) = lines.next()? {
        if content.first().is_some_and(|byte| !byte.is_ascii_digit()) && layout.is_comment(content)
        {
            continue;
        }
        fields.split(content);
        budget.take(body.columns.len())?;
        body.take(&fields, line);
        if body.count == ROWS_TO_ESTIMATE
            && let Some(bytes) = bytes
        {
            let total = (bytes as f64 / lines.bytes() as f64 * body.count as f64) as usize;
            // One in a hundred more than expected: later numbers may be written shorter.
            let more = (total + total / 100).saturating_sub(body.count);
            body.reserve(more.min(budget.remaining() / body.columns.len().max(1)));
        }
    }
    let mut notes = Vec::new();
    if layout.above > 0 {
        let above = layout.above;
        notes.push(format!("line {header_line} is the header; {above} lines above it are skipped"));
    }
    if !utf_8 {
        notes.push("the text is not UTF-8: read as Windows-1252".to_owned());
    }
    table_of(body, &settings, &units, options, notes)
}

/// The columns of the rows that were taken, and what is to be said of them.
fn table_of(
    mut body: Body<'_>,
    settings: &[Setting],
    units: &[String],
    options: &ReadOptions,
    mut notes: Vec<String>,
) -> Result<Table, Error> {
    let mut left_out = Vec::new();
    body.leave_out_rows(&mut left_out, &mut notes)?;
    let Body { layout, columns, lines, count, date, repeats, .. } = body;
    let file = lines.file().to_owned();
    let has_time = layout.header.iter().any(|it| header::is_signal(it, "time", &options.columns));
    let mut clock_is_time = !has_time;
    let (mut header, mut kept) = (Vec::new(), Vec::new());
    for (k, (column, text)) in columns.into_iter().zip(&layout.header).enumerate() {
        let name = Given::of(text).name;
        let (kind, first) = (column.kind(), column.first_stamp());
        let values = match column.finish(&name, &lines) {
            Outcome::Values(values, mut more) => {
                notes.append(&mut more);
                values
            }
            Outcome::Empty => {
                left_out.push(format!("column `{name}` is empty"));
                continue;
            }
            Outcome::Text(example, line) => {
                if options.columns.iter().any(|map| map.foreign == name) {
                    let place = lines.place_at(line);
                    let (position, column) = (k + 1, name);
                    return Err(Error::NotANumber { place, position, column, text: example });
                }
                left_out.push(format!("column `{name}` holds text, such as `{example}`"));
                continue;
            }
        };
        match kind {
            Kind::Date if date == Some(k) => {
                notes.push(format!("column `{name}` is the date of the clock beside it"));
                continue;
            }
            Kind::Date => {
                left_out.push(format!("column `{name}` holds dates without a time of day"));
                continue;
            }
            Kind::Clock { .. } => {
                notes.push(format!("column `{name}` is a clock, read as s since its first row"));
                let named = if std::mem::take(&mut clock_is_time) { "time" } else { &name };
                header.push(format!("{named} [s]"));
            }
            Kind::Stamp => {
                let unit = Given::of(text).unit.is_some();
                let (unit, stated) = time_unit::stamps(&name, unit, first, &values);
                notes.push(stated);
                header.push(unit.map_or(text.clone(), |unit| format!("{name} [{unit}]")));
            }
            Kind::Number(_) if !units[k].is_empty() && Given::of(text).unit.is_none() => {
                notes.push(format!("column `{name}` has its unit in every cell: {}", units[k]));
                header.push(format!("{name} [{}]", units[k]));
            }
            Kind::Number(_) => header.push(with_counts(text, settings, &mut notes)),
        }
        kept.push(values);
    }
    if repeats > 0 {
        // Whether another run begins there, time tells.
        notes.push(format!("the header stands {} times", repeats + 1));
    }
    let has_time = has_time || !clock_is_time;
    let period_s = period_s(settings).filter(|_| !has_time);
    if let Some(period_s) = period_s {
        notes.push(format!(
            "no column is the time: sampled every {period_s} s, as told above the header"
        ));
    }
    if header.is_empty() && count > 0 {
        return Err(Error::NoSignals { file });
    }
    let columns = kept;
    Ok(Table { header, columns, left_out, notes, period_s, ..Table::new(lines) })
}

/// The header of a column of counts with the counts a revolution that stand above it.
fn with_counts(text: &str, settings: &[Setting], notes: &mut Vec<String>) -> String {
    let Given { name, unit, .. } = Given::of(text);
    let unit = unit.filter(|unit| is_counts(unit));
    let (Some(unit), Some(counts)) = (unit, counts_a_revolution(settings)) else {
        return text.to_owned();
    };
    notes.push(format!("column `{name}`: {counts} {unit} a revolution, as told above the header"));
    format!("{name} [counts/{counts}]")
}
