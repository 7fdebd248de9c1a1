//! The two layers over standardised signals: (1a), (1b), (5), sample by sample and in blocks.

use drivescope_numerics::elementary::exp;

use super::theta::Layers;
use super::{Network, Structure};

/// The numbers of a network side by side, for standardised signals.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pub(super) structure: Structure,
    pub(super) w: Vec<f64>,
    pub(super) a: Vec<f64>,
    pub(super) b: Vec<f64>,
    pub(super) b_0: Vec<f64>,
    pub(super) g_1: Vec<f64>,
    pub(super) g_2: Vec<f64>,
    /// v2 rows of v1 + n: [W2 | Wu].
    pub(super) fir: Vec<f64>,
    pub(super) c: Vec<f64>,
}

impl Weights {
    pub(super) fn of_layers(layers: Layers) -> Self {
        let mut weights = Self::empty(layers.structure);
        for neuron in layers.neurons() {
            weights.push(neuron.w, &neuron.denominator(), neuron.b);
            weights.b_0.push(neuron.b_0);
            weights.g_1.push(neuron.g_1);
            weights.g_2.push(neuron.g_2);
        }
        weights.fir = layers.fir.to_vec();
        weights.c = layers.c.to_vec();
        weights
    }

    pub(super) fn of_network(network: &Network, structure: Structure) -> Self {
        let mut weights = Self::empty(structure);
        for neuron in &network.iir {
            weights.push(&neuron.w, &neuron.a, &neuron.b);
            weights.b_0.push(neuron.b_0);
            weights.g_1.push(neuron.g_1);
            weights.g_2.push(neuron.g_2);
        }
        weights.fir =
            network.fir.iter().flat_map(|row| row.w_2.iter().chain(&row.w_u)).copied().collect();
        weights.c = network.c.concat();
        weights
    }

    fn empty(structure: Structure) -> Self {
        let none = Vec::new;
        Self {
            structure,
            w: none(),
            a: none(),
            b: none(),
            b_0: none(),
            g_1: none(),
            g_2: none(),
            fir: none(),
            c: none(),
        }
    }

    fn push(&mut self, w: &[f64], a: &[f64], b: &[f64]) {
        self.w.extend_from_slice(w);
        self.a.extend_from_slice(a);
        self.b.extend_from_slice(b);
    }
}

/// State of a run over standardised signals.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// x1: per IIR neuron its filter's last r values, newest first.
    pub(super) x1: Vec<f64>,
    /// x2: per FIR neuron its last r values, newest first.
    pub(super) x2: Vec<f64>,
    /// y, standardised.
    pub(super) y: Vec<f64>,
}

impl State {
    pub(super) fn at_rest(structure: Structure) -> Self {
        let Structure { outputs, v1, v2, order, .. } = structure;
        Self { x1: vec![0.0; v1 * order], x2: vec![0.0; v2 * order], y: vec![0.0; outputs] }
    }

    /// (1a), and what the tanh of (1b) is taken of: W1 u goes to `drive`, B1 x1 + D1 u - g1 to
    /// `activation`.
    ///
    /// `inputs` and `order` are those of the structure: constants where the caller knows them, so
    /// that the short loops vanish. Slices are cut by index, for `chunks_exact` divides.
    #[inline(always)]
    fn filter(
        &mut self,
        (inputs, order): (usize, usize),
        weights: &Weights,
        u: &[f64],
        drive: &mut [f64],
        activation: &mut [f64],
    ) {
        for (i, (drive, activation)) in drive.iter_mut().zip(activation).enumerate() {
            let x = &mut self.x1[i * order..][..order];
            let own = i * order..(i + 1) * order;
            *drive = sum_of_products(&weights.w[i * inputs..][..inputs], u);
            let seen = weights.b_0[i] * *drive + sum_of_products(&weights.b[own.clone()], x);
            *activation = seen - weights.g_1[i];
            let next = *drive - sum_of_products(&weights.a[own], x);
            shift_in(x, next);
        }
    }

    /// y of this sample by (5), then the second layer by (1b).
    #[inline(always)]
    fn feed_of(
        &mut self,
        (inputs, order, v1): (usize, usize, usize),
        weights: &Weights,
        sigma: &[f64],
        u: &[f64],
    ) {
        let (sigma, u) = (&sigma[..v1], &u[..inputs]);
        let states = self.x2.len();
        for (o, y) in self.y.iter_mut().enumerate() {
            *y = sum_of_products(&weights.c[o * states..][..states], &self.x2);
        }
        for j in 0..weights.structure.v2 {
            let (w_2, w_u) = weights.fir[j * (v1 + inputs)..][..v1 + inputs].split_at(v1);
            let value = sum_of_products(w_2, sigma) + sum_of_products(w_u, u);
            shift_in(&mut self.x2[j * order..][..order], value);
        }
    }

    /// The same, with sizes that the compiler knows where they are common.
    #[inline]
    pub(super) fn feed(&mut self, weights: &Weights, sigma: &[f64], u: &[f64]) {
        let Structure { inputs, order, v1, .. } = weights.structure;
        match (inputs, order, v1) {
            (1, 1, 2) => self.feed_of((1, 1, 2), weights, sigma, u),
            (1, 1, 3) => self.feed_of((1, 1, 3), weights, sigma, u),
            (1, 1, 4) => self.feed_of((1, 1, 4), weights, sigma, u),
            sizes => self.feed_of(sizes, weights, sigma, u),
        }
    }
}

/// Samples whose first layer is computed at once.
pub(super) const SWEEP: usize = 64;

/// The first layer over up to [`SWEEP`] samples, stage by stage: nothing feeds back from tanh, so
/// that it can be taken of all samples in one vector loop. Each number is computed as in a stream.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    v1: usize,
    n_x1: usize,
    drive: Vec<f64>,
    activation: Vec<f64>,
    sigma: Vec<f64>,
    x1: Vec<f64>,
}

/// The first layer at one sample of a sweep.
#[derive(Clone, Copy)]
pub(super) struct FirstLayer<'a> {
    /// W1 u.
    pub(super) drive: &'a [f64],
    /// B1 x1 + D1 u - g1.
    pub(super) activation: &'a [f64],
    /// tanh(G2 activation).
    pub(super) sigma: &'a [f64],
    /// x1 at this sample.
    pub(super) x1: &'a [f64],
}

impl Sweep {
    pub(super) fn new(structure: Structure, samples: usize) -> Self {
        let (v1, n_x1) = (structure.v1, structure.v1 * structure.order);
        let per_neuron = || vec![0.0; samples * v1];
        Self {
            v1,
            n_x1,
            drive: per_neuron(),
            activation: per_neuron(),
            sigma: per_neuron(),
            x1: vec![0.0; samples * n_x1],
        }
    }

    /// Advances x1 over rows of standardised inputs, no more than there is room for.
    #[inline]
    pub(super) fn run(&mut self, state: &mut State, weights: &Weights, rows: &[f64]) {
        let Structure { inputs, order, v1, .. } = weights.structure;
        let samples = match (inputs, order, v1) {
            (1, 1, 2) => self.filter((1, 1, 2), state, weights, rows),
            (1, 1, 3) => self.filter((1, 1, 3), state, weights, rows),
            (1, 1, 4) => self.filter((1, 1, 4), state, weights, rows),
            sizes => self.filter(sizes, state, weights, rows),
        };
        for sigma in &mut self.sigma[..samples * self.v1] {
            *sigma = activation(*sigma);
        }
    }

    /// The filters and slopes; tanh is left to be taken. Returns the number of samples.
    #[inline(always)]
    fn filter(
        &mut self,
        (inputs, order, v1): (usize, usize, usize),
        state: &mut State,
        weights: &Weights,
        rows: &[f64],
    ) -> usize {
        let samples = rows.len() / inputs;
        for k in 0..samples {
            let neurons = k * v1..(k + 1) * v1;
            let drive = &mut self.drive[neurons.clone()];
            let activation = &mut self.activation[neurons.clone()];
            // A loop: for so few numbers a call of memmove costs more than the filter.
            let kept = &mut self.x1[k * v1 * order..][..v1 * order];
            kept.iter_mut().zip(&state.x1).for_each(|(kept, x)| *kept = *x);
            let u = &rows[k * inputs..][..inputs];
            state.filter((inputs, order), weights, u, drive, activation);
            let slopes = weights.g_2.iter().zip(activation);
            for (scaled, (g_2, activation)) in self.sigma[neurons].iter_mut().zip(slopes) {
                *scaled = g_2 * *activation;
            }
        }
        samples
    }

    #[inline]
    pub(super) fn at(&self, sample: usize) -> FirstLayer<'_> {
        let neurons = sample * self.v1..(sample + 1) * self.v1;
        FirstLayer {
            drive: &self.drive[neurons.clone()],
            activation: &self.activation[neurons.clone()],
            sigma: &self.sigma[neurons],
            x1: &self.x1[sample * self.n_x1..][..self.n_x1],
        }
    }
}

/// Simulates standardised inputs from rest and shows the outputs of every sample.
pub(super) fn simulate(weights: &Weights, inputs: &[f64], mut show: impl FnMut(&[f64])) {
    let structure = weights.structure;
    let mut state = State::at_rest(structure);
    let mut sweep = Sweep::new(structure, SWEEP);
    for rows in inputs.chunks(SWEEP * structure.inputs) {
        sweep.run(&mut state, weights, rows);
        for (k, u) in rows.chunks_exact(structure.inputs).enumerate() {
            state.feed(weights, sweep.at(k).sigma, u);
            show(&state.y);
        }
    }
}

/// tanh(q) = 1 - 2 / (e^2q + 1): absolute error below 2e-16 and a third cheaper than a tanh that
/// keeps its relative digits near zero, which a sum over neurons of order one does not feel.
#[inline(always)]
pub(crate) fn activation(q: f64) -> f64 {
    1.0 - 2.0 / (exp(2.0 * q) + 1.0)
}

#[inline]
pub(super) fn shift_in(delays: &mut [f64], newest: f64) {
    for l in (1..delays.len()).rev() {
        delays[l] = delays[l - 1];
    }
    delays[0] = newest;
}

#[inline]
pub(super) fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_activation_is_tanh_everywhere() {
        for q in (-4000..4000).map(|k| f64::from(k) * 0.013) {
            assert!((activation(q) - q.tanh()).abs() < 4e-16, "at {q}");
        }
        assert_eq!(activation(f64::INFINITY), 1.0);
        assert_eq!(activation(f64::NEG_INFINITY), -1.0);
        assert!(activation(f64::NAN).is_nan());
    }
}
