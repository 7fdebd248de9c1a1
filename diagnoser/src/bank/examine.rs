//! What a fault leaves unexplained, and whether it grows.
//!
//! A name holds only if nothing is left: the innovations under the named fault have the size and
//! the whiteness that the process gives them, and no second mechanism explains what remains. The
//! rows after the onset are tested; thresholds are such that one true name in 200 is doubted.

use drivescope_numerics::ljung_box;

use super::columns::Columns;
use super::hypothesis::{Case, Fit};
use super::process::{Belief, MECHANISMS, Process, SENSORS};

/// Columns: the mechanisms, and the growth of the named fault.
const COLUMNS: usize = MECHANISMS + 1;
const GROWTH: usize = MECHANISMS;

/// Likelihood ratio from which a fault grows rather than stands: 5.2 standard deviations.
const GROWS: f64 = 14.0;
/// Likelihood ratio of a second mechanism: of a dozen, one exceeds it by chance in 20,000.
const SECOND: f64 = 12.0;
/// Deviation of the sum of squares, as a normal score: one in 200 by chance. It is the only test that
/// sees every unknown kind, and weak against one that is nearly a known one: at one in 2,000 a quarter
/// more of those get its name.
const TOO_LARGE: f64 = 2.6;
/// p value of the whiteness of each sensor's innovations, over that many lags.
const NOT_WHITE: f64 = 2e-5;
const LAGS: usize = 8;
/// Share of a column that must lie outside the named fault's for it to count as a second one.
const APART: f64 = 1e-3;

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Examined<const N: usize> {
    /// Whether the fault explains the rows.
    pub(crate) explains: bool,
    /// Normal score of the sum of squares that is left.
    pub(crate) excess: f64,
    /// The fit, with the growth that was found.
    pub(crate) fit: Fit,
    /// Logarithm of the likelihood that a growth gains of a fit that has none; 0 where it does not
    /// grow.
    pub(crate) gained: f64,
    /// Logarithm of the likelihood of all rows.
    pub(crate) log_likelihood: f64,
    /// Belief about the row after the last.
    pub(crate) end: Belief<N>,
}

/// Likelihood ratios of columns, one after the other, each of what those before it leave.
struct Projection {
    score: [f64; COLUMNS],
    gram: [[f64; COLUMNS]; COLUMNS],
    whole: [f64; COLUMNS],
}

impl Projection {
    /// Takes a column's share out of all others.
    fn take_out(&mut self, column: usize) {
        let pivot = self.gram[column][column];
        if pivot <= APART * self.whole[column] || pivot <= 0.0 {
            return;
        }
        let (row, score) = (self.gram[column], self.score[column]);
        for r in 0..COLUMNS {
            let share = row[r] / pivot;
            self.score[r] -= share * score;
            for c in 0..COLUMNS {
                self.gram[r][c] -= share * row[c];
            }
        }
    }

    /// Likelihood ratio of a column; 0 where it hardly differs from what was taken out.
    fn ratio(&self, column: usize) -> f64 {
        let remainder = self.gram[column][column];
        if remainder <= APART * self.whole[column] || remainder <= 0.0 {
            return 0.0;
        }
        0.5 * self.score[column].powi(2) / remainder
    }
}

/// The deviation of a sum of squares of `n` standard normal numbers as a normal score (E. B.
/// Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931), 684-688).
pub(crate) fn normal_score(squares: f64, n: f64) -> f64 {
    let spread = 2.0 / (9.0 * n);
    ((squares / n).cbrt() - (1.0 - spread)) / spread.sqrt()
}

impl<const N: usize, P: Process<N>> Case<'_, N, P> {
    /// Examines what a fit leaves; one that stands is given the chance to grow.
    pub(crate) fn examine(&self, fit: &Fit) -> Examined<N> {
        let Fit { mechanism, onset, .. } = *fit;
        // Growth about the middle of the rows, so that it is apart from the size.
        let middle = 0.5 * (self.kept.len() - 1 - onset) as f64;
        let mut columns = Columns::<N, COLUMNS>::new();
        let mut innovations: [Vec<f64>; SENSORS] = Default::default();
        let run = self.run(self.acting(fit), onset, |k, s, c, a| {
            if k < onset {
                return;
            }
            let grown = (k - onset) as f64 - middle;
            let with_growth = |columns: &[f64; MECHANISMS]| -> [f64; COLUMNS] {
                std::array::from_fn(|j| {
                    if j == GROWTH { grown * columns[mechanism] } else { columns[j] }
                })
            };
            for m in (0..SENSORS).filter(|m| c.inverse_sd[*m] > 0.0) {
                innovations[m].push(c.innovation[m]);
            }
            let on_sensors = s.columns.each_ref().map(with_growth);
            let on_states = a.columns.each_ref().map(with_growth);
            columns.step((&on_sensors, &on_states), s, c, a);
        });
        let Columns { score, gram, .. } = columns;
        let mut p = Projection { score, gram, whole: std::array::from_fn(|j| gram[j][j]) };
        let mut squares: f64 = innovations.iter().flatten().map(|w| w * w).sum();
        let measured = innovations.iter().map(Vec::len).sum::<usize>() as f64;
        let (shared, whole) = (p.gram[mechanism][GROWTH], p.gram[mechanism][mechanism]);
        p.take_out(mechanism);
        let (mut fit, mut gained, mut run) = (*fit, 0.0, run);
        if fit.growth.is_some() {
            p.take_out(GROWTH);
        } else if p.ratio(GROWTH) > GROWS {
            gained = p.ratio(GROWTH);
            squares -= 2.0 * gained;
            let remainder = p.gram[GROWTH][GROWTH];
            let (rate, sd) = (p.score[GROWTH] / remainder, 1.0 / remainder.sqrt());
            let until_last = middle - shared / whole;
            fit.size += rate * until_last;
            fit.sd = fit.sd.hypot(sd * until_last);
            fit.growth = Some((rate, sd));
            p.take_out(GROWTH);
            run = self.run(self.acting(&fit), onset, |_, _, _, _| ());
        }
        let second = (0..self.healthy.mechanisms().len()).map(|j| p.ratio(j));
        let alone = second.fold(0.0, f64::max) < SECOND;
        let white = innovations.iter().all(|of_sensor| {
            let test = ljung_box(of_sensor, LAGS);
            gained > 0.0 || test.is_none_or(|test| test.p_value > NOT_WHITE)
        });
        let excess = normal_score(squares, measured);
        let explains = alone && white && excess < TOO_LARGE;
        Examined { explains, excess, fit, gained, log_likelihood: run.log_likelihood, end: run.end }
    }
}
