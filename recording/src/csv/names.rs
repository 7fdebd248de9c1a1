//! The line that names the columns, and the names in it.

use super::clock::{Stamp, stamp};
use super::fields::BLANKS;
use super::layout::Layout;
use super::line::Line;
use crate::given::Given;
use crate::header::{NAMELESS, is_known};

/// The line above `row` that names `width` columns, and whether it names exactly those.
///
/// The last line comes first if it is long enough (its last columns may be empty); then plain text
/// before a comment, the right width before a longer line, and a near line before a far one.
pub(super) fn header_above(
    split: &[Line],
    row: usize,
    width: usize,
    delimiter: u8,
) -> Option<(usize, bool)> {
    let names = |line: &Line| match delimiter {
        BLANKS => joined_brackets(&line.fields).len(),
        _ => line.fields.len(),
    };
    let exact = |line: &Line| {
        let trailing = line.fields.last().is_some_and(String::is_empty);
        names(line) == width
            || names(line) > 1 && names(line) + 1 == width
            || names(line) == width + 1 && trailing
    };
    let longer = |line: &Line| names(line) > width && width > 1;
    let search = |comment: bool, fits: &dyn Fn(&Line) -> bool| {
        let found = |k: &usize| {
            let line = &split[*k];
            line.comment == comment && line.names() && fits(line)
        };
        (0..row).rev().find(found)
    };
    let last = (0..row).rev().find(|k| !split[*k].comment);
    let next = last.filter(|k| split[*k].names() && longer(&split[*k])).map(|at| (at, false));
    let (at, wanted) = search(false, &exact)
        .filter(|at| next.is_none_or(|(nearer, _)| nearer <= *at))
        .map(|at| (at, true))
        .or(next)
        .or_else(|| Some((search(true, &exact)?, true)))
        .or_else(|| Some((search(false, &longer)?, false)))?;
    // A line of units belongs to the names above it.
    let paired = at > 0 && split[at].units() && split[at - 1].names() && {
        !split[at - 1].units() && names(&split[at - 1]).abs_diff(names(&split[at])) <= 1
    };
    // Rows above a header are another table: then the header is not the first.
    let before = split[..at].iter().filter(|line| line.row && line.fields.len() == width).count();
    (before < 3).then_some((if paired { at - 1 } else { at }, wanted))
}

/// Names and units of the header at a line.
pub(super) fn named(split: &[Line], at: usize, row: usize, delimiter: u8) -> Layout {
    let mut names = split[at].fields.clone();
    if names.len() > 1 && names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    let mut header = names.clone();
    for (k, name) in header.iter_mut().enumerate().filter(|(_, name)| name.is_empty()) {
        *name = format!("{NAMELESS}{}", k + 1);
    }
    let mut rows_from = at + 1;
    if let Some(units) = split.get(at + 1).filter(|line| at + 1 < row && line.units()) {
        rows_from += 1;
        for (name, unit) in header.iter_mut().zip(&units.fields) {
            let unit = unit.trim_matches(['[', ']', '(', ')', '<', '>']).trim();
            if !unit.is_empty() {
                *name = format!("{name} [{unit}]");
            }
        }
    }
    let above = split[..at].iter().filter(|line| !line.comment).count();
    Layout { header, names, delimiter, above, header_at: at, rows_from }
}

/// Whether the first column has no name because it numbers the rows (as R writes them), or holds
/// the date that stands before the time at the same blank.
pub(super) fn rows_are_numbered(split: &[Line], width: usize) -> bool {
    let rows = || split.iter().filter(|line| line.row && line.fields.len() == width);
    let first = || rows().filter_map(|line| line.fields[0].parse::<i64>().ok());
    let counted = first().count() == rows().count();
    let dated = rows().all(|line| matches!(stamp(&line.fields[0], true), Some(Stamp::Day(_))));
    dated || counted && first().zip(first().skip(1)).all(|(a, b)| b == a + 1)
}

/// `time [s] u [V]` parted at blanks is two names.
pub(super) fn joined_brackets(fields: &[String]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for field in fields {
        let open = names.last().is_some_and(|name| {
            let count = |marks: [char; 2]| name.matches(marks).count();
            count(['[', '(']) > count([']', ')'])
        });
        match names.last_mut() {
            Some(name) if open || field.starts_with(['[', '(']) => *name += &format!(" {field}"),
            _ => names.push(field.clone()),
        }
    }
    names
}

/// Names parted at blanks of which some hold a blank themselves, so that there are more than
/// `width`: what means a signal together, with its unit, is one. Nothing where several ways mean
/// as much.
pub(super) fn joined_names(mut names: Vec<String>, width: usize) -> Option<Vec<String>> {
    let worth = |name: &str| match is_known(name, &[]) {
        true => 1 + i32::from(Given::of(name).unit.is_some()),
        false => 0,
    };
    while names.len() > width {
        let open = |k: &usize| !names[*k].ends_with([']', ')']);
        let joined = |k: usize| format!("{} {}", names[k], names[k + 1]);
        let gain = |k: usize| worth(&joined(k)) - worth(&names[k]) - worth(&names[k + 1]);
        let gains: Vec<(i32, usize)> =
            (0..names.len() - 1).filter(open).map(|k| (gain(k), k)).collect();
        let (most, at) = gains.iter().copied().max()?;
        if gains.iter().filter(|(gain, _)| *gain == most).count() > 1 {
            return None;
        }
        names[at] = joined(at);
        names.remove(at + 1);
    }
    Some(names)
}
