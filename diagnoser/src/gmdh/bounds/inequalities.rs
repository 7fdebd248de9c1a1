//! The inequalities of a neuron in its frame, and the smallest noise bound that they leave room for.

use microlp::Error;

use super::equations::{Equation, Equations};
use super::frame::Frame;
use super::lp::least_violation;
use super::polytope::{HalfSpace, product};
use super::regressor::BoundError;
use crate::gmdh::Activation;

/// A search for the smallest bound ends at this relative width.
const RESOLVED: f64 = 1e-9;

impl Equations {
    /// The smallest epsilon that leaves any parameters, whatever their signs.
    pub(crate) fn least_bound(&self) -> Result<f64, BoundError> {
        let frame = Frame::of(self).ok_or(BoundError::Unbounded)?;
        Ok(self.smallest_bound(&frame, &[])?)
    }

    /// Smallest epsilon for which some p with these signs of the uncertain parameters has
    /// |y - xi(r^T p)| <= epsilon everywhere, errors in the regressors aside: the Chebyshev
    /// minimum. For the identity one linear program; else, since the set only grows with epsilon,
    /// by bisection over programs.
    pub(super) fn smallest_bound(&self, frame: &Frame, hard: &[HalfSpace]) -> Result<f64, Error> {
        if self.activation == Activation::Identity {
            let (_, least) = least_violation(&self.rows(frame, 0.0), hard, self.dimension)?;
            return Ok(least * frame.sigma);
        }
        // What the least-squares estimate errs by is enough, but for the signs.
        let errs = self.iter().map(|Equation { regressor, y, multiple, .. }| {
            let q = product(regressor, frame.centre.as_slice());
            (y - self.activation.value(q)).abs() / multiple
        });
        let feasible = |epsilon: f64| -> Result<bool, Error> {
            let (_, least) = least_violation(&self.rows(frame, epsilon), hard, self.dimension)?;
            Ok(least <= 0.0)
        };
        let (mut low, mut high) = (0.0, errs.fold(0.0, f64::max));
        while !feasible(high)? {
            (low, high) = (high, 2.0 * high);
        }
        while high - low > RESOLVED * high {
            let middle = 0.5 * (low + high);
            if feasible(middle)? { high = middle } else { low = middle }
        }
        Ok(high)
    }

    /// Farthest that a feasible z can lie from the centre: |z|^2 is the mean square of
    /// (r^T p - r^T centre) / sigma, and the inequalities bound that at every sample.
    pub(super) fn reach(&self, frame: &Frame, noise: [f64; 2]) -> f64 {
        let farthest = |Equation { regressor, y, multiple, .. }: Equation| {
            let q = product(regressor, frame.centre.as_slice());
            let end = |epsilon| (self.activation.inverse(y - multiple * epsilon) - q).abs();
            end(noise[0]).max(end(noise[1])) / frame.sigma
        };
        self.iter().map(farthest).fold(0.0, f64::max)
    }

    /// Both inequalities of every sample, in the frame, errors in the regressors aside; divided by
    /// the multiples of the noise bounds, so that one violation counts alike in all.
    fn rows(&self, frame: &Frame, epsilon: f64) -> Vec<HalfSpace> {
        let both = |Equation { regressor: r, y, multiple, .. }: Equation| {
            let ends = [y - multiple * epsilon, y + multiple * epsilon];
            let [low, high] = ends.map(|y| self.activation.inverse(y));
            let shared = |HalfSpace { normal, offset }: HalfSpace| HalfSpace {
                normal: normal.iter().map(|n| n / multiple).collect(),
                offset: offset / multiple,
            };
            let above = high.is_finite().then(|| shared(frame.half_space(r, high)));
            let negated: Vec<f64> = r.iter().map(|r| -r).collect();
            let below = low.is_finite().then(|| shared(frame.half_space(&negated, -low)));
            above.into_iter().chain(below)
        };
        self.iter().flat_map(both).collect()
    }
}
