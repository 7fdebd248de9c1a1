//! The grid of a segment's stamps, by their periodogram.
//!
//! Stamps `t_k = t_0 + h s_k + e_k` are in phase at the frequency 1/h, however many samples are
//! missing between them. Over windows of rows, the Rayleigh statistic
//!
//! ```text
//! P(f) = sum over windows of |sum_k exp(2 pi i f t_k)|^2 / rows
//! ```
//!
//! grows with the rows of a window there, and nowhere else. Windows are short at first, so that few
//! frequencies have to be tried, then wider: each tells the frequency so much better. A clock that
//! wanders is in phase over some rows only; there the wider windows gather nothing.

use std::f64::consts::TAU;

use super::line::{Line, median};

/// Rows of the first windows, and how many times more the next have.
const FEW_ROWS: usize = 256;
const WIDER: usize = 4;
/// Frequencies tried for each that a window can tell from the next.
const FINE: f64 = 4.0;
/// The shortest step that is tried, as a share of the mean step: one in four samples is lost.
const SHORTEST: f64 = 0.75;
/// Rows that are looked at with windows of some width, at most, unless one window has more.
const MOST_ROWS: usize = 1 << 17;
/// Wider windows have to gather so many times more than those before; without a grid they gather
/// as much.
const GATHERED: f64 = 1.5;

/// The line on whose grid most rows lie, lost samples or not: two rows at least.
pub(super) fn grid(time: &[f64]) -> Line {
    let mut width = FEW_ROWS.min(time.len());
    let of = |rows: &[f64]| Line::through_most(rows, |k| k).step_s;
    let mean = median(windows(time, width).map(of).collect());
    let resolved = |width: usize| (width as f64 * mean).recip();
    let range = (mean.recip() - resolved(width), (SHORTEST * mean).recip());
    let mut best = Peak::among(time, width, range, resolved(width) / FINE);
    while width < time.len() {
        let around = (best.frequency - resolved(width), best.frequency + resolved(width));
        width = (WIDER * width).min(time.len());
        let next = Peak::among(time, width, around, resolved(width) / FINE);
        if next.power < GATHERED * best.power {
            break;
        }
        best = next;
    }
    best.line(time)
}

/// Some windows of so many rows, spread over all.
fn windows(time: &[f64], width: usize) -> impl Iterator<Item = &[f64]> {
    let all = time.chunks_exact(width);
    let every = (all.len() * width).div_ceil(MOST_ROWS.max(width));
    all.step_by(every)
}

/// Where stamps are in phase most.
#[derive(Debug, Clone, Copy)]
struct Peak {
    /// 1/s.
    frequency: f64,
    /// P there, over the number of windows: the rows of a window at most.
    power: f64,
}

impl Peak {
    /// The highest of P at frequencies `spacing` apart.
    fn among(time: &[f64], width: usize, (from, to): (f64, f64), spacing: f64) -> Self {
        let count = ((to - from) / spacing) as usize + 1;
        let (mut powers, mut parts) = (vec![0.0; count], 0);
        for rows in windows(time, width) {
            for (power, sum) in powers.iter_mut().zip(sums(rows, from, spacing, count)) {
                *power += sum.square() / rows.len() as f64;
            }
            parts += 1;
        }
        let highest = (0..count).max_by(|a, b| powers[*a].total_cmp(&powers[*b])).unwrap_or(0);
        let frequency = from + highest as f64 * spacing;
        Self { frequency, power: powers[highest] / f64::from(parts.max(1)) }
    }

    /// The grid, in phase with all rows.
    fn line(self, time: &[f64]) -> Line {
        let [sum] = sums(time, self.frequency, 0.0, 1)[..] else {
            unreachable!("one is asked for")
        };
        let first_s = time[0] + sum.im.atan2(sum.re) / (TAU * self.frequency);
        Line { step_s: self.frequency.recip(), first_s }
    }
}

/// A complex number.
#[derive(Debug, Clone, Copy, Default)]
struct Phasor {
    re: f64,
    im: f64,
}

impl Phasor {
    /// Of so many turns.
    fn at(turns: f64) -> Self {
        let (im, re) = (TAU * turns).sin_cos();
        Self { re, im }
    }

    fn rotated(self, by: Self) -> Self {
        let Self { re, im } = self;
        Self { re: re * by.re - im * by.im, im: re * by.im + im * by.re }
    }

    fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }
}

/// The sum over the rows of exp(2 pi i f t), t from the first row on, at every frequency.
fn sums(time: &[f64], from: f64, spacing: f64, count: usize) -> Vec<Phasor> {
    let mut sums = vec![Phasor::default(); count];
    for t in time {
        let t = t - time[0];
        let (mut phasor, by) = (Phasor::at(from * t), Phasor::at(spacing * t));
        for sum in &mut sums {
            (sum.re, sum.im) = (sum.re + phasor.re, sum.im + phasor.im);
            phasor = phasor.rotated(by);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::testing::jitter;

    /// Departure of the last of the rows' true places from where the grid has it, steps.
    fn drift(found: &Line, rows: usize) -> f64 {
        (found.step_s - 1.0).abs() * rows as f64
    }

    #[test]
    fn a_step_is_found_among_lost_late_and_jittering_rows() {
        for (share, lost, still) in
            [(0.0, 23, 40), (0.0, 37, 0), (0.8, 23, 0), (0.8, 97, 0), (0.9, 31, 0), (0.3, 31, 25)]
        {
            let there = (0..3000).filter(|k| (k * 7919) % lost != 5);
            let mut time: Vec<f64> = there.map(|k| 7.0 + k as f64 + share * jitter(k)).collect();
            for from in [500, 1100, 1900] {
                let late = time[from + still];
                time[from..from + still].fill(late);
            }
            let found = grid(&time);
            assert!(drift(&found, 3000) < 0.25, "{share} {lost} {still}: {found:?}");
            assert!((found.first_s - 7.0).abs() < 0.2, "{share} {lost} {still}: {found:?}");
        }
    }

    #[test]
    fn a_clock_that_wanders_keeps_its_mean_step() {
        let mut now = 0.0;
        let step = |k: usize| {
            now += 1.0 + 0.2 * jitter(k);
            now
        };
        let time: Vec<f64> = (0..5000).map(step).collect();
        let mean = time[4999] / 4999.0;
        assert!((grid(&time).step_s / mean - 1.0).abs() < 2e-3, "{}", grid(&time).step_s);
    }
}
