//! The one way from stamped rows to uniform samples.

use std::ops::Range;

use super::grid::{Account, held_mean, interpolated, placed, samples};
use super::instants::Instants;
use super::rate::{Clock, Way, common_period};
use super::rows::{Columns, Rows, rows};
use super::slots::Slots;
use super::split::split;
use super::ticks::spread;
use crate::clock::Break;
use crate::error::Error;
use crate::place::Lines;
use crate::report::{Sampling, Stretches};
use crate::signal::NoiseGain;

/// Pause put between segments where the clock of the later one runs back, s.
const PAUSE_S: f64 = 1.0;
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

/// A run without a break.
struct Segment {
    rows: Range<usize>,
    start_s: f64,
    samples: usize,
    way: Way,
}

/// Finds out how the rows lie in time.
///
/// `columns` are the signals, which tell late stamps from late samples; `run` numbers the runs;
/// `period_s` is the sampling time that the user wants.
///
/// # Errors
/// Time that cannot be repaired, or a sampling time that cannot be.
pub(crate) fn arrange(
    time: Vec<f64>,
    columns: &Columns<'_>,
    run: Option<&[f64]>,
    period_s: Option<f64>,
    lines: &Lines,
) -> Result<Arranged, Error> {
    let Rows { kept, runs, unstamped, repeated, disordered } = rows(&time, columns, run, lines)?;
    let chosen = |values: &[f64]| match &kept {
        Some(kept) => kept.iter().map(|k| values[*k]).collect(),
        None => values.to_vec(),
    };
    let stamps = if kept.is_some() { chosen(&time) } else { time };
    let (mut time, stamps) = match spread(&stamps, &runs) {
        Some(time) => (time, Some(stamps)),
        None => (stamps, None),
    };
    let spread = stamps.iter().flat_map(|stamps| stamps.iter().zip(&time));
    let spread_s = spread.map(|(stamp, time)| (stamp - time).abs()).fold(0.0, f64::max);
    let whole = split(&time, &runs);
    let row = |k: usize| kept.as_ref().map_or(k, |kept| kept[k]);
    let mut gaps = Stretches::default();
    for segment in &whole[1..] {
        gaps.add(row(segment.start), lines.line(row(segment.start)));
    }
    // A stamp that never changes is no clock.
    let runs = |part: &&Range<usize>| time[part.end - 1] > time[part.start];
    let parts: Vec<Range<usize>> = whole.iter().filter(runs).cloned().collect();
    let stray = time.len() - parts.iter().map(Range::len).sum::<usize>();
    let jumps = disordered + whole.len() - 1;
    if parts.is_empty() || (time.len() >= ENOUGH_ROWS && time.len() < LEAST_ROWS * jumps) {
        let file = lines.file().to_owned();
        return Err(Error::NoClock { file, jumps, rows: time.len() });
    }
    let ticks = |rows: &Range<usize>| {
        stamps.as_ref().is_some_and(|stamps| stamps[rows.clone()] != time[rows.clone()])
    };
    let clock = |rows: Range<usize>| Clock::of(&time, ticks(&rows), rows);
    let clocks: Vec<Clock> = parts.into_iter().map(clock).collect();
    let found_s = common_period(&clocks);
    let asked_s = period_s.unwrap_or(found_s);
    if !(asked_s.is_finite() && asked_s > 0.0) {
        let (file, duration_s) = (lines.file().to_owned(), time[time.len() - 1] - time[0]);
        return Err(Error::Period { file, period_s: asked_s, duration_s });
    }
    let stamped = clocks.iter().filter(|clock| !clock.coarse);
    let uneven: Vec<(Range<usize>, Slots)> =
        stamped.filter_map(|it| Some((it.rows.clone(), it.slots.clone()?))).collect();
    let by_stamps = match uneven.is_empty() {
        true => None,
        false => {
            let columns: Vec<Vec<f64>> = columns.iter().map(|column| chosen(column)).collect();
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            Instants::of(&time, &columns, &uneven).sampled_at_stamps()
        }
    };
    let mut account = Account::default();
    let mut segments: Vec<Segment> = Vec::new();
    for clock in &clocks {
        if let Some(even) = clock.even_times(asked_s, by_stamps) {
            time[clock.rows.clone()].copy_from_slice(&even);
        }
        let stamped = &time[clock.rows.clone()];
        let way = clock.way(asked_s, by_stamps);
        let samples = match &way {
            Way::Places(None) => clock.rows.len(),
            Way::Places(Some(places)) => places[places.len() - 1] + 1,
            Way::Stamps => match samples(lines.file(), stamped, asked_s) {
                Ok(samples) => samples,
                Err(_) if clocks.len() > 1 => continue,
                Err(error) => return Err(error),
            },
        };
        match &way {
            Way::Places(None) => account.add_plain(samples),
            Way::Places(Some(places)) => account.add_placed(places),
            Way::Stamps => account.add_stamped(stamped, asked_s, samples),
        }
        let start_s = stamped[0];
        segments.push(Segment { rows: clock.rows.clone(), start_s, samples, way });
    }
    if segments.is_empty() {
        let file = lines.file().to_owned();
        return Err(Error::Period { file, period_s: asked_s, duration_s: 0.0 });
    }
    let moved = one_clock(&mut segments, asked_s);
    let uneven = segments.iter().any(|it| matches!(it.way, Way::Stamps))
        || stamps.is_some()
        || clocks.iter().any(|clock| clock.slots.is_some());
    let sampling = Sampling {
        start_s: segments[0].start_s,
        period_s: asked_s,
        jitter: clocks.iter().map(|clock| clock.jitter).fold(0.0, f64::max),
        resampled_from_s: period_s.map(|_| found_s),
        uneven,
        by_stamps: segments.iter().any(|it| matches!(it.way, Way::Stamps)),
        largest_shift_s: clocks.iter().map(Clock::largest_s).fold(spread_s, f64::max),
        interpolated: account.between as f64 / account.samples.max(1) as f64,
        segments: segments.len(),
        moved,
        disordered,
        stray,
    };
    let noise_gain = account.noise_gain();
    Ok(Arranged { kept, time, segments, sampling, gaps, repeated, unstamped, noise_gain })
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

/// Moves segments whose clock runs back to after the one before; how many.
fn one_clock(segments: &mut [Segment], period_s: f64) -> usize {
    let (mut moved, mut end_s) = (0, f64::NEG_INFINITY);
    for segment in segments {
        if segment.start_s < end_s + 0.5 * period_s {
            segment.start_s = end_s + PAUSE_S.max(10.0 * period_s);
            moved += 1;
        }
        end_s = segment.start_s + (segment.samples - 1) as f64 * period_s;
    }
    moved
}
