//! The series that a column of a shape adds to a balance, or to what a sensor shows.

use std::f64::consts::TAU;

use super::drive_motion::{DriveMotion, Scales};
use super::shape::{
    BENT_S, CURRENT_KNOTS, FLUX_SPEED_KNOTS, HEAT_S, RESONANCES_HZ, REST_SHARES, SPEED_KNOTS,
    Shape, TIME_KNOTS,
};
use crate::measured::Output;
use crate::response::Forcing;

/// Damping ratio of the oscillators: broad enough that five of them cover a decade.
const DAMPING: f64 = 0.1;
/// Time by which a shown speed is late, s: only the scale of the columns.
const LATE_S: f64 = 0.01;
/// Share of the limit from which on the input counts as limited.
const LIMITED: f64 = 0.995;

/// One value a sample.
pub(super) enum Series {
    /// Added to the balances.
    Balance(Forcing),
    /// Added to what a sensor shows.
    Shown(Output, Vec<f64>),
}

impl Series {
    /// A torque alone, N m (N), positive forward.
    pub(super) fn torque(torque: Vec<f64>) -> Self {
        Self::Balance(Forcing::torque(torque))
    }

    /// A voltage alone, in the armature circuit, V (force-driven: added to u).
    pub(super) fn voltage(voltage: Vec<f64>) -> Self {
        Self::Balance(Forcing::voltage(voltage))
    }
}

/// Piecewise linear hat number `j` over the knots: 1 at its knot, 0 at the others; the last
/// stays 1 beyond.
pub(super) fn hat(knots: &[f64], j: usize, x: f64) -> f64 {
    let at = knots[j];
    if x >= at {
        knots.get(j + 1).map_or(1.0, |next| (1.0 - (x - at) / (next - at)).max(0.0))
    } else if j == 0 {
        0.0
    } else {
        (1.0 - (at - x) / (at - knots[j - 1])).max(0.0)
    }
}

impl Shape {
    /// The series of that column; `limit` is the largest input there can be, if it is known.
    pub(super) fn series(
        self,
        column: usize,
        path: &DriveMotion,
        scales: &Scales,
        limit: Option<f64>,
    ) -> Series {
        let each = |f: &dyn Fn(usize) -> f64| (0..path.len()).map(f).collect::<Vec<f64>>();
        let speed = |k: usize| path.omega[k].abs() / scales.omega;
        let current = |k: usize| path.i[k].abs() / scales.i;
        let wave = |number: f64, k: usize| {
            let angle = number * path.theta[k];
            if column == 0 { angle.cos() } else { angle.sin() }
        };
        let flux = |share: &dyn Fn(usize) -> f64| {
            let torque = each(&|k| share(k) * path.i[k]);
            if path.force {
                return Series::torque(torque);
            }
            Series::Balance(Forcing { torque, voltage: each(&|k| -share(k) * path.omega[k]) })
        };
        match self {
            Self::TorqueOverSpeed => {
                Series::torque(each(&|k| -path.direction[k] * hat(&SPEED_KNOTS, column, speed(k))))
            }
            Self::DragOverSpeed => {
                Series::torque(each(&|k| -path.direction[k] * speed(k).powi(column as i32 + 2)))
            }
            Self::FrictionNearRest => {
                let near = REST_SHARES[column];
                Series::torque(each(&|k| -path.direction[k] * (-(speed(k) / near).powi(2)).exp()))
            }
            Self::TorqueAfterReversal => {
                let way = BENT_S[column] * scales.omega;
                Series::torque(each(&|k| path.direction[k] * (-path.since[k] / way).exp()))
            }
            Self::FluxOverSpeed => flux(&|k| hat(&FLUX_SPEED_KNOTS, column + 1, speed(k))),
            Self::TorqueByDirection => Series::torque(each(&|k| match column {
                0 => -path.direction[k].abs(),
                _ => -speed(k),
            })),
            Self::VoltageOverCurrent => Series::voltage(each(&|k| {
                -path.i[k].signum() * hat(&CURRENT_KNOTS, column, current(k))
            })),
            Self::FluxOverCurrent => flux(&|k| hat(&CURRENT_KNOTS, column, current(k))),
            Self::FrictionOverCurrent => {
                Series::torque(each(&|k| -path.direction[k] * current(k).powi(column as i32 + 1)))
            }
            Self::CurrentOffset => Series::Shown(Output::Current, vec![1.0; path.len()]),
            Self::TorqueOverAngle(number) => Series::torque(each(&|k| wave(number, k))),
            Self::FrictionOverAngle(number) => {
                Series::torque(each(&|k| -path.direction[k] * wave(number, k)))
            }
            Self::FluxOverAngle(number) => flux(&|k| wave(number, k)),
            Self::SpeedShownOverAngle(number) => {
                Series::Shown(Output::Speed, each(&|k| path.omega[k] * wave(number, k)))
            }
            Self::FrictionOverTime(place) => {
                let last = (TIME_KNOTS - 1) as f64;
                let knots: [f64; TIME_KNOTS] = std::array::from_fn(|j| j as f64 / last);
                let here = if path.place == place { 1.0 } else { 0.0 };
                let at = |k: usize| path.share[k];
                Series::torque(each(&|k| -here * path.direction[k] * hat(&knots, column, at(k))))
            }
            Self::FrictionDrift(place) => {
                let here = if path.place == place { 1.0 } else { 0.0 };
                let at = |k: usize| path.share[k].powi(column as i32 + 1);
                Series::torque(each(&|k| -here * path.direction[k] * at(k)))
            }
            Self::ResistanceOverHeat => Series::voltage(heated(path, scales, HEAT_S[column])),
            Self::Resonances => Series::torque(swinging(path, scales, column)),
            // Late by a part d of a sample: (d / h) (u_(k-1) - u_k) on its mean over the sample.
            Self::LateInput => Series::voltage(each(&|k| path.u[k.saturating_sub(1)] - path.u[k])),
            Self::SpeedShownLate => {
                // Of the samples that have passed: the input of the coming one may answer what was
                // measured here, and in a closed loop the sensor's noise would show as lateness.
                let (h, alpha) = (path.period_s, &path.alpha);
                let before = |k: usize, samples: usize| alpha[k.saturating_sub(samples)];
                Series::Shown(
                    Output::Speed,
                    each(&|k| match column {
                        0 => -LATE_S * before(k, 1),
                        _ => LATE_S * LATE_S * (before(k, 1) - before(k, 2)) / h,
                    }),
                )
            }
            Self::AtLimit => {
                let limit = limit.unwrap_or(f64::INFINITY);
                Series::voltage(each(&|k| {
                    if path.u[k].abs() >= LIMITED * limit { -path.u[k].signum() } else { 0.0 }
                }))
            }
        }
    }
}

/// -i times the losses, smoothed over that time: the voltage at a resistance that follows them.
fn heated(path: &DriveMotion, scales: &Scales, time_s: f64) -> Vec<f64> {
    let stay = (-path.period_s / time_s).exp();
    let mut heat = 0.0;
    let mut lost = |i: &f64| {
        heat = stay * heat + (1.0 - stay) * (i / scales.i).powi(2);
        -i * heat
    };
    path.i.iter().map(&mut lost).collect()
}

/// Torque of a small mass on a spring (even columns) and damper (odd ones) that the shaft carries.
fn swinging(path: &DriveMotion, scales: &Scales, column: usize) -> Vec<f64> {
    let rate = TAU * RESONANCES_HZ[column / 2];
    // A spring cannot swing faster than samples follow: then it is stiff and nothing is missing.
    let h = path.period_s.min(1.0 / rate);
    let (mut x, mut v) = (0.0, 0.0);
    let mut torque = |alpha: &f64| {
        v += h * (-alpha - 2.0 * DAMPING * rate * v - rate * rate * x);
        x += h * v;
        scales.inertia * if column.is_multiple_of(2) { rate * rate * x } else { rate * v }
    };
    path.alpha.iter().map(&mut torque).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_are_a_partition_of_one() {
        for x in [0.0, 0.01, 0.1, 0.59, 1.0, 7.0] {
            let sum: f64 = (0..SPEED_KNOTS.len()).map(|j| hat(&SPEED_KNOTS, j, x)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{x}: {sum}");
        }
        assert_eq!(hat(&SPEED_KNOTS, 3, SPEED_KNOTS[3]), 1.0);
    }
}
