//! ARX orders by AIC over a grid.
//!
//! Every candidate is fitted to the same samples, those that the widest one can use; otherwise
//! their criteria would not compare. One pass over the data serves them all.

use super::fit::{equations, fit_columns};
use super::{Arx, ArxError, ArxFit, Orders};
use crate::data::Data;

/// One candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderRow {
    pub orders: Orders,
    /// Its free parameters.
    pub parameters: usize,
    /// Sum of squared one-step errors, output unit squared.
    pub sse: f64,
    /// Its criterion; smaller is better.
    pub aic: f64,
}

/// All candidates that gave a stable model, and the best of them.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderTable {
    /// In the order of the grid: n_a outside, n_b inside.
    pub rows: Vec<OrderRow>,
    /// Orders with the smallest AIC.
    pub best: Orders,
    /// The best model, on the samples that all candidates share.
    pub fit: ArxFit,
}

impl Arx {
    /// Fits all orders 1..=n_a by 1..=n_b of `widest` and takes the smallest AIC.
    pub fn select(data: &Data, widest: Orders) -> Result<OrderTable, ArxError> {
        let equations = equations(data, widest)?;
        let inputs = data.inputs().len();
        let grid = (1..=widest.n_a).flat_map(|n_a| (1..=widest.n_b).map(move |n_b| (n_a, n_b)));
        let mut rows = Vec::new();
        let mut best: Option<(Orders, ArxFit)> = None;
        let mut last = ArxError::Unstable { n_a: widest.n_a, n_b: widest.n_b };
        for (n_a, n_b) in grid {
            let orders = Orders { n_a, n_b, constant: widest.constant };
            match fit_columns(&equations, inputs, widest, orders) {
                Ok(fit) => {
                    let parameters = orders.parameters(inputs);
                    rows.push(OrderRow { orders, parameters, sse: fit.sse, aic: fit.aic });
                    if best.as_ref().is_none_or(|(_, so_far)| fit.aic < so_far.aic) {
                        best = Some((orders, fit));
                    }
                }
                Err(error) => last = error,
            }
        }
        let Some((best, fit)) = best else {
            return Err(ArxError::NoOrder {
                candidates: widest.n_a * widest.n_b,
                n_a: widest.n_a,
                n_b: widest.n_b,
                last: Box::new(last),
            });
        };
        Ok(OrderTable { rows, best, fit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::testing::noise;

    #[test]
    fn the_orders_behind_the_data_are_found() {
        // The truth has n_a = 2 and n_b = 3.
        let (u, e) = (noise(2000, 1), noise(2000, 2));
        let mut y = vec![0.0; 2000];
        for k in 3..2000 {
            y[k] = 1.5 * y[k - 1] - 0.7 * y[k - 2] + u[k - 1] + 0.5 * u[k - 3] + 0.05 * e[k];
        }
        let data =
            Data::new(vec![Column { name: "u", values: &u }], Column { name: "y", values: &y })
                .unwrap();
        let table = Arx::select(&data, Orders { n_a: 6, n_b: 6, constant: true }).unwrap();
        assert_eq!(table.rows.len(), 36);
        let row = |n_a, n_b| {
            let orders = Orders { n_a, n_b, constant: true };
            *table.rows.iter().find(|row| row.orders == orders).unwrap()
        };
        // Too low an order is out of question; a few too many parameters cost little.
        let truth = row(2, 3);
        assert!(table.best.n_a >= 2 && table.best.n_b >= 3, "{:?}", table.best);
        assert!(row(1, 3).aic > truth.aic + 100.0 && row(2, 2).aic > truth.aic + 100.0);
        assert!(truth.aic - row(table.best.n_a, table.best.n_b).aic < 10.0);
        assert!(row(6, 6).aic > truth.aic);
        let smallest = table.rows.iter().map(|row| row.aic).fold(f64::INFINITY, f64::min);
        assert_eq!(table.fit.aic, smallest);
        // The same answer as a fit on its own over the same samples.
        let reach = table.best.n_a.max(table.best.n_b);
        let own = Arx::fit(&data.span(6 - reach..2000), table.best).unwrap();
        assert!((own.sse / table.fit.sse - 1.0).abs() < 1e-10);
    }
}
