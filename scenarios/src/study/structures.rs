//! How large the process model should be: AIC over structures, and Theorem 1 on an example.

use drivescope_diagnoser::{
    ApproximationRow, Column, Data, DataError, Limits, Method, Structure, StructureRow, Training,
    approximation_table, select_structure,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::StudyError;
use super::design::{Designed, Signals};
use crate::results::{StructureSummary, TheoremRow, TheoremSummary};

/// Starts of every candidate, and their steps: the chosen one is trained again with more.
const STARTS: usize = 2;
const STEPS: usize = 60;

/// The AIC table.
pub(super) fn structures(
    designed: &Designed,
    seed: u64,
) -> Result<Vec<StructureSummary>, StudyError> {
    let [estimation, validation] = designed.excited.each_ref().map(Signals::data);
    let (estimation, validation) = (estimation?, validation?);
    let limits = Limits { steps: STEPS, relative_decrease: 1e-6 };
    let training = Training {
        method: Method::LevenbergMarquardt(limits),
        starts: STARTS,
        seed,
        ..Training::default()
    };
    let grid = Structure::grid(1, 1);
    let (rows, best) = select_structure(&grid, &estimation, &validation, &training)?;
    // Errors of the starts are in deviations of the output.
    let unit = designed.process.network.output_scales[0].deviation;
    let summary = |(k, row): (usize, StructureRow)| {
        let Structure { v1, v2, order, .. } = row.structure;
        StructureSummary {
            v1,
            v2,
            order,
            parameters: row.parameters,
            effective_parameters: row.effective_parameters,
            aic: row.trained.aic,
            validation: unit * row.trained.starts[row.trained.best].validation,
            paper: row.structure == Structure::PAPER,
            best: k == best,
        }
    };
    Ok(rows.into_iter().enumerate().map(summary).collect())
}

/// epsilon of the example, whose output spans about -1 to 1.
const EPSILON: f64 = 0.05;
/// I of the theorem.
const HORIZON: usize = 200;
/// (v1, v2, r): growing in v1 at first and at second order.
const SIZES: [(usize, usize, usize); 6] =
    [(1, 1, 1), (2, 1, 1), (5, 1, 1), (1, 1, 2), (2, 1, 2), (5, 1, 2)];
/// Inputs that the error is taken over.
const TESTS: u64 = 10;

fn data([u, z]: &[Vec<f64>; 2]) -> Result<Data<'_>, DataError> {
    Data::new(vec![Column { name: "u", values: u }], Column { name: "z", values: z })
}

/// Networks of growing size in place of z(k+1) = tanh(0.6 z(k) + 0.8 u(k)), u uniform in [-1, 1].
pub(super) fn theorem() -> Result<TheoremSummary, StudyError> {
    let system = |samples: usize, seed: u64| -> [Vec<f64>; 2] {
        let mut random = Pcg64::seed_from_u64(seed);
        let u: Vec<f64> = (0..samples).map(|_| random.random_range(-1.0..1.0)).collect();
        let mut z = vec![0.0; samples];
        for k in 1..samples {
            z[k] = (0.6 * z[k - 1] + 0.8 * u[k - 1]).tanh();
        }
        [u, z]
    };
    let (estimation, validation) = (system(2000, 1), system(1000, 2));
    let tests: Vec<_> = (0..TESTS).map(|k| system(HORIZON + 1, 3 + k)).collect();
    let tests = tests.iter().map(data).collect::<Result<Vec<_>, _>>()?;
    let sizes = SIZES.map(|(v1, v2, order)| Structure { v1, v2, order, ..Structure::PAPER });
    let method = Method::LevenbergMarquardt(Limits { steps: 150, relative_decrease: 1e-6 });
    let training = Training { method, starts: 6, seed: 1, run_up: 0 };
    let (estimation, validation) = (data(&estimation)?, data(&validation)?);
    let rows = approximation_table(&sizes, &estimation, &validation, &tests, HORIZON, &training)?;
    let row = |ApproximationRow { structure, max_error }| {
        let Structure { v1, v2, order, .. } = structure;
        TheoremRow { v1, v2, order, max_error }
    };
    Ok(TheoremSummary {
        epsilon: EPSILON,
        horizon: HORIZON,
        rows: rows.into_iter().map(row).collect(),
    })
}
