//! Whether a speed and a position agree at the stamps of their rows or at even times.
//!
//! From row to row the position moves by the speed times the time between: with h s_k the place of
//! a row on the grid and e_k the departure of its stamp from there,
//!
//! ```text
//! x_{k+1} - x_k = g v (h (s_{k+1} - s_k) + c (e_{k+1} - e_k))
//! ```
//!
//! with c = 1 where rows were sampled at their stamps and c = 0 where evenly; g is 1, or a gear.
//! The noise of v is in what v is multiplied by, so that the slope of x over the rows around is the
//! instrument: least squares alone would draw c to 0.

use std::ops::Range;

use super::instants::Instants;
use super::slots::Slots;

/// Rows before and behind a step over which the instrument is taken.
const REACH: usize = 3;
/// Rows that are looked at, at most.
const MOST_ROWS: usize = 200_000;
/// Steps that a verdict needs.
const ENOUGH: usize = 20;
/// Standard deviations beyond which a step is none of this speed.
const CLIP: f64 = 4.0;
const ROUNDS: usize = 3;
/// Least ratio of g to its standard error: the two belong to one shaft.
const SURELY: f64 = 10.0;
/// Differences of white noise, here on both sides, are correlated by -1/2: 1 + 2 / 4.
const CORRELATED: f64 = 1.5;
/// Standard error of c at least: a speed that was differenced or filtered is off by as much.
const EXACT: f64 = 0.02;

/// From a row to the next.
struct Step {
    /// What the position moves by.
    y: f64,
    /// The mean speed times the time by places, and times the change of departure.
    x: [f64; 2],
    /// The same with the slope of the position for the speed.
    z: [f64; 2],
}

/// What both say of the stamps; nothing where they are not of one motion or hardly move.
pub(super) fn instants(
    time: &[f64],
    speed: impl Fn(usize) -> f64,
    position: impl Fn(usize) -> f64,
    segments: &[(Range<usize>, &Slots)],
) -> Option<Instants> {
    let mut steps = steps(time, speed, position, segments);
    for _ in 0..ROUNDS {
        let [g, c] = solved(&steps)?.0;
        let remainder = |it: &Step| it.y - g * it.x[0] - c * it.x[1];
        let square = steps.iter().map(|it| remainder(it).powi(2)).sum::<f64>();
        let most = CLIP * (square / steps.len() as f64).sqrt();
        steps.retain(|it| remainder(it).abs() <= most);
    }
    let ([g, c], [of_g, of_c]) = solved(&steps)?;
    if steps.len() < ENOUGH || g.abs() < SURELY * of_g {
        return None;
    }
    let error = of_c / g.abs();
    error.is_finite().then(|| Instants { by_stamps: c / g, error: error.hypot(EXACT) })
}

fn steps(
    time: &[f64],
    speed: impl Fn(usize) -> f64,
    position: impl Fn(usize) -> f64,
    segments: &[(Range<usize>, &Slots)],
) -> Vec<Step> {
    let all = || segments.iter().flat_map(|(rows, _)| rows.clone());
    let finite = || all().map(&position).filter(|it| it.is_finite());
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let mut found = Vec::new();
    for (rows, slots) in segments {
        let t = &time[rows.clone()];
        let (v, x) = (|k: usize| speed(rows.start + k), |k: usize| position(rows.start + k));
        let last = t.len().saturating_sub(REACH + 1);
        for k in (REACH..last).take(MOST_ROWS) {
            let places = |from: usize, to: usize| (slots.place(to) - slots.place(from)) as f64;
            let by_places = slots.line.step_s * places(k, k + 1);
            let by_stamps = slots.departure(t, k + 1) - slots.departure(t, k);
            let mean = 0.5 * (v(k) + v(k + 1));
            // Without the rows of the step itself, whose noise is in y.
            let around = x(k + 1 + REACH) - x(k - REACH);
            let slope = around / (slots.line.step_s * places(k - REACH, k + 1 + REACH));
            let y = x(k + 1) - x(k);
            // An angle that wraps moves by its whole range at once.
            let wraps = y.abs().max(around.abs()) > 0.5 * range;
            if !wraps && (y + mean + slope).is_finite() {
                let of = |speed: f64| [speed * by_places, speed * by_stamps];
                found.push(Step { y, x: of(mean), z: of(slope) });
            }
        }
    }
    found
}

/// g and g c by instruments, and their standard errors.
fn solved(steps: &[Step]) -> Option<([f64; 2], [f64; 2])> {
    let sum = |of: &dyn Fn(&Step) -> f64| steps.iter().map(of).sum::<f64>();
    let zx = |i: usize, j: usize| sum(&|it| it.z[i] * it.x[j]);
    let zz = |i: usize, j: usize| sum(&|it| it.z[i] * it.z[j]);
    let (a, b, c, d) = (zx(0, 0), zx(0, 1), zx(1, 0), zx(1, 1));
    let by = a * d - b * c;
    let inverse = [[d / by, -b / by], [-c / by, a / by]];
    let zy = [sum(&|it| it.z[0] * it.y), sum(&|it| it.z[1] * it.y)];
    let found = inverse.map(|row| row[0] * zy[0] + row[1] * zy[1]);
    let remainder = sum(&|it| (it.y - found[0] * it.x[0] - found[1] * it.x[1]).powi(2));
    let variance = CORRELATED * remainder / steps.len() as f64;
    let (z00, z01, z11) = (zz(0, 0), zz(0, 1), zz(1, 1));
    let error = |row: [f64; 2]| {
        let square = row[0] * row[0] * z00 + 2.0 * row[0] * row[1] * z01 + row[1] * row[1] * z11;
        (variance * square).sqrt()
    };
    found.iter().all(|it| it.is_finite()).then(|| (found, inverse.map(error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::testing::jitter;

    /// A swinging shaft behind a gear, sampled at its stamps or evenly, with a noisy speed.
    fn stated(stamped: bool, noise: f64) -> Option<Instants> {
        let time: Vec<f64> = (0..4000).map(|k| 1e-2 * (k as f64 + 0.8 * jitter(k))).collect();
        let at = |k: usize| if stamped { time[k] } else { 1e-2 * k as f64 };
        let speed = |k: usize| 5.0 * (3.0 * at(k)).cos() + noise * jitter(k + 7777);
        let position = |k: usize| {
            let angle = 0.4 * 5.0 / 3.0 * (3.0 * at(k)).sin();
            ((angle + 1e-4 * jitter(k + 555)) / 1e-4).round() * 1e-4
        };
        let slots = Slots::of(&time);
        instants(&time, speed, position, &[(0..4000, &slots)])
    }

    #[test]
    fn a_speed_and_its_position_tell() {
        for noise in [0.0, 0.5, 10.0] {
            assert_eq!(stated(true, noise).unwrap().sampled_at_stamps(), Some(true), "{noise}");
            assert_eq!(stated(false, noise).unwrap().sampled_at_stamps(), Some(false), "{noise}");
        }
    }

    #[test]
    fn two_motions_do_not_tell() {
        let time: Vec<f64> = (0..4000).map(|k| 1e-2 * (k as f64 + 0.8 * jitter(k))).collect();
        let slots = Slots::of(&time);
        let other = |k: usize| (0.37 * time[k]).sin();
        let said = instants(&time, |k| (3.0 * time[k]).cos(), other, &[(0..4000, &slots)]);
        assert!(said.is_none_or(|it| it.sampled_at_stamps().is_none()), "{said:?}");
        let still = instants(&time, |_| 0.0, |_| 1.0, &[(0..4000, &slots)]);
        assert!(still.is_none(), "{still:?}");
    }
}
