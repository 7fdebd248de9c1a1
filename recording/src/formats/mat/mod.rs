//! MAT files of version 5: vectors, matrices, structs and cells. (7.3 is HDF5.)
//!
//! The crate `mat5` 0.1.0 reads matrices only and refuses a file for one struct or cell in it, which is
//! how logs of Simulink come; and what a file claims to hold must meet the budget before it is taken.

mod element;
mod level5;
mod variable;

use std::fs::File;
use std::io::BufReader;

use super::Format;
use crate::budget::Budget;
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::table::Table;

pub(super) static FORMAT: Format = Format {
    name: "MAT",
    extensions: &["mat"],
    starts: |head| {
        let marked = head.get(126..128).is_some_and(|it| it == b"IM" || it == b"MI");
        let seven = head.starts_with(b"MATLAB 7.3");
        head.starts_with(b"MATLAB 5.0") || (marked && !seven) || head.starts_with(OCTAVE_TEXT)
    },
    read,
    write: None,
};

/// How Octave begins a file that it saves as text, which is its default.
const OCTAVE_TEXT: &[u8] = b"# Created by Octave";

fn read(opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let mut budget = Budget::new(file);
    let tree = level5::read(BufReader::new(opened), file, &mut budget)?;
    tree.into_table(file, options, &mut budget)
}
