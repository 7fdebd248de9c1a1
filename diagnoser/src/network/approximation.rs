//! Theorem 1 on an example: the largest error over a horizon against v1 and v2.
//!
//! The theorem promises, for every epsilon and horizon I, sizes v1 and v2 of a network with
//! max_{0 <= k <= I} |z(k) - y(k)| < epsilon for every bounded input. Networks of growing size are
//! trained on one run of a system and shown other inputs; the largest error over all of them falls
//! with the size. Sizes include the order r: with first-order filters an example stays at 0.09
//! however many neurons it gets (sums of functions of one exponentially weighted past each), with
//! second order it falls on.

use super::{Structure, Training, TrainingError, train};
use crate::data::Data;
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
pub fn approximation_table(
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

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;
    use crate::data::Column;
    use crate::network::Method;
    use drivescope_numerics::Limits;

    /// epsilon; z spans about -1 to 1.
    const EPSILON: f64 = 0.05;

    /// z(k+1) = tanh(0.6 z(k) + 0.8 u(k)) from z(0) = 0, u uniform over [-1, 1].
    fn system(samples: usize, seed: u64) -> [Vec<f64>; 2] {
        let mut random = Pcg64::seed_from_u64(seed);
        let u: Vec<f64> = (0..samples).map(|_| random.random_range(-1.0..1.0)).collect();
        let mut z = vec![0.0; samples];
        for k in 1..samples {
            z[k] = (0.6 * z[k - 1] + 0.8 * u[k - 1]).tanh();
        }
        [u, z]
    }

    fn data([u, z]: &[Vec<f64>; 2]) -> Data<'_> {
        Data::new(vec![Column { name: "u", values: u }], Column { name: "z", values: z }).unwrap()
    }

    #[test]
    fn the_error_falls_below_epsilon_as_the_network_grows() {
        let (estimation, validation) = (system(2000, 1), system(1000, 2));
        let tests: Vec<_> = (3..13).map(|seed| system(201, seed)).collect();
        let tests: Vec<Data> = tests.iter().map(data).collect();
        let structures = [(1, 1), (2, 1), (5, 1)].map(|(v1, v2)| Structure {
            v1,
            v2,
            order: 2,
            ..Structure::PAPER
        });
        let method = Method::LevenbergMarquardt(Limits { steps: 150, relative_decrease: 1e-6 });
        let training = Training { method, starts: 6, seed: 1, run_up: 0 };
        let (estimation, validation) = (data(&estimation), data(&validation));
        let rows =
            approximation_table(&structures, &estimation, &validation, &tests, 200, &training)
                .unwrap();
        let errors: Vec<f64> = rows.iter().map(|row| row.max_error).collect();
        assert!(errors[2] < EPSILON && errors[2] < 0.5 * errors[0], "{errors:?}");
    }
}
