//! Files with rows and no names, or with names and no rows.

use super::encoding::text;
use super::fields::DELIMITERS;
use super::layout::Layout;
use super::line::{Line, longest_run};
use super::lines::Numbered;
use super::names::named;
use crate::header::NAMELESS;

/// Rows from which on a file without names is a table whose columns have numbers.
const NAMELESS_ROWS: usize = 20;
/// Share of numbers in such rows.
const MOSTLY_NUMBERS: f64 = 0.9;

/// Columns numbered from 1 on, in a file that holds rows of numbers and nothing else.
pub(super) fn nameless(seen: &[Numbered]) -> Option<Layout> {
    if seen.len() < NAMELESS_ROWS {
        return None;
    }
    DELIMITERS.iter().find_map(|delimiter| {
        let split: Vec<Line> = seen.iter().map(|line| Line::of(&line.1, *delimiter)).collect();
        let (width, rows, clean) = longest_run(&split)?;
        let all = width > 1 && rows == split.len() && clean > MOSTLY_NUMBERS;
        let names: Vec<String> = (1..=width).map(|k| format!("{NAMELESS}{k}")).collect();
        let (header, delimiter) = (names.clone(), *delimiter);
        all.then_some(Layout { header, names, delimiter, above: 0, header_at: 0, rows_from: 0 })
    })
}

/// Names of a file without a row: its last line of words, and units below it.
pub(super) fn names_alone(seen: &[Numbered]) -> Option<Layout> {
    let widest = |delimiter: &u8| {
        let split: Vec<Line> = seen.iter().map(|line| Line::of(&line.1, *delimiter)).collect();
        let at = (0..split.len()).rev().find(|k| split[*k].names())?;
        let at = if at > 0 && split[at].units() && split[at - 1].names() { at - 1 } else { at };
        let width = split[at].fields.len();
        (width > 1 || *delimiter == b',').then(|| named(&split, at, seen.len(), *delimiter))
    };
    let last = seen.len();
    DELIMITERS.iter().find_map(widest).or_else(|| {
        let names = vec![text(&seen.first()?.1).into_owned()];
        let header = names.clone();
        let (above, header_at) = (0, 0);
        Some(Layout { header, names, delimiter: b',', above, header_at, rows_from: last })
    })
}
