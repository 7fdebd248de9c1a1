//! What a neuron's parameters must fulfil: one double inequality a sample.
//!
//! lower(k) <= (r(k) - e(k))^T p <= upper(k) for some e(k) within its bounds, where lower and upper
//! are y - epsilon^M and y - epsilon^m through xi^-1: (8)-(10), (13)-(15), (17), (18). The bounds
//! (10) may differ from sample to sample: those of a recording are a multiple of the first's.

use microlp::Error;

use super::frame::Frame;
use super::lp::least_violation;
use super::polytope::{HalfSpace, product};
use super::regressor::BoundError;
use crate::gmdh::Activation;

/// A search for the smallest bound ends at this relative width.
const RESOLVED: f64 = 1e-9;

/// Equations of one neuron over recordings.
#[derive(Debug, Clone)]
pub(crate) struct Equations {
    pub(super) dimension: usize,
    pub(super) activation: Activation,
    regressors: Vec<f64>,
    /// e^m, e^M of every regressor; empty if all are exact.
    errors: Vec<[f64; 2]>,
    y: Vec<f64>,
    /// Recording and sample.
    places: Vec<(usize, usize)>,
    /// Noise bounds of every recording as a multiple of the first's.
    multiples: Vec<f64>,
}

/// One of them.
pub(super) struct Equation<'a> {
    pub(super) regressor: &'a [f64],
    /// Empty if exact.
    pub(super) errors: &'a [[f64; 2]],
    pub(super) y: f64,
    /// Its noise bounds as a multiple of the first recording's.
    pub(super) multiple: f64,
    pub(super) place: (usize, usize),
}

impl Equations {
    pub(crate) fn new(dimension: usize, activation: Activation) -> Self {
        let (regressors, errors, y, places) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { dimension, activation, regressors, errors, y, places, multiples: Vec::new() }
    }

    /// The equations of some recordings alone, their noise bounds all alike.
    pub(crate) fn of_recordings(&self, chosen: std::ops::Range<usize>) -> Self {
        let mut alone = Self::new(self.dimension, self.activation);
        for Equation { regressor, errors, y, place, .. } in self.iter() {
            if chosen.contains(&place.0) {
                alone.push(regressor, errors, y, place);
            }
        }
        alone
    }

    /// Gives the noise bounds of every recording as a multiple of the first's; without, all have
    /// the same.
    pub(crate) fn set_multiples(&mut self, multiples: Vec<f64>) {
        self.multiples = multiples;
    }

    fn multiple(&self, k: usize) -> f64 {
        self.multiples.get(self.places[k].0).copied().unwrap_or(1.0)
    }

    /// The smallest epsilon that leaves any parameters, whatever their signs.
    pub(crate) fn least_bound(&self) -> Result<f64, BoundError> {
        let frame = Frame::of(self).ok_or(BoundError::Unbounded)?;
        Ok(self.smallest_bound(&frame, &[])?)
    }

    /// Adds a sample; `errors` is empty if the regressor is exact, in all samples alike.
    pub(crate) fn push(
        &mut self,
        regressor: &[f64],
        errors: &[[f64; 2]],
        y: f64,
        place: (usize, usize),
    ) {
        self.regressors.extend_from_slice(regressor);
        self.errors.extend_from_slice(errors);
        self.y.push(y);
        self.places.push(place);
    }

    pub(super) fn len(&self) -> usize {
        self.y.len()
    }

    pub(super) fn regressors(&self) -> impl Iterator<Item = &[f64]> {
        self.regressors.chunks_exact(self.dimension)
    }

    /// xi^-1(y): what the filter should show.
    pub(super) fn middles(&self) -> impl Iterator<Item = f64> {
        self.y.iter().map(|y| self.activation.inverse(*y))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Equation<'_>> {
        let d = self.dimension;
        (0..self.len()).map(move |k| Equation {
            regressor: &self.regressors[k * d..][..d],
            errors: if self.errors.is_empty() { &[] } else { &self.errors[k * d..][..d] },
            y: self.y[k],
            multiple: self.multiple(k),
            place: self.places[k],
        })
    }

    /// Which regressors carry an error anywhere.
    pub(super) fn uncertain(&self) -> Vec<usize> {
        let carries =
            |i: &usize| self.errors.chunks_exact(self.dimension).any(|e| e[*i] != [0.0; 2]);
        (0..self.dimension).filter(carries).collect()
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
            let turned: Vec<f64> = r.iter().map(|r| -r).collect();
            let below = low.is_finite().then(|| shared(frame.half_space(&turned, -low)));
            above.into_iter().chain(below)
        };
        self.iter().flat_map(both).collect()
    }
}
