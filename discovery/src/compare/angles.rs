//! Wave numbers that a shape over the angle may have.
//!
//! On a shaft these are 1 to 48 periods a revolution. On a linear axis any spatial period may be:
//! the outputs' response to a sine of the position is computed over a grid by the bare inertia
//! with its viscous friction and the observer, without stick-slip, and the best few stay for the
//! exact columns.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::columns::Maker;
use super::path::quantile;
use super::score::outside;
use crate::measured::Output;
use drivescope_plant::drive::Motion;

/// Periods a revolution.
const MOST_A_REVOLUTION: usize = 48;
/// Periods over the whole travel at least, and steps of the grid a period over the travel.
const LEAST_OVER_TRAVEL: f64 = 2.0;
const STEPS: f64 = 1.5;
/// Grid points at most.
const GRID: usize = 500;
/// Samples that a period takes at the usual speed, at least.
const SAMPLES_A_PERIOD: f64 = 8.0;
/// Wave numbers that stay.
const KEPT: usize = 8;
/// Samples of each recording that the grid looks at.
const LOOKED_AT: usize = 30_000;

/// The wave numbers, rad/rad (rad/m). `known` is a basis of the base's columns.
pub(super) fn wave_numbers(maker: &Maker<'_>, known: &DMatrix<f64>, residual: &[f64]) -> Vec<f64> {
    if maker.cases.first().is_some_and(|case| case.drive.motion == Motion::Rotary) {
        return (1..=MOST_A_REVOLUTION).map(|n| n as f64).collect();
    }
    let all = || maker.paths.iter().flat_map(|path| path.theta.iter().copied());
    let (low, high) =
        all().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
    let travel = high - low;
    // Without a finite position there is none either.
    if !travel.is_finite() || travel <= 0.0 {
        return Vec::new();
    }
    let speeds = maker.paths.iter().flat_map(|path| path.omega.iter().map(|v| v.abs()));
    let usual = quantile(speeds.filter(|v| *v > 0.0), 0.5);
    let period_s = maker.cases.first().map_or(1.0, |case| case.measured.period_s);
    let finest = TAU / (SAMPLES_A_PERIOD * usual * period_s);
    let coarsest = LEAST_OVER_TRAVEL * TAU / travel;
    let step = TAU / (STEPS * travel);
    let grid = (0..GRID).map(|k| coarsest + k as f64 * step).take_while(|wave| *wave < finest);
    let mut gains: Vec<(f64, f64)> =
        grid.map(|wave| (gain(maker, known, residual, wave), wave)).collect();
    gains.sort_by(|a, b| b.0.total_cmp(&a.0));
    gains.into_iter().take(KEPT).map(|(_, wave)| wave).collect()
}

/// Squared error that a sine and a cosine of that wave number explain.
fn gain(maker: &Maker<'_>, known: &DMatrix<f64>, residual: &[f64], wave: f64) -> f64 {
    let columns = [f64::cos, f64::sin].map(|f| {
        let mut column = vec![0.0; maker.layout.rows()];
        for (case, path) in maker.cases.iter().zip(maker.paths) {
            let (h, motor) = (path.period_s, &case.drive.motor);
            let stay = (-motor.b_m / motor.j * h).exp();
            let gains = case.setting.observer.gains(case.measured);
            let (mut x, mut v) = (0.0, 0.0);
            for k in 0..path.len().min(LOOKED_AT) {
                for (j, channel) in case.measured.outputs.iter().enumerate() {
                    let shown = match channel.output {
                        Output::Position => x,
                        Output::Speed => v,
                        Output::Current => 0.0,
                    };
                    column[maker.layout.row(path.place, k, j)] += shown / case.noise[j];
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
        maker.layout.level(&mut column);
        outside(known, &column)
    });
    let e = outside(known, residual);
    let [a, b] = &columns;
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let (ae, be) = (a.dot(&e), b.dot(&e));
    let determinant = aa * bb - ab * ab;
    if determinant <= 1e-9 * aa * bb {
        return 0.0;
    }
    (bb * ae * ae - 2.0 * ab * ae * be + aa * be * be) / determinant
}
