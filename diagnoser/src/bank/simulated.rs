//! Healthy runs of the process itself, for limits that no recording is long enough for.
//!
//! The filter is conditioned on the control effort, so that it does not matter where that comes
//! from: it steps and ramps between levels up to the greatest that was recorded, in both
//! directions, with the jitter that was recorded on it.

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::process::{Belief, Process, Row, SENSORS};

/// Time for which a level is held at least and at most, as shares of a second.
const HELD_S: (f64, f64) = (0.5, 4.0);
/// Share of the changes that are ramps; the others are steps.
const RAMPS: f64 = 0.5;

/// What drives a simulated run, as recorded runs were driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driving {
    /// Sampling time, s.
    pub period_s: f64,
    /// Magnitude of the control effort or voltage that is usual, and the greatest.
    pub usual: f64,
    /// Greatest magnitude.
    pub greatest: f64,
    /// Standard deviation of what changes from sample to sample.
    pub jitter: f64,
    /// Whether the control effort is known; else the voltage is what drives.
    pub controlled: bool,
    /// Whether each sensor shows something.
    pub measured: [bool; SENSORS],
}

impl Driving {
    /// What drove those rows; nothing if neither control effort nor voltage was recorded.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Row> + Clone, period_s: f64) -> Option<Self> {
        let controlled = rows.clone().any(|row| row.control.is_finite());
        let drives = |row: &Row| if controlled { row.control } else { row.shown[2] };
        let efforts: Vec<f64> = rows.clone().map(drives).filter(|x| x.is_finite()).collect();
        if efforts.is_empty() {
            return None;
        }
        let mut magnitudes: Vec<f64> = efforts.iter().map(|x| x.abs()).collect();
        magnitudes.sort_by(f64::total_cmp);
        // White jitter of variance s^2 has differences of variance 2 s^2; the median keeps steps out.
        let mut changes: Vec<f64> = efforts.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        changes.sort_by(f64::total_cmp);
        let median = changes.get(changes.len() / 2).copied().unwrap_or(0.0);
        /// Standard deviation over median magnitude of a normal distribution.
        const PER_MEDIAN: f64 = 1.4826;
        Some(Self {
            period_s,
            usual: magnitudes[magnitudes.len() / 2],
            greatest: magnitudes[magnitudes.len() - 1],
            jitter: PER_MEDIAN * median / std::f64::consts::SQRT_2,
            controlled,
            measured: std::array::from_fn(|m| rows.clone().any(|row| row.shown[m].is_finite())),
        })
    }
}

/// A run of `baseline` rows at the usual effort and `rows` that go through the whole range, of a
/// machine whose parameters differ by those fractions. Equal seeds give equal rows.
pub fn simulated<const N: usize, P: Process<N>>(
    process: &P,
    driving: &Driving,
    (baseline, rows): (usize, usize),
    machine: &[f64],
    seed: u64,
) -> Vec<Row> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let normal = |random: &mut Pcg64Mcg| -> f64 { StandardNormal.sample(random) };
    let shown = driving.measured.map(|is| if is { 0.0 } else { f64::NAN });
    let mut process = process.clone();
    let mut belief = process.begin(&Row { control: 0.0, shown });
    let moving = N - process.learned().len();
    belief.mean[moving..].copy_from_slice(machine);
    process.settle(&mut belief);
    let (mut x, quanta) = (belief.mean, process.quanta());
    let (mut level, mut slope, mut remainder) = (driving.usual, 0.0, baseline);
    let mut made = Vec::with_capacity(baseline + rows);
    for k in 0..baseline + rows {
        if remainder == 0 {
            let seconds = random.random_range(HELD_S.0..HELD_S.1);
            remainder = ((seconds / driving.period_s) as usize).max(1);
            let next = random.random_range(-driving.greatest..=driving.greatest);
            let ramps = random.random_range(0.0..1.0) < RAMPS;
            slope = if ramps { (next - level) / remainder as f64 } else { 0.0 };
            level = if ramps { level } else { next };
        }
        remainder -= 1;
        level += if k < baseline { 0.0 } else { slope };
        let effort = level + driving.jitter * normal(&mut random);
        let mut row = Row { control: effort, shown };
        if !driving.controlled {
            (row.control, row.shown[2]) = (f64::NAN, effort);
        }
        let sensed = process.sense(&x, &row);
        for m in (0..SENSORS).filter(|m| driving.measured[*m] && sensed.variance[*m] > 0.0) {
            // The variance holds that of the quantum, which reading in steps brings by itself.
            let quantum = quanta[m];
            let white = (sensed.variance[m] - quantum * quantum / 12.0).max(0.0).sqrt();
            let value = sensed.shown[m] + white * normal(&mut random);
            row.shown[m] = if quantum > 0.0 { (value / quantum).round() * quantum } else { value };
        }
        let at = Belief { mean: x, covariance: [[0.0; N]; N] };
        let advanced = process.advance(&at, &row);
        x = advanced.next;
        let factor = square_root(advanced.added);
        let drawn: [f64; N] = std::array::from_fn(|_| normal(&mut random));
        for r in 0..N {
            (0..=r).for_each(|c| x[r] += factor[r][c] * drawn[c]);
        }
        made.push(row);
    }
    made
}

/// Lower triangle whose product with its transpose is a covariance, which may be singular.
fn square_root<const N: usize>(covariance: [[f64; N]; N]) -> [[f64; N]; N] {
    let mut root = [[0.0; N]; N];
    for c in 0..N {
        let before: f64 = root[c][..c].iter().map(|x: &f64| x * x).sum();
        root[c][c] = (covariance[c][c] - before).max(0.0).sqrt();
        for r in c + 1..N {
            if root[c][c] > 0.0 {
                let shared: f64 = (0..c).map(|k| root[r][k] * root[c][k]).sum();
                root[r][c] = (covariance[r][c] - shared) / root[c][c];
            }
        }
    }
    root
}
