//! What the columns of a file hold, told by its first rows.

use super::clock::{Stamp, stamp};
use super::column::Kind;
use super::encoding::text;
use super::fields::Fields;
use super::layout::Layout;
use super::lines::Numbered;
use super::number::{Mark, is_missing, number, with_unit};
use crate::header;
use crate::mapping::Mapping;
use crate::time_unit;

/// What every column holds, by the first rows, and the unit in its cells (or nothing).
pub(super) fn kinds(
    layout: &Layout,
    rows: &[Numbered],
    maps: &[Mapping],
) -> (Vec<Kind>, Vec<String>) {
    let mut fields = Fields::new(layout.delimiter);
    let mut cells: Vec<Vec<Vec<u8>>> = vec![Vec::new(); layout.header.len()];
    for (_, line) in rows.iter().filter(|(_, line)| !layout.is_comment(line)) {
        fields.split(line);
        for (column, cell) in cells.iter_mut().zip(fields.iter()) {
            if !is_missing(cell) {
                column.push(cell.to_vec());
            }
        }
    }
    let units: Vec<String> = cells.iter_mut().map(|cells| unit_in(cells)).collect();
    let kinds = layout.header.iter().zip(&cells).map(|(text, cells)| kind(text, cells, maps));
    let mut kinds: Vec<Kind> = kinds.collect();
    // What the columns that tell agree on holds for those that do not.
    let mark = |kind: &Kind| match kind {
        Kind::Number(mark) if *mark != Mark::Unknown => Some(*mark),
        _ => None,
    };
    let stated = kinds.iter().find_map(mark);
    let agree = kinds.iter().filter_map(mark).all(|other| Some(other) == stated);
    for kind in &mut kinds {
        if let (Kind::Number(Mark::Unknown), Some(mark), true) = (*kind, stated, agree) {
            *kind = Kind::Number(mark);
        }
    }
    (kinds, units)
}

/// The unit that stands behind every number of a column, taken off its cells.
fn unit_in(cells: &mut [Vec<u8>]) -> String {
    let unit = cells.first().and_then(|cell| with_unit(cell)).unwrap_or_default();
    let suffix = format!(" {unit}").into_bytes();
    if unit.is_empty() || !cells.iter().all(|cell| cell.ends_with(&suffix)) {
        return String::new();
    }
    cells.iter_mut().for_each(|cell| cell.truncate(cell.len() - suffix.len()));
    unit
}

fn kind(header: &str, cells: &[Vec<u8>], maps: &[Mapping]) -> Kind {
    let stamps: Vec<Stamp> = cells.iter().filter_map(|cell| stamp(&text(cell), true)).collect();
    if 2 * stamps.len() > cells.len() {
        let day_first = |cell: &Vec<u8>| {
            let text = text(cell).into_owned();
            let first = text.split('/').next().and_then(|it| it.parse::<u32>().ok());
            text.contains('/') && first.is_some_and(|first| (13..=31).contains(&first))
        };
        let dates = stamps.iter().all(|it| matches!(it, Stamp::Day(_)));
        let month_first = !cells.iter().any(day_first);
        return if dates { Kind::Date } else { Kind::Clock { month_first } };
    }
    let first = cells.first().and_then(|cell| number(cell));
    let large = first.is_some_and(|value| value.abs() >= time_unit::LEAST_EPOCH);
    if large && header::is_signal(header, "time", maps) {
        return Kind::Stamp;
    }
    Kind::Number(mark_of(cells.iter().map(Vec::as_slice)))
}

/// What the rows that were looked at say of the decimals of column `k`.
fn mark_of<'a>(cells: impl Iterator<Item = &'a [u8]>) -> Mark {
    let stated = cells.map(Mark::told_by).find(|mark| *mark != Mark::Unknown);
    stated.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_tell_kinds_marks_and_units() {
        let of = |header: &str, cells: &[&str]| {
            let mut cells: Vec<Vec<u8>> = cells.iter().map(|it| it.as_bytes().to_vec()).collect();
            let unit = unit_in(&mut cells);
            (kind(header, &cells, &[]), unit)
        };
        let number = |mark| (Kind::Number(mark), String::new());
        assert_eq!(of("u", &["1", "0.5"]), number(Mark::Point));
        assert_eq!(of("u", &["1.234", "0,5"]), number(Mark::Comma));
        assert_eq!(of("mode", &["H", "N"]), number(Mark::Unknown));
        assert_eq!(of("u", &["1,5 V", "2 V"]), (Kind::Number(Mark::Comma), "V".to_owned()));
        assert_eq!(of("u", &["1 V", "2"]).1, "");
        assert_eq!(of("time", &["1714730401.5"]).0, Kind::Stamp);
        assert_eq!(of("id", &["1714730401"]).0, Kind::Number(Mark::Unknown));
        assert_eq!(of("date", &["2024-05-03"]).0, Kind::Date);
        assert_eq!(of("t", &["12:00:01"]).0, Kind::Clock { month_first: true });
        assert_eq!(of("t", &["13/05/2024 12:00:01"]).0, Kind::Clock { month_first: false });
    }
}
