//! Where in a file a sample stands.

use std::fmt;

use serde::Serialize;

/// What a file's samples are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Counted {
    /// Lines of a text file, the first is 1.
    Lines,
    /// Rows of a table without lines (Parquet, MAT), the first is 1.
    Rows,
}

/// A sample's place in a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Place {
    /// The file as the user named it.
    pub file: String,
    /// Line or row, the first is 1.
    pub at: u64,
    /// Which of the two.
    pub counted: Counted,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.counted {
            Counted::Lines => write!(f, "{}:{}", self.file, self.at),
            Counted::Rows => write!(f, "{}, row {}", self.file, self.at),
        }
    }
}

/// The line of every sample, stored as the few samples at which `line - sample` changes (after
/// blank or comment lines), so that 10^7 samples do not cost 10^7 numbers.
#[derive(Debug, Clone)]
pub(crate) struct Lines {
    file: String,
    counted: Counted,
    /// From this sample on, the first of them stands at this line.
    shifts: Vec<(usize, u64)>,
}

impl Lines {
    pub(crate) fn new(file: &str, counted: Counted) -> Lines {
        Lines { file: file.to_owned(), counted, shifts: Vec::new() }
    }

    /// Rows numbered from 1 without a gap.
    pub(crate) fn rows(file: &str) -> Lines {
        Lines { shifts: vec![(0, 1)], ..Lines::new(file, Counted::Rows) }
    }

    pub(crate) fn file(&self) -> &str {
        &self.file
    }

    pub(crate) fn counted(&self) -> Counted {
        self.counted
    }

    /// Notes that `sample` stands at `line`; samples come in rising order.
    pub(crate) fn note(&mut self, sample: usize, line: u64) {
        let follows = self.shifts.last().is_some_and(|&(k, at)| at + (sample - k) as u64 == line);
        if !follows {
            self.shifts.push((sample, line));
        }
    }

    pub(crate) fn line(&self, sample: usize) -> u64 {
        let after = self.shifts.partition_point(|&(k, _)| k <= sample);
        let (k, at) = after.checked_sub(1).map_or((0, 1), |last| self.shifts[last]);
        at + (sample - k) as u64
    }

    /// Without the samples before `first`, which becomes the first.
    pub(crate) fn from(&self, first: usize) -> Lines {
        let later = self.shifts.iter().filter(|(k, _)| *k > first);
        let later = later.map(|(k, at)| (k - first, *at));
        let shifts = std::iter::once((0, self.line(first))).chain(later).collect();
        Lines { shifts, ..self.clone() }
    }

    pub(crate) fn place(&self, sample: usize) -> Place {
        self.place_at(self.line(sample))
    }

    /// The place of a line (or row) of that number.
    pub(crate) fn place_at(&self, line: u64) -> Place {
        Place { file: self.file.clone(), at: line, counted: self.counted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_across_blank_lines() {
        let mut lines = Lines::new("a.csv", Counted::Lines);
        for (sample, line) in [(0, 2), (1, 3), (2, 6), (3, 7), (4, 9)] {
            lines.note(sample, line);
        }
        assert_eq!(lines.shifts.len(), 3);
        assert_eq!([0, 1, 2, 3, 4].map(|k| lines.line(k)), [2, 3, 6, 7, 9]);
        assert_eq!(lines.place(3).to_string(), "a.csv:7");
        assert_eq!([0, 1, 2].map(|k| lines.from(2).line(k)), [6, 7, 9]);
        assert_eq!([0, 1].map(|k| lines.from(3).line(k)), [7, 9]);
        assert_eq!(Lines::rows("b.mat").place(0).to_string(), "b.mat, row 1");
    }
}
