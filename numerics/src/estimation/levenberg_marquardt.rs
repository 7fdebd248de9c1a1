//! Nonlinear least squares, min |r(p)|^2, by Levenberg and Marquardt.
//!
//! (J^T J + lambda D) dp = -J^T r with D the largest diagonal of J^T J seen so far (More 1978,
//! so that units do not matter) and Nielsen's update of lambda (Madsen, Nielsen, Tingleff,
//! "Methods for Non-Linear Least Squares Problems", 2004, Section 3.2).
//!
//! The problem hands over J^T J and J^T r rather than J: a model that is simulated over
//! thousands of samples with dozens of parameters gathers them block by block in cache, and
//! never stores the tall Jacobian whose factorisation would cost most of the time. At the
//! minimum J^T r is exact, so that the answer does not suffer from the squared condition.

use nalgebra::{DMatrix, DVector, DVectorView};

/// First damping, relative to the scaled diagonal.
const FIRST_DAMPING: f64 = 1e-3;
/// Beyond this damping a step no longer changes the parameters.
const LARGEST_DAMPING: f64 = 1e20;
/// Smallest scale of a parameter that the residual does not feel, relative to the largest.
const SMALLEST_SCALE: f64 = 1e-14;

/// J^T J, J^T r and r^T r at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// r^T r.
    pub sse: f64,
    /// J^T r, one entry a parameter.
    pub gradient: DVector<f64>,
    /// J^T J.
    pub normal_matrix: DMatrix<f64>,
}

impl Linearisation {
    /// Without residuals yet.
    pub fn new(parameters: usize) -> Self {
        Self {
            sse: 0.0,
            gradient: DVector::zeros(parameters),
            normal_matrix: DMatrix::zeros(parameters, parameters),
        }
    }

    /// Adds residuals whose derivatives are the columns of `sensitivities` (parameters x residuals).
    pub fn add(&mut self, sensitivities: &DMatrix<f64>, residuals: &[f64]) {
        let r = DVectorView::from_slice(residuals, residuals.len());
        self.sse += r.norm_squared();
        self.gradient.gemv(1.0, sensitivities, &r, 1.0);
        // The product with the transpose made first: the fast path of the matrix product.
        self.normal_matrix.gemm(1.0, sensitivities, &sensitivities.transpose(), 1.0);
    }
}

/// A sum of squares to be made small.
pub trait Residuals {
    /// r^T r at `parameters`; may be infinite or NaN, the point is then rejected.
    fn sse(&self, parameters: &[f64]) -> f64;
    /// Residuals and exact derivatives, gathered.
    fn linearise(&self, parameters: &[f64]) -> Linearisation;
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most accepted and rejected steps together.
    pub steps: usize,
    /// Converged when a step is predicted to lower the sum of squares by less than this share.
    pub relative_decrease: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { steps: 200, relative_decrease: 1e-10 }
    }
}

/// Why the search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The next step would gain nothing.
    Converged,
    /// All allowed steps were used.
    StepLimit,
    /// No step, however short, lowered the sum of squares.
    NoDescent,
}

/// Where the search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Best parameters found.
    pub parameters: Vec<f64>,
    /// Their sum of squares.
    pub sse: f64,
    /// Steps tried.
    pub steps: usize,
    /// Why the search ended.
    pub stop: Stop,
}

/// Searches the minimum nearest to `start`. The sum of squares never rises; a start where it is
/// not finite is returned as it is, with [`Stop::NoDescent`].
pub fn minimise(problem: &impl Residuals, start: &[f64], limits: Limits) -> Minimum {
    let mut p = DVector::from_column_slice(start);
    let mut at = problem.linearise(start);
    let mut scale = at.normal_matrix.diagonal();
    let mut damping = FIRST_DAMPING;
    let mut growth = 2.0;
    let mut steps = 0;
    let stop = loop {
        if !at.sse.is_finite() || damping > LARGEST_DAMPING {
            break Stop::NoDescent;
        }
        if steps == limits.steps {
            break Stop::StepLimit;
        }
        scale.zip_apply(&at.normal_matrix.diagonal(), |s, h| *s = if h > *s { h } else { *s });
        let smallest = SMALLEST_SCALE * scale.max();
        if smallest == 0.0 {
            break Stop::Converged;
        }
        steps += 1;
        let mut damped = at.normal_matrix.clone();
        for k in 0..p.len() {
            damped[(k, k)] += damping * scale[k].max(smallest);
        }
        let Some(factor) = damped.cholesky() else {
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        let step = -factor.solve(&at.gradient);
        // Decrease of the quadratic model: -2 g.dp - dp.H.dp, positive by construction.
        let predicted = -2.0 * at.gradient.dot(&step) - step.dot(&(&at.normal_matrix * &step));
        if predicted <= limits.relative_decrease * at.sse {
            break Stop::Converged;
        }
        let trial = &p + &step;
        let gain = (at.sse - problem.sse(trial.as_slice())) / predicted;
        if gain > 0.0 {
            p = trial;
            at = problem.linearise(p.as_slice());
            damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            growth = 2.0;
        } else {
            damping *= growth;
            growth *= 2.0;
        }
    };
    Minimum { parameters: p.as_slice().to_vec(), sse: at.sse, steps, stop }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadratic convergence ends within a few roundings of the truth.
    const AT_THE_MINIMUM: f64 = 1e-7;

    /// Rosenbrock's valley as residuals 10 (y - x^2 s^2) and 1 - s x, x in units of 1/s.
    struct Valley {
        unit: f64,
    }

    impl Valley {
        fn residuals(&self, p: &[f64]) -> [f64; 2] {
            let x = p[0] * self.unit;
            [10.0 * (p[1] - x * x), 1.0 - x]
        }
    }

    impl Residuals for Valley {
        fn sse(&self, p: &[f64]) -> f64 {
            self.residuals(p).iter().map(|r| r * r).sum()
        }

        fn linearise(&self, p: &[f64]) -> Linearisation {
            let mut at = Linearisation::new(2);
            let x = p[0] * self.unit;
            let columns = DMatrix::from_columns(&[
                DVector::from_vec(vec![-20.0 * x * self.unit, 10.0]),
                DVector::from_vec(vec![-self.unit, 0.0]),
            ]);
            at.add(&columns, &self.residuals(p));
            at
        }
    }

    #[test]
    fn finds_the_end_of_the_valley() {
        let found = minimise(&Valley { unit: 1.0 }, &[-1.2, 1.0], Limits::default());
        assert!(found.stop == Stop::Converged || found.sse < 1e-20, "{found:?}");
        assert!((found.parameters[0] - 1.0).abs() < AT_THE_MINIMUM, "{found:?}");
        assert!((found.parameters[1] - 1.0).abs() < AT_THE_MINIMUM, "{found:?}");
    }

    #[test]
    fn units_do_not_change_the_path() {
        let plain = minimise(&Valley { unit: 1.0 }, &[-1.2, 1.0], Limits::default());
        let milli = minimise(&Valley { unit: 1024.0 }, &[-1.2 / 1024.0, 1.0], Limits::default());
        assert_eq!(plain.steps, milli.steps);
        let back = milli.parameters[0] * 1024.0;
        assert!((plain.parameters[0] - back).abs() < AT_THE_MINIMUM);
    }

    #[test]
    fn a_bad_start_or_a_flat_problem_ends_without_a_step() {
        let found = minimise(&Valley { unit: 1.0 }, &[f64::NAN, 1.0], Limits::default());
        assert_eq!((found.steps, found.stop), (0, Stop::NoDescent));
        let flat = minimise(&Valley { unit: 0.0 }, &[3.0, 0.0], Limits::default());
        assert_eq!(flat.stop, Stop::Converged);
        assert_eq!(flat.sse, 1.0);
    }

    #[test]
    fn the_step_limit_holds() {
        let limits = Limits { steps: 3, ..Limits::default() };
        let found = minimise(&Valley { unit: 1.0 }, &[-1.2, 1.0], limits);
        assert_eq!((found.steps, found.stop), (3, Stop::StepLimit));
        assert!(found.sse < Valley { unit: 1.0 }.sse(&[-1.2, 1.0]));
    }
}
