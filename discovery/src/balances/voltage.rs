//! The voltage balance L di/dt + R i + K_e omega + drop = u over windows of a recording.

use drivescope_plant::drive::Drive;
use drivescope_plant::parameters::NamedParameter;

use super::laws::{Laws, Point};
use super::runs::{Run, averaged, noise_of_current, noise_of_motion};
use super::solve::{Normal, Solution};
use crate::estimate::correlation_samples;
use crate::measured::{Measured, Output};

/// Windows that a recording must hold at least.
const LEAST_WINDOWS: usize = 12;
/// Share of noise in the squares of the current's derivative up to which a window is long enough:
/// an inductance shows in what is fast, so that the shortest is taken.
const QUIET: f64 = 0.02;
/// Intervals in the longest window's half: an armature is not slower than this beside the sampling
/// that is meant to show it.
const LONGEST: usize = 64;

/// Names of the motor's own columns.
pub(super) const OWN: [&str; 3] = ["R", "L", "K_e"];

/// A recording averaged over windows, its rows i, di/dt, omega and u.
pub(super) struct VoltageWindows {
    /// One list a run: current, derivative, speed, voltage.
    runs: Vec<[Vec<f64>; 4]>,
    /// Points along the motion, one an interval of each run.
    points: Vec<Vec<Point>>,
    length: usize,
    /// Length of an interval, s.
    period_s: f64,
    /// Variance of current, its derivative and speed by the sensors' noise.
    noise: [f64; 3],
}

impl VoltageWindows {
    /// Of a recording; none if it tells no current or no motion.
    pub(super) fn of(measured: &Measured, runs: &[Run], sds: &[f64]) -> Option<Self> {
        let h = measured.period_s;
        let sd = |output: Output| {
            let mut pairs = measured.outputs.iter().zip(sds);
            pairs.find(|(it, _)| it.output == output).map(|(_, sd)| *sd)
        };
        let of_current = sd(Output::Current)?;
        let by_position = measured.output(Output::Speed).is_none();
        let of_motion = sd(if by_position { Output::Position } else { Output::Speed })?;
        let longest = runs.iter().map(|run| run.speed.len()).max()?;
        let most = (longest / (2 * LEAST_WINDOWS)).clamp(1, LONGEST);
        let share = |length: usize| {
            let squares = runs.iter().flat_map(|run| averaged(&run.slope, length));
            let (sum, count) = squares.fold((0.0, 0), |(sum, n), a| (sum + a * a, n + 1));
            let noise = noise_of_current(h, length)[1] * of_current * of_current;
            noise / (sum / f64::from(count.max(1)))
        };
        let mut best = (f64::INFINITY, 1);
        let mut length = 1;
        while length <= most {
            let now = share(length);
            if now < best.0 {
                best = (now, length);
            }
            if now <= QUIET {
                break;
            }
            length = length * 3 / 2 + 1;
        }
        let length = best.1;
        let [current, slope] = noise_of_current(h, length).map(|gain| gain * of_current.powi(2));
        let speed = noise_of_motion(by_position, h, length)[0] * of_motion.powi(2);
        let long: Vec<&Run> = runs.iter().filter(|run| run.speed.len() >= 2 * length).collect();
        let rows = |run: &&Run| {
            [&run.current, &run.slope, &run.speed, &run.u].map(|values| averaged(values, length))
        };
        let points = |run: &&Run| {
            let point = |k: usize| Point {
                current: run.current[k],
                speed: run.speed[k],
                angle: run.angle[k],
                time: run.start_s + k as f64 * h,
            };
            (0..run.speed.len()).map(point).collect()
        };
        let made = Self {
            runs: long.iter().map(rows).collect(),
            points: long.iter().map(points).collect(),
            length,
            period_s: h,
            noise: [current, slope, speed],
        };
        (!made.runs.is_empty()).then_some(made)
    }

    fn dropped(&self, laws: &Laws) -> Vec<Vec<f64>> {
        let of = |points: &Vec<Point>| {
            let drop: Vec<f64> = points.iter().map(|point| laws.at(point)[1]).collect();
            averaged(&drop, self.length)
        };
        self.points.iter().map(of).collect()
    }
}

/// R, L, K_e (none where they are fixed or not told) and those parameters, over all recordings.
pub(super) fn solve(
    all: &[VoltageWindows],
    zero: &Drive,
    columns: &[NamedParameter],
    fixed: [bool; 3],
) -> Solution {
    let still = Laws::new(zero);
    let with = |it: &NamedParameter| {
        let mut drive = zero.clone();
        drive.set(&it.name, it.nominal).ok().map(|()| Laws::new(&drive))
    };
    let each: Vec<Laws> = columns.iter().filter_map(with).collect();
    let motor = &zero.motor;
    let known = [motor.r, motor.l, motor.k_e].map(|value| value.unwrap_or(0.0));
    let mut normal = Normal::new(3 + each.len());
    let mut noise = vec![0.0; 3 + each.len()];
    for windows in all {
        let drop = windows.dropped(&still);
        let shares: Vec<Vec<Vec<f64>>> = each.iter().map(|laws| windows.dropped(laws)).collect();
        let before = normal.rows();
        for (r, [current, slope, speed, u]) in windows.runs.iter().enumerate() {
            for k in 0..u.len() {
                let mut row = vec![current[k], slope[k], speed[k]];
                let taken: f64 = (0..3).filter(|it| fixed[*it]).map(|it| known[it] * row[it]).sum();
                let share = |(share, it): (&Vec<Vec<f64>>, &NamedParameter)| {
                    (share[r][k] - drop[r][k]) / it.nominal
                };
                row.extend(shares.iter().zip(columns).map(share));
                normal.push(&row, u[k] - taken - drop[r][k]);
            }
        }
        let added = (normal.rows() - before) as f64;
        (0..3).for_each(|it| noise[it] += windows.noise[it] * added);
    }
    noise.iter_mut().for_each(|it| *it /= normal.rows().max(1) as f64);
    let signed = columns.iter().map(|it| it.range.0 < 0.0);
    let signed: Vec<bool> = [false; 3].into_iter().chain(signed).collect();
    // The resistance and the constant before the inductance, which shows in few samples.
    let mut order: Vec<usize> = vec![0, 2, 1];
    order.retain(|k| !fixed[*k]);
    order.extend(3..3 + columns.len());
    normal.solve(&noise, &signed, &order)
}

/// What the drive leaves unexplained of the voltage, window by window, and the voltage.
fn missing(windows: &VoltageWindows, drive: &Drive) -> Vec<[f64; 2]> {
    let motor = &drive.motor;
    let [r, l, k_e] = [motor.r, motor.l, motor.k_e].map(|value| value.unwrap_or(0.0));
    let drop = windows.dropped(&Laws::new(drive));
    let of = |([current, slope, speed, u], drop): (&[Vec<f64>; 4], &Vec<f64>)| -> Vec<[f64; 2]> {
        let needed = |k: usize| r * current[k] + l * slope[k] + k_e * speed[k] + drop[k];
        (0..u.len()).map(|k| [u[k] - needed(k), u[k]]).collect()
    };
    windows.runs.iter().zip(&drop).flat_map(of).collect()
}

/// Squares of the voltage that the drive leaves unexplained, and of u, with their number.
pub(super) fn unexplained(windows: &VoltageWindows, drive: &Drive) -> [f64; 3] {
    let add = |[sum, all, n]: [f64; 3], [missing, u]: [f64; 2]| {
        [sum + missing * missing, all + u * u, n + 1.0]
    };
    missing(windows, drive).into_iter().fold([0.0; 3], add)
}

/// By how much a standard error is larger than of independent windows.
pub(super) fn factor(windows: &VoltageWindows, drive: &Drive) -> f64 {
    let remainder: Vec<f64> = missing(windows, drive).iter().map(|it| it[0]).collect();
    (1.0 + 2.0 * correlation_samples(&remainder, windows.period_s)).sqrt()
}
