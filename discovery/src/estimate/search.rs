//! Levenberg and Marquardt within bounds.
//!
//! As [`drivescope_numerics::minimise`], but every coordinate stays in its interval: one that
//! lies on a bound and is pushed outwards is left out of the step (an active set), and a step
//! that would leave goes to the bound, for which the others are solved again. No coordinate moves
//! by more than its longest step at once.

use drivescope_numerics::{Limits, Linearisation, Residuals, Stop};
use nalgebra::{DMatrix, DVector};

use super::scale::Reach;

/// First damping, relative to the scaled diagonal.
const FIRST_DAMPING: f64 = 1e-3;
/// Factor on the damping where a step is refused; it doubles with every further one.
const FIRST_GROWTH: f64 = 2.0;
/// Beyond this damping a step no longer changes the parameters.
const LARGEST_DAMPING: f64 = 1e16;
/// Smallest scale of a coordinate that the residual does not feel, relative to the largest.
const SMALLEST_SCALE: f64 = 1e-12;

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// Best coordinates.
    pub(crate) coordinates: Vec<f64>,
    /// Sum of squares, gradient and curvature there.
    pub(crate) at: Linearisation,
    /// Why the search ended.
    pub(crate) stop: Stop,
}

/// Searches the minimum nearest to `start`, which lies within the bounds. The sum of squares never
/// rises; a start where it is not finite is returned as it is, with [`Stop::NoDescent`]. `seen` is
/// told the sum after every step; where it answers true the search ends with [`Stop::StepLimit`].
pub(crate) fn minimise_within(
    problem: &impl Residuals,
    start: &[f64],
    reaches: &[Reach],
    limits: Limits,
    seen: &dyn Fn(f64) -> bool,
) -> Found {
    let mut p = start.to_vec();
    let mut at = problem.linearise(&p);
    let mut scale = vec![0.0_f64; p.len()];
    let (mut damping, mut growth, mut steps) = (FIRST_DAMPING, FIRST_GROWTH, 0);
    let stop = loop {
        if !at.sse.is_finite() || damping > LARGEST_DAMPING {
            break Stop::NoDescent;
        }
        for (k, scale) in scale.iter_mut().enumerate() {
            *scale = scale.max(at.normal_matrix[(k, k)]);
        }
        let free = free(&p, &at, reaches);
        if free.is_empty() {
            break Stop::Converged;
        }
        if seen(at.sse) || steps == limits.steps {
            break Stop::StepLimit;
        }
        steps += 1;
        let Some(trial) = step(&p, &at, &free, &scale, damping, reaches) else {
            (damping, growth) = (damping * growth, 2.0 * growth);
            continue;
        };
        let predicted = decrease(&p, &trial, &at);
        if predicted <= limits.relative_decrease * at.sse {
            break Stop::Converged;
        }
        // Most steps are taken, and the duals know the sum of squares too; but where one was
        // refused, as beside a kink, the next may be.
        let may_be_refused = growth > FIRST_GROWTH;
        let next = (!may_be_refused || problem.sse(&trial) < at.sse)
            .then(|| problem.linearise(&trial))
            .filter(|next| next.sse < at.sse);
        if let Some(next) = next {
            let gain = (at.sse - next.sse) / predicted;
            (p, at) = (trial, next);
            damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            growth = FIRST_GROWTH;
        } else {
            (damping, growth) = (damping * growth, 2.0 * growth);
        }
    };
    Found { coordinates: p, at, stop }
}

/// Coordinates that are not held at a bound by the slope.
fn free(p: &[f64], at: &Linearisation, reaches: &[Reach]) -> Vec<usize> {
    let held = |k: usize| {
        let Reach { low, high, .. } = reaches[k];
        (p[k] <= low && at.gradient[k] > 0.0) || (p[k] >= high && at.gradient[k] < 0.0)
    };
    (0..p.len()).filter(|k| !held(*k)).collect()
}

/// The point after a damped step of the free coordinates; nothing if the system has no solution.
/// A coordinate that would leave its interval goes to the bound, and the rest is solved again for
/// that.
fn step(
    p: &[f64],
    at: &Linearisation,
    free: &[usize],
    scale: &[f64],
    damping: f64,
    reaches: &[Reach],
) -> Option<Vec<f64>> {
    let smallest = SMALLEST_SCALE * scale.iter().fold(0.0, |most: f64, s| most.max(*s));
    let mut free = free.to_vec();
    let mut trial = p.to_vec();
    loop {
        let damped = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            let (j, k) = (free[a], free[b]);
            let diagonal = if j == k { damping * scale[k].max(smallest) } else { 0.0 };
            at.normal_matrix[(j, k)] + diagonal
        });
        let moved =
            DVector::from_fn(p.len(), |k, _| if free.contains(&k) { 0.0 } else { trial[k] - p[k] });
        let gradient = (&at.gradient + &at.normal_matrix * moved).select_rows(&free);
        let solved = damped.cholesky()?.solve(&gradient);
        let (mut remainder, mut outside) = (Vec::new(), false);
        for (a, &k) in free.iter().enumerate() {
            let Reach { low, high, longest } = reaches[k];
            let wanted = p[k] - solved[a].clamp(-longest, longest);
            trial[k] = wanted.clamp(low, high);
            if trial[k] == wanted {
                remainder.push(k);
            } else {
                outside = true;
            }
        }
        if !outside || remainder.is_empty() {
            return trial.iter().all(|value| value.is_finite()).then_some(trial);
        }
        free = remainder;
    }
}

/// Decrease that the quadratic model predicts, -2 g.d - d.H.d.
fn decrease(from: &[f64], to: &[f64], at: &Linearisation) -> f64 {
    let d = DVector::from_iterator(from.len(), to.iter().zip(from).map(|(a, b)| a - b));
    -2.0 * at.gradient.dot(&d) - d.dot(&(&at.normal_matrix * &d))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadratic convergence ends within a few roundings of the truth.
    const AT_THE_MINIMUM: f64 = 1e-6;
    const LIMITS: Limits = Limits { steps: 200, relative_decrease: 1e-14 };

    /// Rosenbrock's valley: residuals 10 (y - x^2) and 1 - x; and a third that keeps it from zero.
    struct Valley;

    impl Valley {
        fn residuals(p: &[f64]) -> [f64; 3] {
            [10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0], 0.1]
        }
    }

    impl Residuals for Valley {
        fn sse(&self, p: &[f64]) -> f64 {
            Self::residuals(p).iter().map(|r| r * r).sum()
        }

        fn linearise(&self, p: &[f64]) -> Linearisation {
            let mut at = Linearisation::new(2);
            let columns = [-20.0 * p[0], 10.0, -1.0, 0.0, 0.0, 0.0];
            at.add(&DMatrix::from_column_slice(2, 3, &columns), &Self::residuals(p));
            at
        }
    }

    fn found(start: [f64; 2], bounds: [(f64, f64); 2]) -> Vec<f64> {
        let reach = |(low, high)| Reach { low, high, longest: 2.0 };
        let minimum = minimise_within(&Valley, &start, &bounds.map(reach), LIMITS, &|_| false);
        assert_eq!(minimum.stop, Stop::Converged, "{minimum:?}");
        minimum.coordinates
    }

    #[test]
    fn a_minimum_inside_is_found() {
        let everywhere = (f64::NEG_INFINITY, f64::INFINITY);
        for p in [found([-1.2, 1.0], [everywhere; 2]), found([0.0, 0.0], [(0.0, 3.0); 2])] {
            assert!(p.iter().all(|x| (x - 1.0).abs() < AT_THE_MINIMUM), "{p:?}");
        }
    }

    #[test]
    fn a_minimum_beyond_a_bound_is_found_on_it() {
        // y <= 0.25: the residuals 10 (0.25 - x^2) and 1 - x are least where x solves
        // -400 x (0.25 - x^2) - 2 (1 - x) = 0, near 0.5.
        let p = found([0.1, 0.1], [(0.0, 3.0), (0.0, 0.25)]);
        assert_eq!(p[1], 0.25);
        let slope = -400.0 * p[0] * (0.25 - p[0] * p[0]) - 2.0 * (1.0 - p[0]);
        assert!((p[0] - 0.5).abs() < 0.01 && slope.abs() < 1e-3, "{p:?}: {slope}");
        assert_eq!(found([2.0, 2.5], [(1.5, 3.0), (2.25, 2.5)]), [1.5, 2.25]);
    }

    /// Nothing to descend on.
    struct Overflow;

    impl Residuals for Overflow {
        fn sse(&self, _: &[f64]) -> f64 {
            f64::INFINITY
        }

        fn linearise(&self, p: &[f64]) -> Linearisation {
            Linearisation { sse: f64::INFINITY, ..Linearisation::new(p.len()) }
        }
    }

    #[test]
    fn an_overflow_at_the_start_is_said() {
        let minimum = minimise_within(
            &Overflow,
            &[1.0],
            &[Reach { low: 0.0, high: 2.0, longest: 1.0 }],
            LIMITS,
            &|_| false,
        );
        assert_eq!((minimum.stop, minimum.coordinates), (Stop::NoDescent, vec![1.0]));
    }
}
