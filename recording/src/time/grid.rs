//! Values put on a uniform grid, and what becomes of white noise on the way.

use crate::error::Error;
use crate::signal::{DIFFERENCES, NoiseGain};

/// Samples of a recording at most: a sampling time of 1e-9 s is a slip of the pen.
const MOST_SAMPLES: f64 = 1e8;
/// Samples over which the gain of noise is averaged, at most.
const MOST_WEIGHED: usize = 10_000;

/// Samples every `period_s` within the times given.
///
/// # Errors
/// [`Error::Period`] where there would be one or none, or too many.
pub(crate) fn samples(file: &str, time: &[f64], period_s: f64) -> Result<usize, Error> {
    let duration_s = match time {
        [first, .., last] => last - first,
        _ => 0.0,
    };
    let steps = duration_s / period_s;
    if period_s.is_finite() && period_s > 0.0 && (1.0 - 1e-9..MOST_SAMPLES).contains(&steps) {
        // The last sample counts when rounding alone puts it beyond the end.
        return Ok((steps + 1e-9).floor() as usize + 1);
    }
    Err(Error::Period { file: file.to_owned(), period_s, duration_s })
}

/// The row before each grid point and the share of the next one in the straight line to it:
/// `time[0] + k * period_s` lies between them. Of rows with the same time the first counts.
fn weights(time: &[f64], period_s: f64, samples: usize) -> impl Iterator<Item = Weight> + '_ {
    let later = move |left: usize| {
        let same = time[left..].iter().take_while(|other| **other <= time[left]).count();
        left + same
    };
    let (mut left, mut right) = (0, later(0));
    (0..samples).map(move |k| {
        let at = time[0] + k as f64 * period_s;
        while right < time.len() && time[right] < at {
            left = right;
            right = later(left);
        }
        match time.get(right) {
            Some(next) if at > time[left] => {
                let share = (at - time[left]) / (next - time[left]);
                // Exact at both ends, so that resampling to the same grid changes nothing.
                match share >= 1.0 {
                    true => Weight { left: right, right, share: 0.0 },
                    false => Weight { left, right, share },
                }
            }
            _ => Weight { left, right: left, share: 0.0 },
        }
    })
}

/// A grid point on the straight line between two rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weight {
    left: usize,
    right: usize,
    share: f64,
}

impl Weight {
    fn of(self, values: &[f64]) -> f64 {
        let (left, right) = (values[self.left], values[self.right]);
        if self.share == 0.0 { left } else { left + self.share * (right - left) }
    }

    /// Whether the value is no row's own.
    pub(super) fn is_between(&self) -> bool {
        self.share != 0.0
    }
}

/// Values at `time[0] + k * period_s`, on the straight line between their neighbours.
///
/// `time` must not go back.
pub(crate) fn interpolated(
    time: &[f64],
    values: &[f64],
    period_s: f64,
    samples: usize,
) -> Vec<f64> {
    weights(time, period_s, samples).map(|weight| weight.of(values)).collect()
}

/// As [`interpolated`], for what is held from row to row (an input): the mean over each step of the
/// grid, so that nothing of it is lost.
pub(crate) fn held_mean(time: &[f64], values: &[f64], period_s: f64, samples: usize) -> Vec<f64> {
    let mut row = 0;
    let mut means = Vec::with_capacity(samples);
    for k in 0..samples {
        let (from, to) = (time[0] + k as f64 * period_s, time[0] + (k + 1) as f64 * period_s);
        // Rounding of the stamps is no reason to begin with the row before.
        let slack = 1e-9 * period_s;
        while row + 1 < time.len() && time[row + 1] <= from + slack {
            row += 1;
        }
        let ends = |row: usize| time.get(row + 1).map_or(f64::INFINITY, |next| *next);
        if ends(row) >= to - slack {
            means.push(values[row]);
            continue;
        }
        let (mut at, mut sum, mut inside) = (from, 0.0, row);
        while at < to {
            let until = ends(inside).min(to);
            sum += values[inside] * (until - at);
            (at, inside) = (until, inside + 1);
        }
        // Of what was summed, so that the rounding of late stamps is that of time alone.
        means.push(sum / (at - from));
    }
    means
}

/// Values of rows at their places, empty places on the straight line between their neighbours.
pub(super) fn placed(values: &[f64], places: &[usize]) -> Vec<f64> {
    place_weights(places).map(|weight| weight.of(values)).collect()
}

fn place_weights(places: &[usize]) -> impl Iterator<Item = Weight> + '_ {
    let samples = places.last().map_or(0, |last| last + 1);
    let mut right = 0;
    (0..samples).map(move |k| {
        while places[right] < k {
            right += 1;
        }
        if places[right] == k {
            return Weight { left: right, right, share: 0.0 };
        }
        let (before, after) = (places[right - 1], places[right]);
        let share = (k - before) as f64 / (after - before) as f64;
        Weight { left: right - 1, right, share }
    })
}

/// Sums of what grid points are made of, from which the gain of noise follows.
#[derive(Debug, Default)]
pub(super) struct Account {
    /// Grid points.
    pub(super) samples: usize,
    /// Grid points between rows.
    pub(super) between: usize,
    weighed: usize,
    squares: [f64; DIFFERENCES],
}

impl Account {
    /// Rows taken as they stand.
    pub(super) fn add_plain(&mut self, samples: usize) {
        self.samples += samples;
        let weighed = samples.min(MOST_WEIGHED);
        self.weighed += weighed;
        self.squares.iter_mut().for_each(|square| *square += weighed as f64);
    }

    /// Rows at places.
    pub(super) fn add_placed(&mut self, places: &[usize]) {
        self.add(&place_weights(places).collect::<Vec<_>>());
    }

    /// Rows interpolated at their stamps.
    pub(super) fn add_stamped(&mut self, time: &[f64], period_s: f64, samples: usize) {
        self.add(&weights(time, period_s, samples).collect::<Vec<_>>());
    }

    fn add(&mut self, weights: &[Weight]) {
        self.samples += weights.len();
        self.between += weights.iter().filter(|weight| weight.is_between()).count();
        for window in weights.windows(DIFFERENCES).take(MOST_WEIGHED) {
            self.weighed += 1;
            for (order, square) in self.squares.iter_mut().enumerate() {
                *square += variance(&window[..=order]);
            }
        }
    }

    /// The gain of white noise.
    pub(super) fn noise_gain(&self) -> NoiseGain {
        match self.weighed {
            0 => NoiseGain::NONE,
            n => NoiseGain::of(self.squares.map(|square| (square / n as f64).sqrt())),
        }
    }
}

/// Variance of the difference of these grid points under white noise of the rows, over that of the
/// same difference of independent samples.
fn variance(points: &[Weight]) -> f64 {
    let order = points.len() - 1;
    let mut rows: Vec<(usize, f64)> = Vec::with_capacity(2 * points.len());
    let (mut binomial, mut of_white) = (1.0, 0.0);
    for (j, point) in points.iter().enumerate() {
        of_white += binomial * binomial;
        for (row, share) in [(point.left, 1.0 - point.share), (point.right, point.share)] {
            match rows.iter_mut().find(|(other, _)| *other == row) {
                Some((_, sum)) => *sum += binomial * share,
                None => rows.push((row, binomial * share)),
            }
        }
        binomial *= -((order - j) as f64) / (j + 1) as f64;
    }
    rows.iter().map(|(_, weight)| weight * weight).sum::<f64>() / of_white
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_between_rows_and_the_first_of_one_time() {
        let time = [0.0, 1.0, 1.0, 1.0, 4.0];
        let values = [0.0, 10.0, 99.0, 98.0, 40.0];
        let count = samples("a", &time, 0.5).unwrap();
        let read = interpolated(&time, &values, 0.5, count);
        assert_eq!(read, [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0]);
    }

    #[test]
    fn what_is_held_keeps_its_mean() {
        let time = [0.0, 0.9, 2.0, 3.2];
        let values = [1.0, 3.0, -2.0, 5.0];
        let means = held_mean(&time, &values, 1.0, 4);
        for (mean, expected) in means.iter().zip([1.2, 3.0, -2.0, -2.0 * 0.2 + 5.0 * 0.8]) {
            assert!((mean - expected).abs() < 1e-12, "{means:?}");
        }
        assert_eq!(held_mean(&[0.0, 1.0, 2.0], &[1.0, 2.0, 3.0], 1.0, 3), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn empty_places_are_bridged() {
        assert_eq!(placed(&[1.0, 2.0, 8.0, 9.0], &[0, 1, 4, 5]), [1.0, 2.0, 4.0, 6.0, 8.0, 9.0]);
    }

    #[test]
    fn the_gain_of_noise_is_that_of_the_weights() {
        let mut plain = Account::default();
        plain.add_plain(100);
        assert_eq!(plain.noise_gain(), NoiseGain::NONE);
        // Halfway between rows all along: (1/2, 1/2) has the variance 1/2, its first difference
        // (1/2, 0, -1/2) one of 1/2 where white noise has 2.
        let time: Vec<f64> =
            (0..100).map(|k| if k == 0 { 0.0 } else { f64::from(k) - 0.5 }).collect();
        let mut halves = Account::default();
        halves.add_stamped(&time, 1.0, 99);
        let gain = halves.noise_gain();
        assert!((gain.of_difference(0) - 0.5_f64.sqrt()).abs() < 0.01, "{gain:?}");
        assert!((gain.of_difference(1) - 0.5).abs() < 0.01, "{gain:?}");
        assert_eq!((halves.samples, halves.between), (99, 98));
    }
}
