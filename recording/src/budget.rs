//! How much memory a recording may ask for, whatever its file says.

use crate::error::Error;

/// Numbers that all columns of a recording may hold together: 1.6 GB. Packed files can claim any
/// size, so that readers ask before they allocate, not after; so does what makes recordings, for what
/// is written is to be read again.
pub const MOST_NUMBERS: usize = 200_000_000;
/// Bytes of one number.
pub(crate) const NUMBER_BYTES: usize = size_of::<f64>();

/// What is left of the memory for one file.
#[derive(Debug)]
pub(crate) struct Budget {
    file: String,
    remaining: usize,
}

impl Budget {
    pub(crate) fn new(file: &str) -> Budget {
        Budget { file: file.to_owned(), remaining: MOST_NUMBERS }
    }

    /// Numbers that may still be taken.
    pub(crate) fn remaining(&self) -> usize {
        self.remaining
    }

    /// Takes room for so many numbers.
    pub(crate) fn take(&mut self, numbers: usize) -> Result<(), Error> {
        self.remaining = self.remaining.checked_sub(numbers).ok_or_else(|| self.too_large())?;
        Ok(())
    }

    /// Takes room for a table of so many rows and columns.
    pub(crate) fn take_table(&mut self, rows: usize, columns: usize) -> Result<(), Error> {
        self.take(rows.checked_mul(columns).ok_or_else(|| self.too_large())?)
    }

    /// Takes room for so many bytes.
    pub(crate) fn take_bytes(&mut self, bytes: u64) -> Result<(), Error> {
        let numbers = usize::try_from(bytes.div_ceil(NUMBER_BYTES as u64));
        self.take(numbers.map_err(|_| self.too_large())?)
    }

    /// The error of a file that asks for more.
    pub(crate) fn too_large(&self) -> Error {
        Error::TooLarge { file: self.file.clone(), most: MOST_NUMBERS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_gets_its_budget_and_no_more() {
        let mut budget = Budget::new("a.csv");
        budget.take_table(MOST_NUMBERS / 4, 2).unwrap();
        budget.take_bytes(8 * MOST_NUMBERS as u64 / 4 - 7).unwrap();
        assert_eq!(budget.remaining(), MOST_NUMBERS / 4);
        assert!(budget.take(MOST_NUMBERS / 4 + 1).is_err());
        assert!(budget.take_table(usize::MAX, 2).is_err() && budget.take_bytes(u64::MAX).is_err());
        assert!(budget.too_large().to_string().contains("a.csv"));
    }
}
