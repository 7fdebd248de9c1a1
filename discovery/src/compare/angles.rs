//! Wave numbers that a shape over the angle may have.
//!
//! On a shaft these are 1 to 48 periods a revolution. On a linear axis any spatial period may be:
//! the outputs' response to a sine of the position is computed over a grid by the bare inertia
//! with its viscous friction and the observer, without stick-slip, and the highest peaks stay for
//! the exact columns. Residual and responses are made white first: what the model lacks at low
//! frequencies is far larger than a ripple, and would choose the longest periods, while the
//! observer's and the sensor's noise would choose the shortest.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::columns::Builder;
use super::drive_motion::quantile;
use super::score::{basis, outside};
use super::whitening::Whitening;
use crate::measured::Output;
use drivescope_plant::drive::Motion;

/// Periods a revolution.
const MOST_A_REVOLUTION: usize = 48;
/// Periods over the whole travel at least, and steps of the grid a period over the travel.
const LEAST_OVER_TRAVEL: f64 = 2.0;
const STEPS: f64 = 2.0;
/// Grid points at most.
const GRID: usize = 700;
/// Samples that a period takes at the usual speed, at least.
const SAMPLES_A_PERIOD: f64 = 8.0;
/// Wave numbers that stay.
const KEPT: usize = 8;
/// Samples of each recording that the grid looks at.
const LOOKED_AT: usize = 30_000;

/// Wave numbers, rad/rad (rad/m).
pub(super) struct Waves {
    /// Those that shapes are made of, the most telling first.
    pub(super) kept: Vec<f64>,
    /// How many were looked at to choose them; 0 where there was no choice.
    pub(super) looked_at: usize,
}

/// The wave numbers for a base of these columns and its residual.
pub(super) fn wave_numbers<'a>(
    builder: &Builder<'_>,
    base: impl Iterator<Item = &'a [f64]>,
    residual: &[f64],
) -> Waves {
    if builder.cases.first().is_some_and(|case| case.drive.motion == Motion::Rotary) {
        return Waves { kept: (1..=MOST_A_REVOLUTION).map(|n| n as f64).collect(), looked_at: 0 };
    }
    let grid = grid(builder);
    let rows = builder.layout.rows();
    let base: Vec<&[f64]> = base.collect();
    let remainder = outside(&basis(base.iter().copied(), rows), residual);
    let filter = Whitening::fit(remainder.as_slice(), builder.layout);
    let white: Vec<Vec<f64>> = base.iter().map(|it| filter.apply(it, builder.layout)).collect();
    let known = basis(white.iter().map(Vec::as_slice), rows);
    let e = outside(&known, &filter.apply(residual, builder.layout));
    let gains: Vec<f64> =
        grid.iter().map(|wave| gain(builder, &known, &e, &filter, *wave)).collect();
    let at = |k: usize| gains.get(k).copied().unwrap_or(0.0);
    let peak = |k: &usize| at(*k) >= at(k.wrapping_sub(1)) && at(*k) > at(k + 1);
    let mut peaks: Vec<usize> = (0..gains.len()).filter(peak).collect();
    peaks.sort_by(|a, b| gains[*b].total_cmp(&gains[*a]));
    let step = grid.get(1).map_or(0.0, |next| next - grid[0]);
    // The top of the parabola through a peak and its neighbours.
    let top = |k: &usize| {
        let (before, here, after) = (at(k.wrapping_sub(1)), at(*k), at(k + 1));
        let bend = before - 2.0 * here + after;
        let shift = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        grid[*k] + step * shift.clamp(-0.5, 0.5)
    };
    Waves { kept: peaks.iter().take(KEPT).map(top).collect(), looked_at: grid.len() }
}

/// Wave numbers from two periods over the travel to what the samples follow, evenly spread.
fn grid(builder: &Builder<'_>) -> Vec<f64> {
    let all = || builder.paths.iter().flat_map(|path| path.theta.iter().copied());
    let (low, high) =
        all().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
    let travel = high - low;
    // Without a finite position there is none either.
    if !travel.is_finite() || travel <= 0.0 {
        return Vec::new();
    }
    let speeds = builder.paths.iter().flat_map(|path| path.omega.iter().map(|v| v.abs()));
    let usual = quantile(speeds.filter(|v| *v > 0.0), 0.5);
    let period_s = builder.cases.first().map_or(1.0, |case| case.measured.period_s);
    let finest = TAU / (SAMPLES_A_PERIOD * usual * period_s);
    let coarsest = LEAST_OVER_TRAVEL * TAU / travel;
    let step = TAU / (STEPS * travel);
    (0..GRID).map(|k| coarsest + k as f64 * step).take_while(|wave| *wave < finest).collect()
}

/// Squared error that a sine and a cosine of that wave number explain, made white.
fn gain(
    builder: &Builder<'_>,
    known: &DMatrix<f64>,
    e: &DVector<f64>,
    filter: &Whitening,
    wave: f64,
) -> f64 {
    let columns = [f64::cos, f64::sin].map(|f| {
        let mut column = vec![0.0; builder.layout.rows()];
        for (case, path) in builder.cases.iter().zip(builder.paths) {
            let (h, motor) = (path.period_s, &case.drive.motor);
            let stay = (-motor.b_m / motor.j * h).exp();
            let gains = case.setting.observer.gains(case.measured);
            let (mut x, mut v) = (0.0, 0.0);
            for k in 0..path.len().min(LOOKED_AT) {
                for (j, channel) in case.measured.outputs.iter().enumerate() {
                    let shown = match channel.output {
                        Output::Position => x,
                        Output::Speed => v,
                        Output::Current
                        | Output::LoadSpeed
                        | Output::LoadPosition
                        | Output::Temperature => 0.0,
                    };
                    column[builder.layout.row(path.place, k, j)] += shown / case.noise[j];
                }
                if let Some(gains) = gains {
                    let shown = if gains.output == Output::Position { x } else { v };
                    v -= gains.speed * shown;
                    x -= gains.position * shown;
                }
                x += h * v;
                v = stay * v + h * f(wave * path.theta[k]) / motor.j;
            }
        }
        builder.layout.level(&mut column);
        outside(known, &filter.apply(&column, builder.layout))
    });
    let [a, b] = &columns;
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let (ae, be) = (a.dot(e), b.dot(e));
    let determinant = aa * bb - ab * ab;
    if determinant <= 1e-9 * aa * bb {
        return 0.0;
    }
    (bb * ae * ae - 2.0 * ab * ae * be + aa * be * be) / determinant
}
