//! The locally recurrent cascade network (1), (5) of the paper, with its matrices written out:
//!
//! x1(k+1) = A1 x1(k) + W1 u(k),                                                     (1a)
//! x2(k+1) = A2 x2(k) + W2 tanh(G2 (B1 x1(k) + D1 u(k) - g1)) + Wu u(k),             (1b)
//! y(k)    = C x2(k).                                                                (5)
//!
//! Layer one: v1 neurons with IIR filters of order r, A1 their companion blocks, D1 = b_0 W1
//! (Patan 2008). Layer two: v2 neurons with FIR filters of order r that also see the input;
//! A2 shifts, and the taps of the filters are the entries of C. With C the identity over the
//! newest states this is (4).
//!
//! Readings: the "A1" of the second line of the paper's list is A2. For r = 1, A2 = 0, and v2
//! linear neurons under a linear output collapse to one row of v1 + n weights an output and
//! delay: the network is kept as written, and [`Structure::effective_parameters`] counts what
//! the data can tell apart, which is what AIC is charged for. Filters are stable for every value
//! of the trained parameters (see `theta`). Signals are standardised.

mod approximation;
mod ars;
mod free_run_error;
mod layers;
mod run;
mod select;
mod sensitivity;
mod theta;
mod train;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use self::approximation::{ApproximationExample, ApproximationRow};
pub(crate) use self::layers::activation;
pub use self::run::NetworkRun;
pub(crate) use self::select::select_structure;
pub use self::select::{Selection, StructureRow};
pub use self::theta::Theta;
pub(crate) use self::train::longest_memory;
pub use self::train::{Method, StartRow, Trained, Training, TrainingError, train};
use crate::scale::Scale;
use crate::stability::step_down;

/// Sizes of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// n, input signals.
    pub inputs: usize,
    /// m, output signals.
    pub outputs: usize,
    /// v1, neurons with IIR filters and tanh.
    pub v1: usize,
    /// v2, linear neurons with FIR filters.
    pub v2: usize,
    /// r, order of all filters.
    pub order: usize,
    /// Longest time constant of a filter, samples; nothing for any that is stable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<usize>,
}

impl Structure {
    /// The paper's network: one input, three IIR and six FIR neurons of first order, one output.
    pub const PAPER: Self = Self { inputs: 1, outputs: 1, v1: 3, v2: 6, order: 1, memory: None };

    /// Candidates for a choice by AIC: one to four IIR neurons, one or six FIR neurons, first and
    /// second order; for one input and one output the paper's is among them.
    pub fn grid(inputs: usize, outputs: usize) -> Vec<Self> {
        let sizes = (1..=4).flat_map(|v1| [1, 6].map(|v2| (v1, v2)));
        sizes
            .flat_map(|(v1, v2)| {
                [1, 2].map(|order| Self { inputs, outputs, v1, v2, order, ..Self::PAPER })
            })
            .collect()
    }

    /// Whether every size is at least one.
    pub fn is_valid(&self) -> bool {
        [self.inputs, self.outputs, self.v1, self.v2, self.order].iter().all(|size| *size > 0)
            && self.memory != Some(0)
    }

    /// Parameters as written: all entries of W1, A1, B1, D1, g1, G2, W2, Wu and C that are free.
    pub fn parameters(&self) -> usize {
        self.v1 * self.iir_parameters()
            + self.v2 * (self.v1 + self.inputs)
            + self.outputs * self.v2 * self.order
    }

    /// Parameters that the input-output behaviour depends on.
    ///
    /// An IIR neuron loses two scales (of W1 and of G2, both against B1 and D1). The linear part
    /// is a matrix of m r rows and v1 + n columns of rank q <= v2, with q (m r + v1 + n - q)
    /// degrees of freedom.
    pub fn effective_parameters(&self) -> usize {
        let (rows, columns) = (self.outputs * self.order, self.v1 + self.inputs);
        let rank = self.v2.min(rows).min(columns);
        self.v1 * (self.iir_parameters() - 2) + rank * (rows + columns - rank)
    }

    /// The smallest structure that can do all that this one can: linear neurons beyond the rank of
    /// what they pass on add nothing.
    pub fn class(&self) -> Self {
        let (rows, columns) = (self.outputs * self.order, self.v1 + self.inputs);
        Self { v2: self.v2.min(rows).min(columns), ..*self }
    }

    /// w (n), theta (r), b (r), b_0, g_1, g_2.
    fn iir_parameters(&self) -> usize {
        self.inputs + 2 * self.order + 3
    }
}

/// A neuron of the first layer: tanh(g_2 (b . x + b_0 w . u - g_1)), x its filter's state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IirNeuron {
    /// Row of W1: one weight an input.
    pub w: Vec<f64>,
    /// Denominator a_1 .. a_r of the filter, first row of its block of A1 with the sign changed.
    pub a: Vec<f64>,
    /// Block of B1: one weight a state.
    pub b: Vec<f64>,
    /// D1 = b_0 w.
    pub b_0: f64,
    /// Bias.
    pub g_1: f64,
    /// Slope.
    pub g_2: f64,
}

/// A neuron of the second layer: a delay line fed by w_2 . sigma + w_u . u.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FirNeuron {
    /// Row of W2: one weight a neuron of the first layer.
    pub w_2: Vec<f64>,
    /// Row of Wu: one weight an input.
    pub w_u: Vec<f64>,
}

/// A trained network, in the form it is stored in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Network {
    /// How each input is standardised.
    pub input_scales: Vec<Scale>,
    /// How each output is restored.
    pub output_scales: Vec<Scale>,
    /// First layer.
    pub iir: Vec<IirNeuron>,
    /// Second layer.
    pub fir: Vec<FirNeuron>,
    /// C: one row an output, over neuron 1's delays 1..r, neuron 2's delays, and so on.
    pub c: Vec<Vec<f64>>,
}

impl Network {
    /// Sizes, or `None` if the parts do not fit together.
    pub fn structure(&self) -> Option<Structure> {
        let structure = Structure {
            inputs: self.input_scales.len(),
            outputs: self.output_scales.len(),
            v1: self.iir.len(),
            v2: self.fir.len(),
            order: self.iir.first()?.a.len(),
            ..Structure::PAPER
        };
        let Structure { inputs, outputs, v1, v2, order, .. } = structure;
        let fits = structure.is_valid()
            && self.iir.iter().all(|neuron| {
                neuron.w.len() == inputs && neuron.a.len() == order && neuron.b.len() == order
            })
            && self.fir.iter().all(|neuron| neuron.w_2.len() == v1 && neuron.w_u.len() == inputs)
            && self.c.len() == outputs
            && self.c.iter().all(|row| row.len() == v2 * order);
        fits.then_some(structure)
    }

    /// Whether a free run stays bounded: every filter stable, every number finite.
    pub fn is_stable(&self) -> bool {
        let iir = self.iir.iter().all(|neuron| {
            let numbers = neuron.w.iter().chain(&neuron.b);
            let numbers = numbers.chain([&neuron.b_0, &neuron.g_1, &neuron.g_2]);
            step_down(&neuron.a).is_some() && numbers.into_iter().all(|x| x.is_finite())
        });
        let fir = self.fir.iter().flat_map(|neuron| neuron.w_2.iter().chain(&neuron.w_u));
        let linear = fir.chain(self.c.iter().flatten()).all(|x| x.is_finite());
        let mut scales = self.input_scales.iter().chain(&self.output_scales);
        iir && linear && scales.all(Scale::is_usable)
    }

    /// A free run from rest.
    ///
    /// # Panics
    /// If the parts do not fit together ([`Network::structure`] is `None`).
    pub fn run(self: &Arc<Self>) -> NetworkRun {
        NetworkRun::new(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_counted() {
        // Paper: 3 x (w, a, b, b_0, g_1, g_2), 6 x (3 + 1), 6.
        assert_eq!(Structure::PAPER.parameters(), 18 + 24 + 6);
        // 3 x (pole, zero, gain, bias) and one row of 3 + 1.
        assert_eq!(Structure::PAPER.effective_parameters(), 12 + 4);
        // v2 = 1 already holds all that v2 = 6 can do at first order.
        assert!(Structure::grid(1, 1).contains(&Structure::PAPER));
        let narrow = Structure { v2: 1, ..Structure::PAPER };
        assert_eq!(narrow.effective_parameters(), Structure::PAPER.effective_parameters());
        assert_eq!(Structure::PAPER.class(), narrow);
        let second = Structure { order: 2, ..Structure::PAPER };
        assert_eq!(second.class(), Structure { v2: 2, ..second });
        assert_eq!(second.class().effective_parameters(), second.effective_parameters());
    }
}
