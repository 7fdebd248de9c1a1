//! Detection and delay by what failed and how much.

use serde::Serialize;

use super::gather::{Gathered, Kept};
use crate::shares::{Share, Spread};

/// Sizes that a table tells apart, at most: a plan's own grid where it is no finer.
const SIZES: usize = 12;
/// Groups of sizes that are drawn.
const GROUPS: usize = 8;

/// One kind of fault under one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KindRow {
    /// What failed.
    pub kind: String,
    /// Scenarios in which it was declared.
    pub detected: Share,
    /// From the onset to the declaration, s.
    pub delay_s: Spread,
    /// Share of faulty samples outside, r_td.
    pub outside_fault: Spread,
    /// The same by size.
    pub sizes: Vec<SizeRow>,
}

/// Scenarios of like sizes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizeRow {
    /// Least and greatest magnitude.
    pub from: f64,
    /// Greatest magnitude.
    pub to: f64,
    /// Scenarios in which the fault was declared.
    pub detected: Share,
    /// From the onset to the declaration, s.
    pub delay_s: Spread,
}

pub(super) fn kinds(gathered: &Gathered, method: usize) -> Vec<KindRow> {
    let mut kinds: Vec<usize> = (0..gathered.kinds.len()).collect();
    kinds.sort_by_key(|kind| &gathered.kinds[*kind]);
    let row = |kind: usize| {
        let judged = |row: &&Kept| row.methods[method].detected.is_some();
        let of_kind = gathered.kept.iter().filter(|row| row.kind == Some(kind));
        let mut rows: Vec<&Kept> = of_kind.filter(judged).collect();
        rows.sort_by(|a, b| a.size.total_cmp(&b.size));
        let outside = rows.iter().map(|row| row.methods[method].outside_fault);
        KindRow {
            kind: gathered.kinds[kind].clone(),
            detected: share(&rows, method),
            delay_s: delays(&rows, method),
            outside_fault: Spread::of(outside.filter(|it| it.is_finite())),
            sizes: sizes(&rows, method),
        }
    };
    kinds.into_iter().map(row).collect()
}

fn share(rows: &[&Kept], method: usize) -> Share {
    let hits = rows.iter().filter(|row| row.methods[method].detected == Some(true)).count();
    Share::new(hits, rows.len())
}

fn delays(rows: &[&Kept], method: usize) -> Spread {
    Spread::of(rows.iter().map(|row| row.methods[method].delay_s).filter(|it| it.is_finite()))
}

/// Groups of like sizes, of rows that are sorted by size.
fn sizes(rows: &[&Kept], method: usize) -> Vec<SizeRow> {
    let mut distinct: Vec<f64> = rows.iter().map(|row| row.size).collect();
    // A grid may differ from itself by a rounding.
    distinct.dedup_by(|b, a| (*b - *a).abs() <= 1e-9 * a.abs());
    let groups: Vec<&[&Kept]> = if distinct.len() <= SIZES {
        rows.chunk_by(|a, b| (b.size - a.size).abs() <= 1e-9 * a.size.abs()).collect()
    } else {
        rows.chunks(rows.len().div_ceil(GROUPS).max(1)).collect()
    };
    let row = |rows: &[&Kept]| SizeRow {
        from: rows.first().map_or(f64::NAN, |row| row.size),
        to: rows.last().map_or(f64::NAN, |row| row.size),
        detected: share(rows, method),
        delay_s: delays(rows, method),
    };
    groups.into_iter().map(row).collect()
}
