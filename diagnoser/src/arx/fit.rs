//! ARX parameters by linear least squares over the one-step equation error.

use std::sync::Arc;

use drivescope_numerics::{LinearFit, Regression, RegressionError, aic};
use thiserror::Error;

use super::model_orders::Orders;
use super::{Arx, shift};
use crate::data::{Data, DataError};

/// Why an ARX model cannot be had from these data.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ArxError {
    /// The signals do not serve.
    #[error("ARX({n_a},{n_b}): {source}")]
    Data {
        /// Past outputs asked for.
        n_a: usize,
        /// Past inputs asked for.
        n_b: usize,
        /// What is wrong with the signals.
        source: DataError,
    },
    /// The equations do not serve.
    #[error("ARX({n_a},{n_b}): {source}")]
    Regression {
        /// Past outputs asked for.
        n_a: usize,
        /// Past inputs asked for.
        n_b: usize,
        /// What is wrong with the equations.
        source: RegressionError,
    },
    /// The fitted model explodes in free run.
    #[error(
        "ARX({n_a},{n_b}) fitted to these data is unstable in free run: lower the orders or give more data"
    )]
    Unstable {
        /// Past outputs.
        n_a: usize,
        /// Past inputs.
        n_b: usize,
    },
    /// No order in the search gave a usable model.
    #[error("none of the {candidates} orders up to ARX({n_a},{n_b}) gave a stable model: {last}")]
    NoOrder {
        /// Orders tried.
        candidates: usize,
        /// Most past outputs tried.
        n_a: usize,
        /// Most past inputs tried.
        n_b: usize,
        /// Why the last one failed.
        last: Box<ArxError>,
    },
}

/// A fitted ARX model and how well its equations hold.
#[derive(Debug, Clone, PartialEq)]
pub struct ArxFit {
    /// The model; stable.
    pub model: Arc<Arx>,
    /// Sum of squared one-step errors, output unit squared.
    pub sse: f64,
    /// Equations.
    pub rows: usize,
    /// AIC of the one-step errors.
    pub aic: f64,
}

impl Arx {
    /// Fits a model of the given orders by least squares: from the shift structure of its
    /// regressors, or by QR where they are close to dependent; the answers are the same.
    pub fn fit(data: &Data, orders: Orders) -> Result<ArxFit, ArxError> {
        let inputs = data.inputs().len();
        check(data, orders)?;
        // The short way is that of one run.
        let single = data.segments().len() == 1;
        if let Some((mut parameters, sse)) = single.then(|| shift::solve(data, orders)).flatten() {
            // The equation has its past outputs on the left.
            parameters[..orders.n_a].iter_mut().for_each(|a| *a = -*a);
            let rows = data.len() - orders.reach();
            return model_of(LinearFit { parameters, sse, rows }, inputs, orders);
        }
        let equations = equations(data, orders)?;
        fit_columns(&equations, inputs, orders, orders)
    }
}

/// Refuses data that cannot determine these orders.
fn check(data: &Data, orders: Orders) -> Result<(), ArxError> {
    let Orders { n_a, n_b, .. } = orders;
    let needed = orders.reach() + orders.parameters(data.inputs().len());
    data.require_samples(needed, "a fit of these orders")
        .and_then(|()| data.require_variation())
        .map_err(|source| ArxError::Data { n_a, n_b, source })
}

/// All equations of the given orders: columns -y(k-1).., u_j(k-1).. of every input, 1.
pub(super) fn equations(data: &Data, orders: Orders) -> Result<Regression, ArxError> {
    let Orders { n_a, n_b, constant } = orders;
    check(data, orders)?;
    let parameters = orders.parameters(data.inputs().len());
    let y = data.output().values;
    let mut regression = Regression::new(parameters);
    for k in data.segments().iter().flat_map(|segment| segment.clone().skip(orders.reach())) {
        let outputs = y[k - n_a..k].iter().rev().map(|y| -y);
        let inputs =
            data.inputs().iter().flat_map(|column| column.values[k - n_b..k].iter().rev().copied());
        regression.push(outputs.chain(inputs).chain(constant.then_some(1.0)), y[k]);
    }
    Ok(regression)
}

/// Solves for `orders` among equations made for `widest`, over the same samples.
pub(super) fn fit_columns(
    equations: &Regression,
    inputs: usize,
    widest: Orders,
    orders: Orders,
) -> Result<ArxFit, ArxError> {
    let Orders { n_a, n_b, constant } = orders;
    let input_columns =
        (0..inputs).flat_map(|j| (0..n_b).map(move |i| widest.n_a + j * widest.n_b + i));
    let last = widest.n_a + inputs * widest.n_b;
    let chosen: Vec<usize> =
        (0..n_a).chain(input_columns).chain(constant.then_some(last)).collect();
    let fit = equations.solve_columns(&chosen).map_err(|source| ArxError::Regression {
        n_a,
        n_b,
        source,
    })?;
    model_of(fit, inputs, orders)
}

/// The model with these parameters a.., b.., c.
fn model_of(fit: LinearFit, inputs: usize, orders: Orders) -> Result<ArxFit, ArxError> {
    let Orders { n_a, n_b, constant } = orders;
    let (a, rest) = fit.parameters.split_at(n_a);
    let b = (0..inputs).map(|j| rest[j * n_b..][..n_b].to_vec()).collect();
    let constant = if constant { rest[inputs * n_b] } else { 0.0 };
    let model = Arx { a: a.to_vec(), b, constant };
    if !model.is_stable() {
        return Err(ArxError::Unstable { n_a, n_b });
    }
    let aic = aic(fit.sse, fit.rows, fit.parameters.len());
    Ok(ArxFit { model: Arc::new(model), sse: fit.sse, rows: fit.rows, aic })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::signal_model::free_run;
    use crate::testing::noise;

    /// Noise-free data of a few hundred samples: rounding only.
    const ROUNDING: f64 = 1e-9;

    fn truth() -> Arc<Arx> {
        Arc::new(Arx {
            a: vec![-1.2, 0.5],
            b: vec![vec![0.3, 0.1], vec![-0.2, 0.4]],
            constant: 1.5,
        })
    }

    const ORDERS: Orders = Orders { n_a: 2, n_b: 2, constant: true };

    #[test]
    fn the_equation_behind_clean_data_is_found() {
        let (u1, u2) = (noise(300, 1), noise(300, 2));
        let inputs = vec![Column { name: "u1", values: &u1 }, Column { name: "u2", values: &u2 }];
        let y = free_run(&mut truth().run(), &inputs).swap_remove(0);
        let data = Data::new(inputs, Column { name: "y", values: &y }).unwrap();
        let fit = Arx::fit(&data, ORDERS).unwrap();
        let found = |m: &Arx| [m.a.clone(), m.b.concat(), vec![m.constant]].concat();
        for (found, truth) in found(&fit.model).iter().zip(found(&truth())) {
            assert!((found - truth).abs() < ROUNDING, "{found} against {truth}");
        }
        assert_eq!(fit.rows, 298);
        let one_step = fit.model.one_step(&data);
        let sse: f64 = y[2..].iter().zip(&one_step[2..]).map(|(y, p)| (y - p).powi(2)).sum();
        assert!((sse - fit.sse).abs() < ROUNDING);
    }

    #[test]
    fn no_equation_reaches_across_a_break() {
        let (u1, u2) = (noise(300, 7), noise(300, 8));
        let inputs = vec![Column { name: "u1", values: &u1 }, Column { name: "u2", values: &u2 }];
        let mut y = free_run(&mut truth().run(), &inputs).swap_remove(0);
        // Rows between the segments hold anything.
        y[140..150].fill(1e3);
        let data = Data::new(inputs, Column { name: "y", values: &y }).unwrap();
        let parted = data.clone().in_segments(vec![0..140, 150..300]);
        let fit = Arx::fit(&parted, ORDERS).unwrap();
        assert!(fit.sse < ROUNDING && fit.rows == 138 + 148, "{} of {}", fit.sse, fit.rows);
        assert!(Arx::fit(&data, ORDERS).is_err() || Arx::fit(&data, ORDERS).unwrap().sse > 1.0);
    }

    #[test]
    fn sse_is_that_of_the_one_step_prediction() {
        let (u, e) = (noise(400, 3), noise(400, 4));
        let y: Vec<f64> = (0..400).map(|k| e[k] + if k > 0 { u[k - 1] } else { 0.0 }).collect();
        let data =
            Data::new(vec![Column { name: "u", values: &u }], Column { name: "y", values: &y })
                .unwrap();
        let fit = Arx::fit(&data, ORDERS).unwrap();
        let predicted = fit.model.one_step(&data);
        let sse: f64 = y[2..].iter().zip(&predicted[2..]).map(|(y, p)| (y - p).powi(2)).sum();
        assert!((sse / fit.sse - 1.0).abs() < ROUNDING, "{sse} against {}", fit.sse);
    }

    #[test]
    fn unusable_data_are_refused() {
        let (u, y) = (noise(40, 5), noise(40, 6));
        let column = |name, values| Column { name, values };
        let short = Data::new(vec![column("u", &u)], column("y", &y)).unwrap();
        let wide = Orders { n_a: 20, n_b: 20, constant: true };
        let error = Arx::fit(&short, wide).unwrap_err().to_string();
        assert_eq!(
            error,
            "ARX(20,20): a fit of these orders needs at least 61 samples, there are 40"
        );
        let still = [1.0; 40];
        let constant = Data::new(vec![column("u", &still)], column("y", &y)).unwrap();
        let error = Arx::fit(&constant, ORDERS).unwrap_err().to_string();
        assert!(error.contains("signal u is constant at 1"), "{error}");
        let twice = Data::new(vec![column("u", &u), column("v", &u)], column("y", &y)).unwrap();
        let error = Arx::fit(&twice, ORDERS).unwrap_err();
        assert!(matches!(error, ArxError::Regression { .. }), "{error}");
        let growing: Vec<f64> = (0..40).map(|k| 1.1_f64.powi(k) + 0.01 * u[k as usize]).collect();
        let exploding = Data::new(vec![column("u", &u)], column("y", &growing)).unwrap();
        let error = Arx::fit(&exploding, Orders { n_a: 1, n_b: 1, constant: false }).unwrap_err();
        assert_eq!(error, ArxError::Unstable { n_a: 1, n_b: 1 });
    }
}
