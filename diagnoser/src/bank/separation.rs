//! Which mechanisms can be told apart on some rows, from the geometry of their columns alone.
//!
//! The whitened column of a mechanism is what a unit of its size does to the innovations. Two
//! mechanisms differ by the part of one column that is orthogonal to the other: with size s it
//! brings s^2 / 2 times its squared length in log-likelihood, whatever the noise.

use super::columns::Columns;
use super::filter::filter;
use super::process::{Belief, MECHANISMS, Process, Row, SENSORS};

/// Expected gain in log-likelihood from which a mechanism is told from another: a false one then
/// lies ahead in fewer than one case in a thousand.
const TOLD_APART: f64 = 8.0;

/// The geometry of all mechanisms over some rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Separation {
    /// Gram matrix of the columns.
    gram: Vec<Vec<f64>>,
}

/// The geometry over healthy rows, the faults beginning with the first of them; `belief` is about
/// that row.
pub fn separation<const N: usize, P: Process<N>>(
    process: &P,
    belief: &Belief<N>,
    rows: &[Row],
) -> Separation {
    let mut columns = Columns::<N, MECHANISMS>::new();
    let (mut process, mut belief) = (process.clone(), *belief);
    filter(&mut process, &mut belief, rows, |s, c, a| {
        columns.step((&s.columns, &a.columns), s, c, a);
    });
    let used = process.mechanisms().len();
    Separation { gram: columns.gram[..used].iter().map(|row| row[..used].to_vec()).collect() }
}

/// The rows that a process would show without noise under those control efforts (voltages, where
/// the row that they follow has no control effort), and the speed that it comes to.
pub(super) fn driven<const N: usize, P: Process<N>>(
    process: &P,
    belief: &Belief<N>,
    efforts: impl Iterator<Item = f64>,
    after: &Row,
) -> (Vec<Row>, f64) {
    let mut process = process.clone();
    let mut at = Belief { covariance: [[0.0; N]; N], ..*belief };
    let mut speed = f64::NAN;
    let row = |effort: f64| {
        let mut row = *after;
        match row.control.is_finite() {
            true => row.control = effort,
            false => row.shown[2] = effort,
        }
        let sensed = process.sense(&at.mean, &row);
        for m in (0..SENSORS).filter(|m| sensed.variance[*m] > 0.0) {
            if row.shown[m].is_finite() {
                row.shown[m] = sensed.shown[m];
            }
        }
        speed = sensed.shown[0];
        at.mean = process.advance(&at, &row).next;
        row
    };
    (efforts.map(row).collect(), speed)
}

impl Separation {
    /// Standard deviation of a mechanism's size if it is the only one that acts.
    pub fn sd(&self, mechanism: usize) -> f64 {
        1.0 / self.gram[mechanism][mechanism].sqrt()
    }

    /// Expected logarithm of the likelihood by which a fault of that size beats another mechanism
    /// at its best.
    pub fn gain(&self, (mechanism, size): (usize, f64), other: usize) -> f64 {
        let gram = &self.gram;
        let shared = gram[mechanism][other];
        let explained =
            if gram[other][other] > 0.0 { shared * shared / gram[other][other] } else { 0.0 };
        0.5 * size * size * (gram[mechanism][mechanism] - explained).max(0.0)
    }

    /// Whether a fault of that size shows on these rows at all.
    pub fn shows(&self, mechanism: usize, size: f64) -> bool {
        0.5 * size * size * self.gram[mechanism][mechanism] >= TOLD_APART
    }

    /// The mechanisms that a fault of that size cannot be told from.
    pub fn confused(&self, mechanism: usize, size: f64) -> Vec<usize> {
        let others = (0..self.gram.len()).filter(|other| *other != mechanism);
        others.filter(|other| self.gain((mechanism, size), *other) < TOLD_APART).collect()
    }
}
