//! The one way from stamped rows to uniform samples.

use std::ops::Range;

use super::grid::{Account, held_mean, interpolated, placed, samples};
use super::rate::{Clock, Way, common_period};
use super::rows::{Columns, Rows, rows};
use super::segments::{Segment, one_clock};
use super::slots::Slots;
use super::split::split;
use super::ticks::Stamped;
use super::witnesses::Witnesses;
use crate::budget::Budget;
use crate::clock::Break;
use crate::error::Error;
use crate::place::Lines;
use crate::report::Sampling;
use crate::signal::NoiseGain;
use crate::stretches::Stretches;

/// More segments than one in so many rows: this is no time.
const LEAST_ROWS: usize = 4;
/// Rows from which on that is judged.
const ENOUGH_ROWS: usize = 40;

/// Rows put on a grid: what to do to every column, and the account of it.
pub(crate) struct Arranged {
    kept: Option<Vec<usize>>,
    time: Vec<f64>,
    segments: Vec<Segment>,
    /// How the samples lie.
    pub(crate) sampling: Sampling,
    /// Rows before which samples are missing for too long to bridge.
    pub(crate) gaps: Stretches,
    /// Rows that repeat the one before.
    pub(crate) repeated: Stretches,
    /// Rows without a time.
    pub(crate) unstamped: Stretches,
    /// What became of white noise.
    pub(crate) noise_gain: NoiseGain,
}

/// Finds out how the rows lie in time.
///
/// `columns` are the signals, of which the `witnesses` tell late stamps from late samples; `run`
/// numbers the runs; `period_s` is the sampling time that the user wants.
///
/// # Errors
/// Time that cannot be repaired, or a sampling time that cannot be.
pub(crate) fn arrange(
    time: Vec<f64>,
    columns: &Columns<'_>,
    witnesses: &Witnesses<'_>,
    run: Option<&[f64]>,
    period_s: Option<f64>,
    lines: &Lines,
) -> Result<Arranged, Error> {
    let Rows { kept, runs, unstamped, repeated, disordered } = rows(&time, columns, run, lines)?;
    let stamps = match &kept {
        Some(kept) => kept.iter().map(|k| time[*k]).collect(),
        None => time,
    };
    let mut stamped = Stamped::of(stamps, &runs);
    let parts = split(&stamped.time, &runs);
    let mut gaps = Stretches::default();
    for part in &parts[1..] {
        let row = kept.as_ref().map_or(part.start, |kept| kept[part.start]);
        gaps.add(row, lines.line(row));
    }
    let clocks = clocks(&stamped, &parts, disordered, lines)?;
    let back: Vec<bool> =
        (0..clocks.len()).map(|k| k > 0 && runs_back(&stamped, &clocks, k)).collect();
    let found_s = common_period(&clocks);
    let asked_s = period_s.unwrap_or(found_s);
    if !(asked_s.is_finite() && asked_s > 0.0) {
        let duration_s = stamped.time[stamped.time.len() - 1] - stamped.time[0];
        return Err(Error::Period { file: lines.file().to_owned(), period_s: asked_s, duration_s });
    }
    let by_stamps = by_stamps(&clocks, &stamped.time, witnesses, kept.as_deref());
    let (mut segments, account) =
        on_grid(&clocks, &back, &mut stamped.time, asked_s, by_stamps, lines)?;
    let rows: usize = segments.iter().map(|segment| segment.samples).sum();
    // The time column is one more.
    if Budget::new(lines.file()).take_table(rows, columns.len() + 1).is_err() {
        let duration_s = rows as f64 * asked_s;
        return Err(Error::Period { file: lines.file().to_owned(), period_s: asked_s, duration_s });
    }
    let moved = one_clock(&mut segments, asked_s);
    let between = segments.iter().any(|it| matches!(it.way, Way::Stamps));
    let sampling = Sampling {
        start_s: segments[0].start_s,
        period_s: asked_s,
        jitter: clocks.iter().map(|clock| clock.jitter).fold(0.0, f64::max),
        resampled_from_s: period_s.map(|_| found_s),
        uneven: between || stamped.is_spread() || clocks.iter().any(|it| it.slots.is_some()),
        by_stamps: between,
        largest_shift_s: clocks.iter().map(Clock::largest_s).fold(stamped.shift_s, f64::max),
        interpolated: account.between as f64 / account.samples.max(1) as f64,
        segments: segments.len(),
        moved,
        disordered,
        stray: stamped.time.len() - clocks.iter().map(|it| it.rows.len()).sum::<usize>(),
    };
    let (time, noise_gain) = (stamped.time, account.noise_gain());
    Ok(Arranged { kept, time, segments, sampling, gaps, repeated, unstamped, noise_gain })
}

/// The clocks of the parts in which time runs: a stamp that never changes is none.
fn clocks(
    stamped: &Stamped,
    parts: &[Range<usize>],
    disordered: usize,
    lines: &Lines,
) -> Result<Vec<Clock>, Error> {
    let time = &stamped.time;
    let clocks: Vec<Clock> = parts
        .iter()
        .filter(|part| time[part.end - 1] > time[part.start])
        .map(|part| Clock::of(time, stamped.is_spread_in(part), part.clone()))
        .collect();
    let (rows, jumps) = (time.len(), disordered + parts.len() - 1);
    if clocks.is_empty() || (rows >= ENOUGH_ROWS && rows < LEAST_ROWS * jumps) {
        return Err(Error::NoClock { file: lines.file().to_owned(), jumps, rows });
    }
    Ok(clocks)
}

/// Whether a clock begins before the one before it ends, by the stamps of the file.
fn runs_back(stamped: &Stamped, clocks: &[Clock], k: usize) -> bool {
    stamped.stamp(clocks[k].rows.start) < stamped.stamp(clocks[k - 1].rows.end - 1)
}

/// Whether the signals say that rows were sampled at their stamps; none where they do not tell.
fn by_stamps(
    clocks: &[Clock],
    time: &[f64],
    witnesses: &Witnesses<'_>,
    kept: Option<&[usize]>,
) -> Option<bool> {
    let stamped = clocks.iter().filter(|clock| !clock.coarse);
    let uneven: Vec<(Range<usize>, &Slots)> =
        stamped.filter_map(|it| Some((it.rows.clone(), it.slots.as_ref()?))).collect();
    if uneven.is_empty() {
        return None;
    }
    witnesses.sampled_at_stamps(time, kept, &uneven)
}

/// Every clock's rows on the grid, and what that does to noise. Rows that were sampled evenly get
/// the times at which they were.
fn on_grid(
    clocks: &[Clock],
    back: &[bool],
    time: &mut [f64],
    period_s: f64,
    by_stamps: Option<bool>,
    lines: &Lines,
) -> Result<(Vec<Segment>, Account), Error> {
    let mut account = Account::default();
    let mut segments: Vec<Segment> = Vec::new();
    // A segment that is left out leaves its jump back to the next one.
    let mut owed = false;
    for (clock, back) in clocks.iter().zip(back) {
        owed |= back;
        let time = &mut time[clock.rows.clone()];
        if let Some(even) = clock.even_times(period_s, by_stamps) {
            time.copy_from_slice(&even);
        }
        let way = clock.way(period_s, by_stamps);
        let samples = match &way {
            Way::Places(None) => clock.rows.len(),
            Way::Places(Some(places)) => places[places.len() - 1] + 1,
            Way::Stamps => match samples(lines.file(), time, period_s) {
                Ok(samples) => samples,
                Err(_) if clocks.len() > 1 => continue,
                Err(error) => return Err(error),
            },
        };
        match &way {
            Way::Places(None) => account.add_plain(samples),
            Way::Places(Some(places)) => account.add_placed(places),
            Way::Stamps => account.add_stamped(time, period_s, samples),
        }
        let start_s = clock.start_s(time, &way);
        let runs_back = std::mem::take(&mut owed);
        segments.push(Segment { rows: clock.rows.clone(), start_s, samples, way, runs_back });
    }
    if segments.is_empty() {
        return Err(Error::Period { file: lines.file().to_owned(), period_s, duration_s: 0.0 });
    }
    Ok((segments, account))
}

impl Arranged {
    /// The values of a column on the grid; what is `held` from row to row keeps its mean.
    pub(crate) fn apply(&self, values: Vec<f64>, held: bool) -> Vec<f64> {
        let values = match &self.kept {
            Some(kept) => kept.iter().map(|k| values[*k]).collect(),
            None => values,
        };
        if let [Segment { rows, way: Way::Places(None), .. }] = self.segments.as_slice()
            && rows.len() == values.len()
        {
            return values;
        }
        let mut all = Vec::with_capacity(self.segments.iter().map(|it| it.samples).sum());
        for Segment { rows, samples, way, .. } in &self.segments {
            let (time, values) = (&self.time[rows.clone()], &values[rows.clone()]);
            let period_s = self.sampling.period_s;
            match way {
                Way::Places(None) => all.extend_from_slice(values),
                Way::Places(Some(places)) => all.extend(placed(values, places)),
                Way::Stamps if held => all.extend(held_mean(time, values, period_s, *samples)),
                Way::Stamps => all.extend(interpolated(time, values, period_s, *samples)),
            }
        }
        all
    }

    /// Where later segments begin.
    pub(crate) fn breaks(&self) -> Vec<Break> {
        let mut at = 0;
        let mut breaks = Vec::new();
        for segment in &self.segments {
            breaks.push(Break { at, start_s: segment.start_s });
            at += segment.samples;
        }
        breaks.remove(0);
        breaks
    }
}
