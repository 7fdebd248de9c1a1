//! One line of a text file: a row, names, units or a comment?

use drivescope_units::Unit;

use super::clock::stamp;
use super::encoding::text;
use super::fields::Fields;
use super::number::{is_missing, number, with_unit};

/// Marks that make a line a comment.
const COMMENTS: [&[u8]; 3] = [b"#", b"%", b"//"];

/// One line under one delimiter.
pub(super) struct Line {
    pub(super) fields: Vec<String>,
    pub(super) comment: bool,
    /// Whether it holds numbers as a row does.
    pub(super) row: bool,
    /// Share of its fields that hold numbers or nothing.
    pub(super) clean: f64,
}

impl Line {
    pub(super) fn of(line: &[u8], delimiter: u8) -> Line {
        let comment = uncommented(line, delimiter);
        let mut splitter = Fields::new(delimiter);
        splitter.split(comment.unwrap_or(line));
        let (mut solid, mut missing) = (0, 0);
        for field in splitter.iter() {
            let time = || stamp(&text(field), true).is_some();
            match is_missing(field) {
                true => missing += 1,
                false => {
                    let value = || number(field).is_some() || with_unit(field).is_some();
                    solid += usize::from(value() || time());
                }
            }
        }
        let width = splitter.len();
        // Text beside the numbers is frequent; a name and a number are a setting, not a row.
        let row = comment.is_none() && solid > 0 && 3 * (solid + missing) >= width;
        Line {
            fields: splitter.iter().map(|field| text(field).into_owned()).collect(),
            comment: comment.is_some(),
            row: row && (width > 1 || solid == 1),
            clean: (solid + missing) as f64 / width.max(1) as f64,
        }
    }

    /// Whether the line could name columns: words, and no number in it.
    pub(super) fn names(&self) -> bool {
        let word = |field: &&String| field.chars().any(char::is_alphabetic);
        let numbers = self.fields.iter().any(|field| {
            number(field.as_bytes()).is_some_and(f64::is_finite)
                || stamp(field, true).is_some()
                || with_unit(field.as_bytes()).is_some()
        });
        let words = self.fields.iter().filter(word).count();
        // A last name may be missing behind a trailing delimiter.
        !numbers && words > 0 && 2 * words + 1 >= self.fields.len()
    }

    /// Whether the line holds units of the names above it.
    pub(super) fn units(&self) -> bool {
        let bare = |field: &String| field.trim_matches(['[', ']', '(', ')', '<', '>']).to_owned();
        let filled: Vec<String> =
            self.fields.iter().map(bare).filter(|field| !field.is_empty()).collect();
        let known = filled.iter().filter(|field| Unit::parse(field).is_some()).count();
        let numbers = filled.iter().any(|it| number(it.as_bytes()).is_some_and(f64::is_finite));
        known > 0 && 2 * known >= filled.len() && !numbers
    }
}

/// The text of a comment, without its mark.
pub(super) fn uncommented(line: &[u8], delimiter: u8) -> Option<&[u8]> {
    let line = line.trim_ascii_start();
    let semicolon = (delimiter != b';').then_some(&b";"[..]);
    COMMENTS.into_iter().chain(semicolon).find_map(|mark| line.strip_prefix(mark))
}

/// Width, length and share of numbers of the longest run of rows of one width.
pub(super) fn longest_run(split: &[Line]) -> Option<(usize, usize, f64)> {
    let mut best: Option<(usize, usize, f64)> = None;
    let mut from = 0;
    while from < split.len() {
        let width = split[from].fields.len();
        let same = |line: &&Line| line.comment || line.row && line.fields.len() == width;
        let length = split[from..].iter().take_while(same).count();
        if split[from].row {
            let rows = split[from..from + length].iter().filter(|line| line.row);
            let (count, sum) = rows.fold((0, 0.0), |(k, sum), line| (k + 1, sum + line.clean));
            if best.is_none_or(|(_, other, _)| count > other) {
                best = Some((width, count, sum / count as f64));
            }
        }
        from += length.max(1);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_row_or_names_or_units_or_none_of_them() {
        let stated = |text: &str, delimiter: u8| {
            let line = Line::of(text.as_bytes(), delimiter);
            (line.row, line.names(), line.units())
        };
        for (text, row, names, units) in [
            ("0;1,5;H", true, false, false),
            ("12:00:01;1 V;", true, false, false),
            ("time;u;i", false, true, false),
            ("s;V;A", false, true, true),
            ("[s];[V];", false, true, true),
            ("End;;;", false, false, false),
            ("# 0;1", false, false, false),
            ("----;----", false, false, false),
            ("Title", false, true, false),
        ] {
            assert_eq!(stated(text, b';'), (row, names, units), "{text}");
        }
        assert!(uncommented(b"; note", b',').is_some() && uncommented(b";1", b';').is_none());
    }
}
