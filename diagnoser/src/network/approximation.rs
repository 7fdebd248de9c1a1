//! Theorem 1 on an example: the largest error over a horizon against v1 and v2.
//!
//! The theorem promises, for every epsilon and horizon I, sizes v1 and v2 of a network with
//! max_{0 <= k <= I} |z(k) - y(k)| < epsilon for every bounded input. Networks of growing size are
//! trained on one run of a system and shown other inputs; the largest error over all of them falls
//! with the size. Sizes include the order r: with first-order filters an example stays at 0.09
//! however many neurons it gets (sums of functions of one exponentially weighted past each), with
//! second order it falls on.

use drivescope_numerics::Limits;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Method, Structure, Training, TrainingError, train};
use crate::data::{Column, Data, DataError};
use crate::signal_model::free_run;

/// One size of network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApproximationRow {
    /// Its sizes.
    pub structure: Structure,
    /// max |z(k) - y(k)| over the horizon and all test runs, in the unit of the outputs.
    pub max_error: f64,
}

/// Trains every structure on `estimation` data (the start best on `validation` is kept) and takes the
/// largest error over samples 0..=`horizon` of every test run.
fn approximation_table(
    structures: &[Structure],
    estimation: &Data,
    validation: &Data,
    tests: &[Data],
    horizon: usize,
    training: &Training,
) -> Result<Vec<ApproximationRow>, TrainingError> {
    let row = |structure: &Structure| {
        let network = train(*structure, estimation, validation, training)?.network;
        let max_error = tests.iter().map(|test| {
            let y = free_run(&mut network.run(), test.inputs());
            let square = |k: usize| -> f64 {
                let outputs = y.iter().zip(test.outputs());
                outputs.map(|(y, z)| (y[k] - z.values[k]).powi(2)).sum()
            };
            (0..test.len().min(horizon + 1)).map(square).fold(0.0, f64::max).sqrt()
        });
        Ok(ApproximationRow { structure: *structure, max_error: max_error.fold(0.0, f64::max) })
    };
    structures.iter().map(row).collect()
}

/// Theorem 1 on the example.
#[derive(Debug, Clone, PartialEq)]
pub struct ApproximationExample {
    /// epsilon, the error that is to be reached; the example's output spans about -1 to 1.
    pub epsilon: f64,
    /// I of the theorem, samples.
    pub horizon: usize,
    /// Networks, the larger the later: growing in v1 at first and at second order.
    pub rows: Vec<ApproximationRow>,
}

/// (v1, v2, r) of the example's networks.
const SIZES: [(usize, usize, usize); 6] =
    [(1, 1, 1), (2, 1, 1), (5, 1, 1), (1, 1, 2), (2, 1, 2), (5, 1, 2)];
/// Inputs that the example's error is taken over; none of the networks was trained on them.
const TESTS: u64 = 10;

impl ApproximationExample {
    /// Networks of growing size in place of the system z(k+1) = tanh(0.6 z(k) + 0.8 u(k)) from
    /// z(0) = 0, with u uniform over [-1, 1].
    ///
    /// # Errors
    /// None that the example's own data do not cause: those of a training.
    pub fn compute() -> Result<Self, TrainingError> {
        let (epsilon, horizon) = (0.05, 200);
        let (estimation, validation) = (system(2000, 1), system(1000, 2));
        let tests: Vec<_> = (0..TESTS).map(|k| system(horizon + 1, 3 + k)).collect();
        let data = |signals| {
            data(signals).map_err(|source| TrainingError::Data { set: "example", source })
        };
        let tests = tests.iter().map(data).collect::<Result<Vec<_>, _>>()?;
        let (estimation, validation) = (data(&estimation)?, data(&validation)?);
        let sizes = SIZES.map(|(v1, v2, order)| Structure { v1, v2, order, ..Structure::PAPER });
        let method = Method::LevenbergMarquardt(Limits { steps: 150, relative_decrease: 1e-6 });
        let training = Training { method, starts: 6, seed: 1, run_up: 0, ..Training::default() };
        let rows =
            approximation_table(&sizes, &estimation, &validation, &tests, horizon, &training)?;
        Ok(Self { epsilon, horizon, rows })
    }
}

/// u and z of the example.
fn system(samples: usize, seed: u64) -> [Vec<f64>; 2] {
    let mut random = Pcg64::seed_from_u64(seed);
    let u: Vec<f64> = (0..samples).map(|_| random.random_range(-1.0..1.0)).collect();
    let mut z = vec![0.0; samples];
    for k in 1..samples {
        z[k] = (0.6 * z[k - 1] + 0.8 * u[k - 1]).tanh();
    }
    [u, z]
}

fn data([u, z]: &[Vec<f64>; 2]) -> Result<Data<'_>, DataError> {
    Data::new(vec![Column { name: "u", values: u }], Column { name: "z", values: z })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_falls_below_epsilon_as_the_network_grows() {
        let ApproximationExample { epsilon, rows, .. } = ApproximationExample::compute().unwrap();
        let errors: Vec<f64> = rows.iter().map(|row| row.max_error).collect();
        // First order stays above epsilon whatever the size, second order falls below it.
        assert!(errors[..3].iter().all(|error| *error > epsilon), "{errors:?}");
        assert!(errors[5] < epsilon && errors[5] < 0.5 * errors[3], "{errors:?}");
    }
}
