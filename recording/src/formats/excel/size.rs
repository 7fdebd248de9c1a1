//! How large a packed workbook is once unpacked, looked at before it is.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

use zip::ZipArchive;

use super::damaged;
use crate::budget::{Budget, MOST_NUMBERS, NUMBER_BYTES};
use crate::error::Error;

/// The part of an OpenDocument file that holds all its sheets.
const CONTENT: &str = "content.xml";
/// What a cell costs while it is held with its formula, in numbers.
const CELL: u64 = 8;
/// Columns of a sheet; repetitions beyond them are cut off by the reader.
const MOST_COLUMNS: u64 = 16_384;
/// A mark of XML is no longer; longer ones are texts.
const LONGEST_MARK: u64 = 1 << 20;

/// What a packed file holds.
pub(super) enum Content {
    Sheets,
    OpenDocument,
}

/// Sees that the parts of the archive fit into memory.
pub(super) fn check(opened: &File, file: &str) -> Result<Content, Error> {
    let mut archive = ZipArchive::new(BufReader::new(opened)).map_err(|it| damaged(file, &it))?;
    let mut budget = Budget::new(file);
    for k in 0..archive.len() {
        let part = archive.by_index_raw(k).map_err(|it| damaged(file, &it))?;
        let name = part.name().map_err(|it| damaged(file, &it))?;
        // Sheets are read as a stream, any other part as a whole.
        match name.starts_with("xl/worksheets/") || name == CONTENT {
            true if part.size() > (MOST_NUMBERS * NUMBER_BYTES) as u64 => {
                return Err(budget.too_large());
            }
            true => {}
            false => budget.take_bytes(part.size())?,
        }
    }
    match archive.by_name(CONTENT) {
        Ok(content) => {
            cells(BufReader::new(content), file, &mut budget)?;
            Ok(Content::OpenDocument)
        }
        Err(_) => Ok(Content::Sheets),
    }
}

/// Counts the cells that repetitions stand for: a row or a cell may say that it is there a
/// million times.
fn cells(mut content: impl BufRead, file: &str, budget: &mut Budget) -> Result<(), Error> {
    let (mut mark, mut row, mut rows, mut empty) = (Vec::new(), 0, 1, 0);
    loop {
        mark.clear();
        let mut part = content.by_ref().take(LONGEST_MARK);
        part.read_until(b'>', &mut mark).map_err(|it| damaged(file, &it))?;
        if mark.is_empty() {
            return Ok(());
        }
        let start = mark.iter().rposition(|byte| *byte == b'<').unwrap_or(0);
        let text = String::from_utf8_lossy(&mark[start..]);
        if text.starts_with("<table:table-row") {
            (row, empty) = (0, 0);
            rows = repeated(&text, "table:number-rows-repeated");
        } else if text.starts_with("<table:table-cell")
            || text.starts_with("<table:covered-table-cell")
        {
            let count = repeated(&text, "table:number-columns-repeated").min(MOST_COLUMNS);
            // Empty cells count once something follows them in their row.
            if text.ends_with("/>") && !text.contains("office:") && !text.contains("formula") {
                empty = (empty + count).min(MOST_COLUMNS);
            } else {
                let more = (empty + count).min(MOST_COLUMNS.saturating_sub(row));
                (row, empty) = (row + more, 0);
                budget.take_bytes(more.saturating_mul(rows).saturating_mul(8 * CELL))?;
            }
        }
    }
}

fn repeated(mark: &str, attribute: &str) -> u64 {
    let rest = mark.split_once(attribute).and_then(|(_, rest)| rest.split_once(['"', '\'']));
    let digits = rest.and_then(|(_, rest)| rest.split(['"', '\'']).next());
    digits.map_or(1, |it| it.trim().parse().unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_are_counted_before_they_are_made() {
        let counted = |text: &str| {
            let mut budget = Budget::new("a.ods");
            let before = budget.remaining();
            cells(text.as_bytes(), "a.ods", &mut budget)?;
            Ok::<_, Error>((before - budget.remaining()) as u64 / CELL)
        };
        let row = |rows: &str, cell: &str| {
            format!(
                "<table:table-row table:number-rows-repeated=\"{rows}\">{cell}</table:table-row>"
            )
        };
        let cell = "<table:table-cell table:number-columns-repeated=\"3\"/><table:table-cell \
                    office:value=\"1\"><text:p>1</text:p></table:table-cell>";
        assert_eq!(counted(&row("2", cell)).unwrap(), 8);
        assert_eq!(counted(&row("2", &cell.replace("office:value=\"1\"><", "/><"))).unwrap(), 0);
        let large = cell.replace("\"3\"", "\"16000\"");
        assert!(matches!(counted(&row("1000000", &large)), Err(Error::TooLarge { .. })));
    }
}
