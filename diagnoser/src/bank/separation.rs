//! Which mechanisms can be told apart on some rows, from the geometry of their columns alone.
//!
//! The whitened column of a mechanism is what a unit of its size does to the innovations. Two
//! mechanisms differ by the part of one column that is orthogonal to the other: with size s it
//! brings s^2 / 2 times its squared length in log-likelihood, whatever the noise.

use super::columns::Columns;
use super::filter::filter;
use super::process::{Belief, MECHANISMS, Process, Row, SENSORS};
use super::watch::Watch;

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
fn driven<const N: usize, P: Process<N>>(
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

impl<const N: usize, P: Process<N>> Watch<N, P> {
    /// The geometry of the mechanisms over the last horizon of a healthy run of this machine.
    pub fn separation(&self, rows: &[Row]) -> Option<Separation> {
        let (settling, last) = rows.split_at(rows.len().saturating_sub(self.horizon()));
        Some(separation(self.process(), &self.settled(settling)?, last))
    }

    /// The geometry over a horizon after that run and another in which the control effort is `change`
    /// times what it was, and the speed that it comes to: what a change of the set point would tell
    /// of faults that stand before it.
    pub fn separation_through(&self, rows: &[Row], change: f64) -> Option<(Separation, f64)> {
        let belief = self.settled(rows)?;
        let last = &rows[rows.len().saturating_sub(self.horizon())..];
        let after = last.last()?;
        let drives = |row: &Row| if row.control.is_finite() { row.control } else { row.shown[2] };
        let mean = last.iter().map(drives).sum::<f64>() / last.len() as f64;
        let efforts =
            [mean, change * mean].map(|effort| std::iter::repeat_n(effort, self.horizon()));
        let (rows, speed) = driven(self.process(), &belief, efforts.into_iter().flatten(), after);
        Some((separation(self.process(), &belief, &rows), speed))
    }

    /// What is known after a healthy run of this machine.
    fn settled(&self, rows: &[Row]) -> Option<Belief<N>> {
        let mut belief = self.process().begin(rows.first()?);
        // The machine is known; what the run leaves unknown of it is in the belief.
        for r in N - self.process().learned().len()..N {
            belief.covariance[r][r] = self.belief().covariance[r][r];
        }
        filter(&mut self.process().clone(), &mut belief, rows, |_, _, _| ());
        Some(belief)
    }
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
