//! Output intervals (12), (16) and the adaptive threshold (19), sample by sample.
//!
//! ytilde^m + epsilon^m <= y <= ytilde^M + epsilon^M (19): for a detector, which compares the residual
//! r = y - y_m with a band, y_m is taken off both ends.

use std::sync::Arc;

use super::bounds::{BoundError, Corners, Regressor};
use super::robust::{NeuronBounds, RobustGmdh};
use super::run::{Flow, shift_in};
use super::{Gmdh, NeuronOrders, Source};
use crate::memory::{Memory, MemoryError, Walk};
use crate::threshold::{Band, Threshold};

/// The network in free run with the intervals of its uncertain neurons.
#[derive(Debug, Clone)]
pub(super) struct Intervals {
    flow: Flow,
    orders: NeuronOrders,
    corners: Vec<Option<Corners>>,
    /// Bounds of every neuron's regressor errors, one neuron after the other.
    errors: Vec<[f64; 2]>,
    /// Whether any source of a neuron is uncertain.
    uncertain: Vec<bool>,
    /// e^m, e^M of every neuron's output at this sample.
    output_errors: Vec<[f64; 2]>,
    output_interval: (f64, f64),
}

impl Intervals {
    /// Intervals of these neurons; the outputs of the others are taken as exact.
    pub(super) fn new(network: &Arc<Gmdh>, bounds: &[NeuronBounds]) -> Result<Self, BoundError> {
        let flow = Flow::new(network);
        let neurons = network.neurons.len();
        let orders = network.orders().ok_or(BoundError::Damaged)?;
        let mut corners = vec![None; neurons];
        for NeuronBounds { neuron, set, .. } in bounds {
            let place = corners.get_mut(*neuron).ok_or(BoundError::Damaged)?;
            *place = Some(set.corners()?);
        }
        let carries = |source: &Source| match source {
            Source::Neuron(n) => corners[*n].is_some(),
            Source::Input { .. } => false,
        };
        let uncertain =
            network.neurons.iter().map(|neuron| neuron.sources.iter().any(carries)).collect();
        Ok(Self {
            flow,
            orders,
            corners,
            errors: vec![[0.0; 2]; neurons * orders.parameters()],
            uncertain,
            output_errors: vec![[0.0; 2]; neurons],
            output_interval: (0.0, 0.0),
        })
    }

    fn reset(&mut self) {
        self.flow.reset();
        self.corners.iter_mut().flatten().for_each(Corners::reset);
        self.errors.fill([0.0; 2]);
        self.output_errors.fill([0.0; 2]);
    }

    /// The next sample.
    #[inline]
    pub(super) fn step(&mut self, u: &[f64]) {
        self.flow.step(u);
        for n in 0..self.corners.len() {
            if self.uncertain[n] {
                self.remember_errors(n);
            }
            if self.corners[n].is_none() {
                continue;
            }
            let (low, high) = self.interval(n);
            let s = self.flow.output(n);
            self.output_errors[n] = [s - high, s - low];
            self.output_interval = (low, high);
        }
    }

    fn remember_errors(&mut self, n: usize) {
        let errors = &mut self.errors[n * self.orders.parameters()..][..self.orders.parameters()];
        for (j, source) in self.flow.network().neurons[n].sources.iter().enumerate() {
            let fed = match source {
                Source::Neuron(n) => self.output_errors[*n],
                Source::Input { .. } => [0.0; 2],
            };
            shift_in(&mut errors[self.orders.taps(j)], fed);
        }
    }

    /// Interval of a neuron's output (12), (16); that of an exact one is a point.
    fn interval(&mut self, n: usize) -> (f64, f64) {
        let count = self.orders.parameters();
        let errors: &[[f64; 2]] =
            if self.uncertain[n] { &self.errors[n * count..][..count] } else { &[] };
        let regressor = Regressor { values: self.flow.regressor(n), errors };
        let activation = self.flow.activation(n);
        match &mut self.corners[n] {
            Some(corners) => {
                let (low, high) = corners.interval(regressor);
                (activation.value(low), activation.value(high))
            }
            None => (self.flow.output(n), self.flow.output(n)),
        }
    }

    /// r(k) of a neuron and the bounds of its errors; empty if it is exact.
    pub(super) fn regressor(&self, n: usize) -> Regressor<'_> {
        let count = self.orders.parameters();
        let errors: &[[f64; 2]] =
            if self.uncertain[n] { &self.errors[n * count..][..count] } else { &[] };
        Regressor { values: self.flow.regressor(n), errors }
    }

    /// Vertices of all sets.
    pub(super) fn vertices(&self) -> usize {
        self.corners.iter().flatten().map(Corners::count).sum()
    }
}

/// The adaptive threshold (19) as a running instance, written for the residual.
#[derive(Debug, Clone)]
pub struct GmdhBands {
    intervals: Intervals,
    /// epsilon^m, epsilon^M of the output, standardised.
    noise: [f64; 2],
    unit: f64,
}

impl RobustGmdh {
    /// The adaptive threshold at its start.
    pub fn bands(&self) -> Result<GmdhBands, BoundError> {
        let output = self.network.neurons.len().wrapping_sub(1);
        let last = self.bounds.iter().find(|bounds| bounds.neuron == output);
        Ok(GmdhBands {
            intervals: Intervals::new(&self.network, &self.bounds)?,
            noise: last.ok_or(BoundError::Damaged)?.noise,
            unit: self.network.output_scale.deviation,
        })
    }
}

impl GmdhBands {
    /// Vertices that the intervals are taken over, in all neurons together.
    pub fn vertices(&self) -> usize {
        self.intervals.vertices()
    }

    /// The regressor of the output neuron at the last sample, and what it is off by.
    pub fn regressor(&self) -> Regressor<'_> {
        self.intervals.regressor(self.intervals.corners.len() - 1)
    }

    /// ytilde^m and ytilde^M at the last sample, standardised as the output is.
    pub fn interval(&self) -> (f64, f64) {
        self.intervals.output_interval
    }
}

impl Threshold for GmdhBands {
    fn reset(&mut self) {
        self.intervals.reset();
    }

    fn settle(&mut self, u: &[f64]) {
        /// Eight times the longest memory that a synthesis allows a filter.
        const SETTLED: usize = 2000;
        self.reset();
        (0..SETTLED).for_each(|_| self.intervals.step(u));
    }

    #[inline]
    fn band(&mut self, u: &[f64]) -> Band {
        self.intervals.step(u);
        let (low, high) = self.intervals.output_interval;
        let modelled = self.intervals.flow.last();
        Band {
            lower: self.unit * (low + self.noise[0] - modelled),
            upper: self.unit * (high + self.noise[1] - modelled),
        }
    }
}

impl Memory for GmdhBands {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let Intervals { flow, corners, errors, output_errors, output_interval, .. } =
            &mut self.intervals;
        flow.walk(walk)?;
        walk.each(corners.iter_mut().flatten())?;
        walk.each(errors.iter_mut().chain(output_errors))?;
        output_interval.walk(walk)
    }
}
