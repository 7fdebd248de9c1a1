//! The time column: rows as they were logged, put on a uniform grid.
//!
//! Nobody's logger is tidy: stamps jitter, come late, are rounded; samples are lost, rows are sent
//! twice or in another order; runs of one machine are joined end to end. [`arrange`] goes through
//! these steps and keeps account of each in [`Arranged`]:
//!
//! 1. [`rows`]: rows without a time are left out; time that jumps back and a column that numbers
//!    runs part them into runs; in a run rows in disorder are sorted, and what was sent twice
//!    counts once;
//! 2. [`ticks`]: where stamps are coarser than the sampling, rows of one stamp are spread;
//! 3. [`split`]: gaps and another rate part runs into segments;
//! 4. [`slots`]: every row gets its place on the segment's grid, lost samples leave places empty;
//! 5. [`witnesses`]: the signals that the file is read for tell whether rows were sampled when
//!    their stamps say, or evenly and only stamped late; a speed beside its position, [`motion`],
//!    before all others;
//! 6. [`grid`]: values are put on one grid for all segments, and what that does to white noise is
//!    computed.
//!
//! A file whose steps agree within 1 % passes unchanged, bit by bit.

mod arrange;
mod grid;
mod instants;
mod line;
mod motion;
mod places;
mod rate;
mod rows;
mod segments;
mod slots;
mod split;
mod step;
#[cfg(test)]
mod testing;
mod ticks;
mod uniform;
mod witnesses;

pub(crate) use arrange::arrange;
pub(crate) use grid::{held_mean, interpolated, samples};
pub(crate) use uniform::shortest;
pub(crate) use witnesses::Witnesses;
