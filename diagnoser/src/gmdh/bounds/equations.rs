//! What a neuron's parameters must fulfil: one double inequality a sample.
//!
//! lower(k) <= (r(k) - e(k))^T p <= upper(k) for some e(k) within its bounds, where lower and upper
//! are y - epsilon^M and y - epsilon^m through xi^-1: (8)-(10), (13)-(15), (17), (18). The bounds
//! (10) may differ from sample to sample: those of a recording are a multiple of the first's.

use crate::gmdh::Activation;

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
}
