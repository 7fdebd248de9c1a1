//! Pictures: the torque (voltage, resistance) that the model lacks, over each variable.
//!
//! A curve is a set of hats over its variable, fitted to the residual together with the base's
//! parameters; of what the base could take over itself, the smallest curve is shown. Its band
//! comes from a bootstrap of blocks: with G the information of the coefficients and s_b the score
//! of block b, a draw is G^+ sum_b +-s_b with random signs (the wild bootstrap of scores; Kline
//! and Santos, 2012). The band is of each point: 95 % of the draws lie in it. A picture, never
//! the test.

use drivescope_plant::drive::Motion;
use drivescope_plant::effects::info::{ActsOn, Variable};
use drivescope_plant::units::for_motion;
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use crate::projection::pseudo_inverse;

use super::columns::Builder;
use super::drive_motion::DriveMotion;
use super::score::outside;
use super::series::{Series, hat};
use super::shape::CURRENT_KNOTS;

/// Draws of the bootstrap.
const DRAWS: usize = 400;
/// Share of the draws within the band.
const WITHIN: f64 = 0.95;
/// Directions of the information below this share of the largest are not told: nearly the base's
/// own, they would only widen every band.
const IDENTIFIED: f64 = 1e-3;
/// Knots on each side of zero, as shares of the usual top.
const SIDE: [f64; 5] = [0.0, 0.05, 0.2, 0.5, 1.0];
/// Knots over a period of the angle, over time, over the losses.
const AROUND: usize = 12;
const IN_TIME: usize = 9;
const IN_HEAT: usize = 4;
/// Time constant of the losses that are shown, s.
const HEAT_S: f64 = 10.0;

/// What the model lacks over a variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// The variable, as in `where`.
    pub variable: &'static str,
    /// The balance: `torque` or `voltage`.
    pub balance: &'static str,
    /// What is drawn, in words.
    pub words: &'static str,
    /// Unit of `x`.
    pub x_unit: String,
    /// Unit of the values.
    pub unit: String,
    /// Places on the variable.
    pub x: Vec<f64>,
    /// The estimated value at each.
    pub value: Vec<f64>,
    /// Lower end of the band.
    pub lower: Vec<f64>,
    /// Upper end of the band.
    pub upper: Vec<f64>,
}

/// A curve that is to be drawn.
#[derive(Debug, Clone, Copy)]
enum Plan {
    /// Torque over the speed, in both directions.
    Speed,
    /// Torque over the current.
    CurrentTorque,
    /// Voltage over the current.
    CurrentVoltage,
    /// Torque over the angle within a period of that wave number.
    Angle(f64),
    /// Torque over the acceleration.
    Acceleration,
    /// Dry friction over the time.
    Time,
    /// Resistance over the losses.
    Heat,
}

impl Plan {
    fn columns(self) -> usize {
        match self {
            Self::Speed | Self::Acceleration => 2 * SIDE.len(),
            Self::CurrentTorque | Self::CurrentVoltage => 2 * CURRENT_KNOTS.len(),
            Self::Angle(_) => AROUND,
            Self::Time => IN_TIME,
            Self::Heat => IN_HEAT,
        }
    }

    /// Hat `column` at a value of the variable relative to its top: first the negative side, from
    /// the far end, then the positive one. Zero belongs to both, for friction jumps there.
    fn side(knots: &[f64], column: usize, x: f64) -> f64 {
        let n = knots.len();
        let (negative, j) = if column < n { (true, n - 1 - column) } else { (false, column - n) };
        if (x < 0.0) == negative && x != 0.0 { hat(knots, j, x.abs()) } else { 0.0 }
    }

    fn series(
        self,
        column: usize,
        path: &DriveMotion,
        builder: &Builder<'_>,
        samples: f64,
    ) -> Series {
        let scales = builder.scales;
        let each = |f: &dyn Fn(usize) -> f64| (0..path.len()).map(f).collect::<Vec<f64>>();
        match self {
            Self::Speed => {
                Series::torque(each(&|k| Self::side(&SIDE, column, path.omega[k] / scales.omega)))
            }
            Self::Acceleration => {
                Series::torque(each(&|k| Self::side(&SIDE, column, path.alpha[k] / scales.alpha)))
            }
            Self::CurrentTorque => {
                Series::torque(each(&|k| Self::side(&CURRENT_KNOTS, column, path.i[k] / scales.i)))
            }
            Self::CurrentVoltage => {
                Series::voltage(each(&|k| Self::side(&CURRENT_KNOTS, column, path.i[k] / scales.i)))
            }
            Self::Angle(wave) => {
                let width = std::f64::consts::TAU / AROUND as f64;
                Series::torque(each(&|k| {
                    let angle = (wave * path.theta[k]).rem_euclid(std::f64::consts::TAU) / width;
                    let away = (angle - column as f64).abs();
                    (1.0 - away.min(AROUND as f64 - away)).max(0.0)
                }))
            }
            Self::Time => {
                let last = (IN_TIME - 1) as f64;
                let knots: [f64; IN_TIME] = std::array::from_fn(|j| j as f64 / last);
                Series::torque(each(&|k| {
                    -path.direction[k] * hat(&knots, column, k as f64 / samples)
                }))
            }
            Self::Heat => {
                let stay = (-path.period_s / HEAT_S).exp();
                let knots: [f64; IN_HEAT] = std::array::from_fn(|j| j as f64 / IN_HEAT as f64);
                let mut heat = 0.0;
                let lost = path.i.iter().map(|i| {
                    heat = stay * heat + (1.0 - stay) * (i / scales.i).powi(2);
                    // The losses of a bench are far below those at the top current.
                    -i * hat(&knots, column, (10.0 * heat).min(1.0))
                });
                Series::voltage(lost.collect())
            }
        }
    }

    /// Places of the knots in units of the variable.
    fn places(self, builder: &Builder<'_>, longest_s: f64) -> Vec<f64> {
        let sides = |knots: &[f64], top: f64| {
            let negative = knots.iter().rev().map(|k| -k * top);
            negative.chain(knots.iter().map(|k| k * top)).collect::<Vec<f64>>()
        };
        let even = |count: usize, top: f64| (0..count).map(|j| j as f64 * top).collect();
        match self {
            Self::Speed => sides(&SIDE, builder.scales.omega),
            Self::Acceleration => sides(&SIDE, builder.scales.alpha),
            Self::CurrentTorque | Self::CurrentVoltage => sides(&CURRENT_KNOTS, builder.scales.i),
            Self::Angle(wave) => even(AROUND, std::f64::consts::TAU / wave / AROUND as f64),
            Self::Time => even(IN_TIME, longest_s / (IN_TIME - 1) as f64),
            Self::Heat => even(IN_HEAT, 0.1 * builder.scales.i.powi(2) / IN_HEAT as f64),
        }
    }

    fn about(self) -> (Variable, ActsOn, &'static str) {
        match self {
            Self::Speed => (Variable::Omega, ActsOn::Torque, "torque missing over the speed"),
            Self::CurrentTorque => {
                (Variable::Current, ActsOn::Torque, "torque missing over the current")
            }
            Self::CurrentVoltage => {
                (Variable::Current, ActsOn::Voltage, "voltage missing over the current")
            }
            Self::Angle(_) => {
                (Variable::Theta, ActsOn::Torque, "torque missing over a period of the angle")
            }
            Self::Acceleration => {
                (Variable::Acceleration, ActsOn::Torque, "torque missing over the acceleration")
            }
            Self::Time => (Variable::Time, ActsOn::Torque, "dry friction missing over the time"),
            Self::Heat => {
                (Variable::Temperature, ActsOn::Voltage, "resistance missing over the losses")
            }
        }
    }
}

/// Residual and blocks as the curves need them.
pub(super) struct Evidence<'a> {
    /// Basis of the base's columns.
    pub(super) known: &'a DMatrix<f64>,
    pub(super) residual: &'a [f64],
    pub(super) blocks: (&'a [usize], usize),
    pub(super) seed: u64,
}

/// All curves; over the angle for that wave number.
pub(super) fn curves(builder: &Builder<'_>, evidence: &Evidence<'_>, wave: f64) -> Vec<Curve> {
    let force = builder.paths.iter().any(|path| path.force);
    let mut plans = vec![Plan::Speed, Plan::Angle(wave), Plan::Acceleration, Plan::Time];
    if !force {
        plans.extend([Plan::CurrentTorque, Plan::CurrentVoltage, Plan::Heat]);
    }
    plans.into_iter().map(|plan| curve(plan, builder, evidence)).collect()
}

fn curve(plan: Plan, builder: &Builder<'_>, evidence: &Evidence<'_>) -> Curve {
    let samples = builder.paths.iter().map(DriveMotion::len).max().unwrap_or(1) as f64;
    let columns = builder
        .columns(plan.columns(), &|column, path| plan.series(column, path, builder, samples));
    let remainder: Vec<DVector<f64>> =
        columns.iter().map(|column| outside(evidence.known, column)).collect();
    let remainder = DMatrix::from_columns(&remainder);
    let e = outside(evidence.known, evidence.residual);
    let inverse = pseudo_inverse(remainder.tr_mul(&remainder), IDENTIFIED);
    let coefficients = &inverse * remainder.tr_mul(&e);
    let remains = &e - &remainder * &coefficients;
    let mut scores = DMatrix::<f64>::zeros(remainder.ncols(), evidence.blocks.1);
    for (row, block) in evidence.blocks.0.iter().enumerate() {
        for j in 0..remainder.ncols() {
            scores[(j, *block)] += remainder[(row, j)] * remains[row];
        }
    }
    let moved = inverse * scores;
    let mut random = Pcg64::seed_from_u64(evidence.seed);
    let mut draws: Vec<Vec<f64>> = vec![Vec::with_capacity(DRAWS); remainder.ncols()];
    for _ in 0..DRAWS {
        let signs =
            DVector::from_fn(
                evidence.blocks.1,
                |_, _| {
                    if random.random::<bool>() { 1.0 } else { -1.0 }
                },
            );
        let draw = &moved * signs;
        draws.iter_mut().zip(draw.iter()).for_each(|(all, one)| all.push(one.abs()));
    }
    let half = |all: &mut Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all[((DRAWS - 1) as f64 * WITHIN) as usize]
    };
    let halves: Vec<f64> = draws.iter_mut().map(half).collect();
    let (variable, balance, words) = plan.about();
    let longest_s = samples * builder.paths.first().map_or(1.0, |path| path.period_s);
    let value: Vec<f64> = coefficients.iter().copied().collect();
    let motion = builder.cases.first().map_or(Motion::Rotary, |case| case.drive.motion);
    let unit = |rotary: &str| for_motion(motion, rotary);
    Curve {
        variable: variable.name(),
        balance: balance.name(),
        words,
        x_unit: match plan {
            Plan::Speed => unit("rad/s"),
            Plan::Angle(_) => unit("rad"),
            Plan::Acceleration => unit("rad/s^2"),
            Plan::CurrentTorque | Plan::CurrentVoltage => "A".to_owned(),
            Plan::Time => "s".to_owned(),
            Plan::Heat => "A^2".to_owned(),
        },
        unit: match plan {
            Plan::CurrentVoltage => "V".to_owned(),
            Plan::Heat => "ohm".to_owned(),
            _ => unit("N m"),
        },
        x: plan.places(builder, longest_s),
        lower: value.iter().zip(&halves).map(|(value, half)| value - half).collect(),
        upper: value.iter().zip(&halves).map(|(value, half)| value + half).collect(),
        value,
    }
}
