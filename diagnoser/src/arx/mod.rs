//! ARX: a linear difference equation with a constant,
//!
//! y(k) + a_1 y(k-1) + .. + a_na y(k-na) = sum_j [b_j1 u_j(k-1) + .. + b_jnb u_j(k-nb)] + c.
//!
//! Source: L. Ljung, "System Identification", 2nd ed., (4.7); n_b counts past inputs. In free
//! run the past outputs are the model's own, in one-step prediction the measured ones.

mod fit;
mod free_run_orders;
mod model_orders;
mod orders;
mod shift;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use self::fit::{ArxError, ArxFit};
pub use self::free_run_orders::{FreeRunOrders, FreeRunRow};
pub(crate) use self::free_run_orders::{WORTH, leaves_half, longest_run_up};
pub use self::model_orders::Orders;
pub use self::orders::{OrderRow, OrderTable};
use crate::data::Data;
use crate::history::{History, dot};
use crate::memory::{Memory, MemoryError, Walk};
use crate::signal_model::SignalModel;
use crate::stability::step_down;

/// The coefficients of an ARX model, in units of the output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arx {
    /// a_1 .. a_na.
    pub a: Vec<f64>,
    /// b_j1 .. b_jnb for every input j.
    pub b: Vec<Vec<f64>>,
    /// c; 0 if the model has none.
    pub constant: f64,
}

impl Arx {
    /// Whether a free run stays bounded: all roots of A inside the unit circle, all finite.
    pub fn is_stable(&self) -> bool {
        let finite = self.b.iter().flatten().chain([&self.constant]).all(|c| c.is_finite());
        finite && step_down(&self.a).is_some()
    }

    /// A free run from rest.
    pub fn run(self: &Arc<Self>) -> ArxRun {
        ArxRun {
            past_y: History::new(self.a.len()),
            past_u: self.b.iter().map(|b| History::new(b.len())).collect(),
            output: [0.0],
            model: Arc::clone(self),
        }
    }

    /// One-step prediction of every sample from the measured past, zero before the first.
    ///
    /// Not for residuals: a fault enters the prediction through the measured past and is absorbed.
    pub fn one_step(self: &Arc<Self>, data: &Data) -> Vec<f64> {
        let mut run = self.run();
        let mut u = vec![0.0; data.inputs().len()];
        let measured = data.output().values;
        (0..data.len())
            .map(|k| {
                let predicted = run.predict();
                for (u, column) in u.iter_mut().zip(data.inputs()) {
                    *u = column.values[k];
                }
                run.remember(measured[k], &u);
                predicted
            })
            .collect()
    }
}

/// An ARX model in free run.
#[derive(Debug, Clone)]
pub struct ArxRun {
    model: Arc<Arx>,
    past_y: History,
    past_u: Vec<History>,
    output: [f64; 1],
}

impl ArxRun {
    fn predict(&self) -> f64 {
        let model = &self.model;
        let mut y = model.constant - dot(&model.a, self.past_y.window());
        for (b, past) in model.b.iter().zip(&self.past_u) {
            y += dot(b, past.window());
        }
        y
    }

    fn remember(&mut self, y: f64, u: &[f64]) {
        self.past_y.push(y);
        for (past, u) in self.past_u.iter_mut().zip(u) {
            past.push(*u);
        }
    }
}

impl SignalModel for ArxRun {
    fn inputs(&self) -> usize {
        self.model.b.len()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn reset(&mut self) {
        self.past_y.clear();
        self.past_u.iter_mut().for_each(History::clear);
    }

    #[inline]
    fn step(&mut self, u: &[f64]) -> &[f64] {
        let y = self.predict();
        self.remember(y, u);
        self.output = [y];
        &self.output
    }

    fn settle(&mut self, u: &[f64]) {
        let Arx { a, b, constant } = &*self.model;
        let driven = b.iter().zip(u).map(|(b, u)| b.iter().sum::<f64>() * u);
        let y = (constant + driven.sum::<f64>()) / (1.0 + a.iter().sum::<f64>());
        (0..a.len()).for_each(|_| self.past_y.push(y));
        for ((past, b), u) in self.past_u.iter_mut().zip(b).zip(u) {
            (0..b.len()).for_each(|_| past.push(*u));
        }
        self.output = [y];
    }
}

impl Memory for ArxRun {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.past_y.walk(walk)?;
        walk.each(&mut self.past_u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::signal_model::free_run;

    fn model() -> Arc<Arx> {
        Arc::new(Arx { a: vec![-0.5], b: vec![vec![2.0, 1.0], vec![0.0, -1.0]], constant: 0.25 })
    }

    #[test]
    fn the_free_run_follows_the_difference_equation() {
        let (u1, u2) = ([1.0, 0.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0]);
        let inputs = [("u1", &u1), ("u2", &u2)].map(|(name, values)| Column { name, values });
        let y = free_run(&mut model().run(), &inputs);
        let y1 = 0.5 * 0.25 + 2.0 + 0.25;
        let y2 = 0.5 * y1 + 1.0 + 0.25;
        assert_eq!(y[0], [0.25, y1, y2, 0.5 * y2 - 4.0 + 0.25]);
    }

    #[test]
    fn a_clone_replays_and_a_reset_starts_again() {
        let mut run = model().run();
        let first: Vec<f64> = (0..9).map(|k| run.step(&[f64::from(k), 1.0])[0]).collect();
        let mut copy = run.clone();
        let ahead: Vec<f64> = (0..9).map(|k| run.step(&[f64::from(k), 1.0])[0]).collect();
        let replay: Vec<f64> = (0..9).map(|k| copy.step(&[f64::from(k), 1.0])[0]).collect();
        assert_eq!(ahead, replay);
        assert_ne!(ahead, first);
        copy.reset();
        let again: Vec<f64> = (0..9).map(|k| copy.step(&[f64::from(k), 1.0])[0]).collect();
        assert_eq!(again, first);
    }

    #[test]
    fn stability_is_seen() {
        assert!(model().is_stable());
        let unstable = Arx { a: vec![-1.01], b: vec![vec![1.0]], constant: 0.0 };
        assert!(!unstable.is_stable());
        let broken = Arx { a: vec![], b: vec![vec![f64::NAN]], constant: 0.0 };
        assert!(!broken.is_stable());
    }
}
