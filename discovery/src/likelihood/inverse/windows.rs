//! A recording in windows: the balance of torques times a bump, summed over it.
//!
//! With a bump h (a triangle, half as wide as its windows are apart on either side) the acceleration
//! needs no derivative of what was measured: the sum of h times the acceleration is the second
//! difference of the position over the windows. The torques are summed with the same bump, so that
//! both sides of the balance are smoothed alike (modulating functions; Preisig and Rippin, Comput.
//! Chem. Eng. 17, 1993).

use std::ops::Range;

use drivescope_plant::model::{POSITION, SPEED};

use super::super::scene::Recorded;
use super::super::state::Vector;
use crate::jitter::jitter;
use crate::measured::{Measured, Output};

/// Windows along the longest recording: some five to a tenth of a second of one of twenty seconds.
const WINDOWS: f64 = 1000.0;
/// Fewest samples from one window to the next.
const FEWEST: usize = 2;
/// Points from one window to the next at which a law that is weighed is asked for its torque.
const POINTS: usize = 6;

/// Variance of a second difference over that of its positions.
const OF_POSITIONS: f64 = 6.0;

/// One recording in windows.
#[derive(Debug, Clone)]
pub(super) struct Windows {
    /// Samples from one window to the next.
    every: usize,
    pieces: Vec<Range<usize>>,
    /// The motion over each sample: speed and position in its middle.
    pub(super) motion: Vec<Vector>,
    /// Speed over each sample by its ends: what follows the motion by its own inertia smooths it.
    pub(super) speed: Vec<f64>,
    /// What the second difference of the position says of each window, rad/s^2 (m/s^2), and the
    /// standard deviation of it.
    pub(super) acceleration: Vec<f64>,
    pub(super) acceleration_sd: f64,
    /// By how much the moments at which a position was read are off, s: what is known of it.
    jitter_s: f64,
    /// Whether a piece begins with that window.
    pub(super) begins: Vec<bool>,
    /// Whether the shaft moves in one direction throughout the window, so that dry friction is known.
    pub(super) moves: Vec<bool>,
    /// Time in which the direction of the shaft is certain, s.
    pub(super) one_way_s: f64,
    /// Sampling time, s.
    period_s: f64,
}

/// Samples from one window to the next, for recordings of which the longest lasts that, s, and windows
/// that are `finer` by a factor.
pub(super) fn every(measured: &Measured, longest_s: f64, finer: usize) -> usize {
    let usual = (longest_s / WINDOWS / measured.period_s).round() as usize;
    (usual / finer).max(FEWEST)
}

/// The way of the shaft as it was measured, with the standard deviation of its noise; nothing where
/// it was not.
pub(super) fn way(it: &Recorded) -> Option<(&[f64], f64)> {
    let measured = &it.measured;
    if let Some(shown) = measured.output(Output::Position) {
        return Some((&shown.values, it.noise[Output::Position as usize]));
    }
    let angle = measured.angle.as_deref()?;
    // Integrated from the speed, or measured beside it and no worse.
    Some((angle, it.noise[Output::Speed as usize] * measured.period_s))
}

impl Windows {
    /// Nothing where the position is not known throughout.
    pub(super) fn of(it: &Recorded, every: usize) -> Option<Self> {
        let (way, sd) = way(it)?;
        let measured = &it.measured;
        let period = measured.period_s;
        let long = |piece: &&Range<usize>| piece.len() > 2 * every;
        let pieces: Vec<Range<usize>> = measured.pieces.iter().filter(long).cloned().collect();
        if pieces.iter().any(|piece| way[piece.clone()].iter().any(|value| !value.is_finite())) {
            return None;
        }
        let mut motion = vec![Vector::zeros(); measured.len()];
        let mut speed = vec![0.0; measured.len()];
        let (mut acceleration, mut begins, mut moves) = (Vec::new(), Vec::new(), Vec::new());
        let apart_s = every as f64 * period;
        let mut one_way = 0_usize;
        for piece in &pieces {
            one_way += piece.clone().filter(|k| it.direction.at(*k) != 0.0).count();
            let last = piece.end - 1;
            for k in piece.clone() {
                let from = k.saturating_sub(every / 2).max(piece.start);
                let to = (k + 1 + every / 2).min(last).max(from + 1).min(last);
                let next = (k + 1).min(last);
                motion[k][SPEED] = (way[to] - way[from]) / ((to - from).max(1) as f64 * period);
                motion[k][POSITION] = 0.5 * (way[k] + way[next]);
                let first = k.min(last - 1);
                speed[k] = (way[first + 1] - way[first]) / period;
            }
            for middle in middles(piece, every) {
                let bent = way[middle + every] - 2.0 * way[middle] + way[middle - every];
                acceleration.push(bent / (apart_s * apart_s));
                begins.push(middle == piece.start + every);
                let mut own = middle - every..middle + every;
                let sign = it.direction.at(middle);
                moves.push(sign != 0.0 && own.all(|k| it.direction.at(k) == sign));
            }
        }
        let from_speed = measured.output(Output::Speed).is_some();
        // Of three positions, or of the speeds over two windows.
        let noise = if from_speed { 2.0 * every as f64 } else { OF_POSITIONS };
        let acceleration_sd = noise.sqrt() * sd / (apart_s * apart_s);
        let jitter_s = jitter(measured);
        Some(Self {
            every,
            pieces,
            motion,
            speed,
            acceleration,
            acceleration_sd,
            jitter_s,
            begins,
            moves,
            one_way_s: one_way as f64 * period,
            period_s: period,
        })
    }

    /// Time over which windows lie in which the shaft moves one way, s.
    pub(super) fn moving_s(&self) -> f64 {
        self.moves.iter().filter(|it| **it).count() as f64 * self.apart_s()
    }

    /// Standard deviation of the acceleration, over the speed, by positions that are read a moment sooner or
    /// later, 1/s.
    pub(super) fn acceleration_by_jitter(&self) -> f64 {
        OF_POSITIONS.sqrt() * self.jitter_s / (self.apart_s() * self.apart_s())
    }

    /// Number of windows.
    pub(super) fn len(&self) -> usize {
        self.acceleration.len()
    }

    /// Time from one window to the next, s.
    pub(super) fn apart_s(&self) -> f64 {
        self.every as f64 * self.period_s
    }

    /// Samples that are used, one piece after the other.
    pub(super) fn pieces(&self) -> &[Range<usize>] {
        &self.pieces
    }

    /// The samples of a piece, each of which stands for so many, with the weight that these have in the
    /// windows around them, numbered over all pieces; the sum of the weights of a window is 1.
    pub(super) fn weights(
        &self,
        piece: usize,
        apart: usize,
    ) -> impl Iterator<Item = (usize, [Option<(usize, f64)>; 2])> {
        let before: usize =
            self.pieces[..piece].iter().map(|piece| middles(piece, self.every).len()).sum();
        let (range, every) = (self.pieces[piece].clone(), self.every);
        let count = middles(&range, every).len();
        let begins = {
            let range = range.clone();
            move |k: &usize| ((k - range.start) % every).is_multiple_of(apart)
        };
        range.clone().filter(begins).map(move |k| {
            let (number, from) = ((k - range.start) / every, (k - range.start) % every);
            let to = (from + apart).min(every).min(from + range.end - k);
            // Falling in the window behind, rising in the one ahead.
            let rising = 0.5 * (to * to - from * from) as f64 / every as f64;
            let at = |window: Option<usize>, share: f64| {
                let window = window.filter(|window| *window < count)?;
                Some((before + window, share / every as f64))
            };
            let falling = (to - from) as f64 - rising;
            let middle = k + (to - from) / 2;
            (middle, [at(number.checked_sub(1), falling), at(Some(number), rising)])
        })
    }

    /// Samples of which one stands for the others where laws are weighed.
    pub(super) fn apart(&self) -> usize {
        (self.every / POINTS).max(1)
    }

    /// A series of the samples, summed over the windows.
    pub(super) fn over(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.len()];
        if values.is_empty() {
            return sums;
        }
        for piece in 0..self.pieces.len() {
            for (k, weights) in self.weights(piece, 1) {
                for (window, weight) in weights.into_iter().flatten() {
                    sums[window] += weight * values[k];
                }
            }
        }
        sums
    }
}

/// Middles of the windows that a piece holds whole.
fn middles(piece: &Range<usize>, every: usize) -> impl ExactSizeIterator<Item = usize> {
    let (start, count) = (piece.start, (piece.len().saturating_sub(1)) / every);
    (1..count.max(1)).map(move |number| start + number * every)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn windows() -> Windows {
        Windows {
            every: 4,
            pieces: vec![0..41, 50..72],
            motion: Vec::new(),
            speed: Vec::new(),
            acceleration: vec![0.0; 9 + 4],
            acceleration_sd: 0.0,
            jitter_s: 0.0,
            begins: Vec::new(),
            moves: Vec::new(),
            one_way_s: 0.0,
            period_s: 0.0,
        }
    }

    #[test]
    fn a_window_holds_the_mean_of_what_never_changes_and_the_middle_of_a_line() {
        let windows = windows();
        for (piece, apart) in [(0, 1), (0, 3), (1, 3), (1, 4)] {
            let mut sums = vec![0.0; windows.len()];
            for (_, weights) in windows.weights(piece, apart) {
                weights.into_iter().flatten().for_each(|(window, weight)| sums[window] += weight);
            }
            let own = if piece == 0 { 0..9 } else { 9..13 };
            assert!(sums[own].iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{sums:?}");
        }
        let middles: Vec<usize> =
            windows.pieces.iter().flat_map(|piece| middles(piece, 4)).collect();
        assert_eq!(middles.len(), windows.len());
        let ones = windows.over(&[1.0; 80]);
        assert!(ones.iter().all(|one| (one - 1.0).abs() < 1e-12), "{ones:?}");
        // A value is held over its sample: its middle counts.
        let line: Vec<f64> = (0..80).map(|k| k as f64 + 0.5).collect();
        for (sum, middle) in windows.over(&line).iter().zip(middles) {
            assert!((sum - middle as f64).abs() < 1e-9, "{sum} at {middle}");
        }
    }
}
