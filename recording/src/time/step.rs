//! The sampling time of a segment, to a few thousandths.

use super::line::{Line, median};
use super::places::Places;

/// Rows over which the first step is right to within a sample, and how many times more the next.
const FEW_ROWS: usize = 64;
const WIDER: usize = 8;
/// Stretches of a few rows that are looked at, at most.
const STRETCHES: usize = 16;
/// Steps that are tried, each so much shorter than the one before, a third of a sample over a few
/// rows: down to where one in four samples is lost.
const TRIED: i32 = 56;
const SHORTER: f64 = 0.995;
/// What a hole counts among the squares of departures, in steps^2.
const HOLE: f64 = 0.5;
/// A shorter step has to fit so much better.
const BETTER: f64 = 0.8;

/// The step of the grid on which most rows lie, lost samples or not.
pub(super) fn step(time: &[f64]) -> f64 {
    let mut step = step_of_few(time);
    // A step that is a little off is right over few rows, which make it better for more.
    let mut width = FEW_ROWS;
    while width < time.len() {
        step = step_over(time, width, step);
        width *= WIDER;
    }
    step
}

/// The step on whose grid a few rows lie best, in most stretches of them.
///
/// Where stamps jitter, a lost sample and a late one look alike from row to row, and not over many
/// rows: the mean step is that of the grid or longer.
fn step_of_few(time: &[f64]) -> f64 {
    let stretches: Vec<&[f64]> = match time.len() < FEW_ROWS {
        true => vec![time],
        false => {
            let all = time.chunks_exact(FEW_ROWS);
            let every = all.len().div_ceil(STRETCHES);
            all.step_by(every).collect()
        }
    };
    // A hole too many fits everything a little better.
    let of = |rows: &[f64], step: f64| {
        let places = Places::on(rows, step);
        (places.misfit(rows) + HOLE * places.holes() as f64) / rows.len() as f64
    };
    let misfit = |step: f64| median(stretches.iter().map(|rows| of(rows, step)).collect());
    let mean = |rows: &&[f64]| Line::through_most(rows, |k| k).step_s;
    let mean = median(stretches.iter().map(mean).collect());
    let (mut best, mut least) = (mean, misfit(mean));
    for shorter in 1..TRIED {
        let tried = mean * SHORTER.powi(shorter);
        let found = misfit(tried);
        if found < BETTER * least {
            (best, least) = (tried, found);
        }
    }
    best
}

/// The median of the steps that fit stretches of so many rows each: one in which the logger stood
/// still does not count.
fn step_over(time: &[f64], width: usize, step: f64) -> f64 {
    let of = |rows: &[f64]| Places::on(rows, step).line.step_s;
    median(time.chunks_exact(width).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::testing::jitter;

    #[test]
    fn a_step_is_found_among_lost_late_and_jittering_rows() {
        for (share, lost, still) in [(0.0, 23, 40), (0.8, 23, 0), (0.8, 97, 0), (0.3, 31, 25)] {
            let there = (0..3000).filter(|k| (k * 7919) % lost != 5);
            let mut time: Vec<f64> = there.map(|k| k as f64 + share * jitter(k)).collect();
            for from in [500, 1100, 1900] {
                let late = time[from + still];
                time[from..from + still].fill(late);
            }
            let found = step(&time);
            // Half a sample over 512 rows.
            assert!((found - 1.0).abs() < 1e-3, "{share} {lost} {still}: {found}");
        }
    }
}
