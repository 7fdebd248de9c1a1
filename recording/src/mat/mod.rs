//! Recordings in MAT files: plain numeric series of one length beside each other.
//!
//! Every vector is a column and has the variable's name; a matrix gives the columns `name_1`,
//! `name_2`, ... along its longer side. Without a time vector, a scalar `Ts`, `dt` or `fs` gives
//! the sampling time.

mod level5;

use std::fs::File;
use std::io::BufReader;

use crate::error::Error;
use crate::header::is_time;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::report::Report;
use crate::signal::Recording;
use crate::table::Table;
use level5::{Content, Level5, Variable};

/// Reads a MAT file of version 5.
pub(crate) fn read(
    opened: File,
    file: &str,
    options: &ReadOptions,
) -> Result<(Recording, Report), Error> {
    let mut variables = Level5::new(BufReader::new(opened), file)?;
    let (mut series, mut left_out, mut sampling) = (Vec::new(), Vec::new(), None);
    while let Some(Variable { name, content }) = variables.next()? {
        match content {
            Content::Other(kind) => left_out.push(format!("variable `{name}` is a {kind}")),
            Content::Numbers { rows: 1, columns: 1, values } => {
                match sampling_time(&name, values.first().copied()) {
                    Some(period_s) => sampling = Some((name, period_s)),
                    None => left_out.push(format!("variable `{name}` is a single number")),
                }
            }
            Content::Numbers { rows, columns, values } => {
                series.extend(columns_of(name, rows, columns, values));
            }
        }
    }
    let time = series.iter().find(|(name, _)| is_time(name, &options.columns));
    let longest = series.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    let length = time.map_or(longest, |(_, values)| values.len());
    let period_s = if time.is_none() { sampling.map(|(_, period_s)| period_s) } else { None };
    let (kept, others): (Vec<_>, Vec<_>) =
        series.into_iter().partition(|(_, values)| values.len() == length);
    for (name, values) in others {
        let found = values.len();
        left_out.push(format!("variable `{name}` has {found} values, others have {length}"));
    }
    if kept.is_empty() {
        let found = if left_out.is_empty() { "nothing".into() } else { left_out.join(", ") };
        return Err(Error::MatNoSeries { file: file.to_owned(), found });
    }
    let (header, columns) = kept.into_iter().unzip();
    Table { header, columns, lines: Lines::rows(file), left_out, period_s }.into_recording(options)
}

/// The sampling time, s, that a scalar of that name gives.
fn sampling_time(name: &str, value: Option<f64>) -> Option<f64> {
    let value = value.filter(|value| value.is_finite() && *value > 0.0)?;
    match name {
        "Ts" | "T_s" | "ts" | "dt" | "Ta" => Some(value),
        "fs" | "Fs" | "f_s" => Some(1.0 / value),
        _ => None,
    }
}

/// Series along the longer side; values are stored column after column.
fn columns_of(
    name: String,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
) -> Vec<(String, Vec<f64>)> {
    if rows.min(columns) <= 1 {
        return vec![(name, values)];
    }
    let named = |k: usize| format!("{name}_{}", k + 1);
    if rows >= columns {
        values.chunks(rows).enumerate().map(|(k, part)| (named(k), part.to_vec())).collect()
    } else {
        let row = |k: usize| values.iter().skip(k).step_by(rows).copied().collect();
        (0..rows).map(|k| (named(k), row(k))).collect()
    }
}
