//! Trained parameters: a vector of free numbers, every value of which is a stable network.
//!
//! Order: for each IIR neuron w (n), theta (r), b (r), b_0, g_1, g_2; for each FIR neuron w_2 (v1)
//! and w_u (n); then C row by row. A filter's denominator is the step-up image of the reflection
//! coefficients k = K tanh(theta): a = tanh(theta) for r = 1, the stability triangle for r = 2. Where
//! the structure names a memory of M samples all roots are drawn in by rho = 1 - 1/M, a_i rho^i for a_i.
//! (K holds no filter of second order: k = (-0.9999, -0.9999) is an integrator but for 5e-9.)

use drivescope_numerics::elementary::tanh;

use super::{FirNeuron, IirNeuron, Network, Structure};
use crate::scale::Scale;
use crate::stability::{step_down, step_up, step_up_with_derivatives};

/// K: tanh alone rounds to 1 from theta = 19 on, and closer to the circle the denominator's own rounding
/// could carry a third-order filter out. A filter of first order remembers at most ten thousand samples.
const LARGEST_REFLECTION: f64 = 1.0 - 1e-4;

/// A network as a vector of free parameters, for standardised signals.
#[derive(Debug, Clone, PartialEq)]
pub struct Theta {
    /// Its sizes.
    pub structure: Structure,
    /// [`Structure::parameters`] values.
    pub values: Vec<f64>,
}

/// The slices of one IIR neuron.
pub(super) struct IirSlices<'a> {
    pub(super) w: &'a [f64],
    pub(super) theta: &'a [f64],
    pub(super) b: &'a [f64],
    /// rho: the greatest magnitude of a root.
    pub(super) radius: f64,
    pub(super) b_0: f64,
    pub(super) g_1: f64,
    pub(super) g_2: f64,
}

/// Views of a parameter vector by the layers it holds.
#[derive(Clone, Copy)]
pub(super) struct Layers<'a> {
    pub(super) structure: Structure,
    iir: &'a [f64],
    /// v2 rows of v1 + n: [W2 | Wu].
    pub(super) fir: &'a [f64],
    /// m rows of v2 r.
    pub(super) c: &'a [f64],
}

impl<'a> Layers<'a> {
    pub(super) fn of(structure: Structure, values: &'a [f64]) -> Self {
        let (iir, rest) = values.split_at(structure.v1 * structure.iir_parameters());
        let (fir, c) = rest.split_at(structure.v2 * (structure.v1 + structure.inputs));
        Self { structure, iir, fir, c }
    }

    pub(super) fn neurons(&self) -> impl Iterator<Item = IirSlices<'a>> + use<'a> {
        let Structure { inputs, order, memory, .. } = self.structure;
        let radius = memory.map_or(1.0, |samples| 1.0 - 1.0 / samples as f64);
        self.iir.chunks_exact(self.structure.iir_parameters()).map(move |values| {
            let (w, rest) = values.split_at(inputs);
            let (theta, rest) = rest.split_at(order);
            let (b, last) = rest.split_at(order);
            IirSlices { w, theta, b, radius, b_0: last[0], g_1: last[1], g_2: last[2] }
        })
    }
}

impl IirSlices<'_> {
    /// rho, rho^2, ...
    fn powers(&self) -> impl Iterator<Item = f64> {
        std::iter::successors(Some(self.radius), |power| Some(power * self.radius))
    }

    fn reflection(&self) -> Vec<f64> {
        self.theta.iter().map(|theta| LARGEST_REFLECTION * tanh(*theta)).collect()
    }

    /// a_1 .. a_r.
    pub(super) fn denominator(&self) -> Vec<f64> {
        let drawn_in = step_up(&self.reflection()).into_iter().zip(self.powers());
        drawn_in.map(|(a, power)| power * a).collect()
    }

    /// da_i / dtheta_j as rows i.
    pub(super) fn denominator_derivatives(&self) -> Vec<Vec<f64>> {
        let slope = |theta: &f64| LARGEST_REFLECTION * (1.0 - tanh(*theta) * tanh(*theta));
        let slopes: Vec<f64> = self.theta.iter().map(slope).collect();
        let (_, rows) = step_up_with_derivatives(&self.reflection());
        let of_row = |(row, power): (Vec<f64>, f64)| {
            row.iter().zip(&slopes).map(|(d, slope)| d * slope * power).collect()
        };
        rows.into_iter().zip(self.powers()).map(of_row).collect()
    }
}

impl Theta {
    /// The stored form, with the scales that the signals were standardised by.
    pub(crate) fn network(&self, input_scales: Vec<Scale>, output_scales: Vec<Scale>) -> Network {
        let layers = Layers::of(self.structure, &self.values);
        let iir = layers.neurons().map(|neuron| IirNeuron {
            w: neuron.w.to_vec(),
            a: neuron.denominator(),
            b: neuron.b.to_vec(),
            b_0: neuron.b_0,
            g_1: neuron.g_1,
            g_2: neuron.g_2,
        });
        let fir = layers.fir.chunks_exact(self.structure.v1 + self.structure.inputs).map(|row| {
            let (w_2, w_u) = row.split_at(self.structure.v1);
            FirNeuron { w_2: w_2.to_vec(), w_u: w_u.to_vec() }
        });
        let c = layers.c.chunks_exact(self.structure.v2 * self.structure.order);
        Network {
            input_scales,
            output_scales,
            iir: iir.collect(),
            fir: fir.collect(),
            c: c.map(<[f64]>::to_vec).collect(),
        }
    }

    /// A random start: filters with real poles of one to a hundred samples, drawn in as all are, unit
    /// gains.
    pub(crate) fn draw(structure: Structure, mut normal: impl FnMut() -> f64) -> Self {
        let Structure { inputs, outputs, v1, v2, order, .. } = structure;
        let mut values = Vec::with_capacity(structure.parameters());
        for _ in 0..v1 {
            values.extend((0..inputs).map(|_| normal()));
            // Time constants log-normal around ten samples: 1 to 100 at two deviations.
            let poles: Vec<f64> =
                (0..order).map(|_| (-1.0 / (10.0 * (1.15 * normal()).exp())).exp()).collect();
            let gain: f64 = poles.iter().map(|pole| 1.0 - pole).product();
            let reflection = step_down(&monic(&poles)).unwrap_or_else(|| vec![0.0; order]);
            values.extend(reflection.iter().map(|k| k.atanh()));
            values.extend((0..order).map(|_| gain * normal()));
            values.extend([0.1 * normal(), 0.5 * normal(), 1.0]);
        }
        let columns = v1 + inputs;
        let spread = 1.0 / (columns as f64).sqrt();
        values.extend((0..v2 * columns).map(|_| spread * normal()));
        let spread = 1.0 / ((v2 * order) as f64).sqrt();
        values.extend((0..outputs * v2 * order).map(|_| spread * normal()));
        Self { structure, values }
    }
}

impl Structure {
    /// Whether a network of these sizes can do all that one of the other sizes can.
    pub(super) fn contains(&self, other: &Self) -> bool {
        let own = (self.inputs, self.outputs, self.memory);
        own == (other.inputs, other.outputs, other.memory)
            && self.v1 >= other.v1
            && self.v2 >= other.v2
            && self.order >= other.order
    }
}

impl Theta {
    /// A network of larger sizes that does what this one does: what is new is drawn, and does not
    /// reach the output. Longer filters have their new coefficients at zero, new neurons their
    /// weights in the next layer.
    ///
    /// # Panics
    /// If `into` does not contain these sizes.
    pub(super) fn embedded(&self, into: Structure, normal: impl FnMut() -> f64) -> Self {
        assert!(into.contains(&self.structure), "a network fits into none that is smaller");
        let (from, mut larger) = (self.structure, Self::draw(into, normal));
        let old = Layers::of(from, &self.values);
        let (iir, rest) = larger.values.split_at_mut(into.v1 * into.iir_parameters());
        let (fir, c) = rest.split_at_mut(into.v2 * (into.v1 + into.inputs));
        for (new, old) in iir.chunks_exact_mut(into.iir_parameters()).zip(old.neurons()) {
            let zeros = vec![0.0; into.order - from.order];
            let filter = [old.w, old.theta, &zeros, old.b, &zeros].concat();
            new[..filter.len()].copy_from_slice(&filter);
            new[filter.len()..].copy_from_slice(&[old.b_0, old.g_1, old.g_2]);
        }
        let old_rows = old.fir.chunks_exact(from.v1 + from.inputs);
        for (new, old) in fir.chunks_exact_mut(into.v1 + into.inputs).zip(old_rows) {
            let (w_2, w_u) = old.split_at(from.v1);
            new[..into.v1].fill(0.0);
            new[..from.v1].copy_from_slice(w_2);
            new[into.v1..].copy_from_slice(w_u);
        }
        let old_rows = old.c.chunks_exact(from.v2 * from.order);
        for (new, old) in c.chunks_exact_mut(into.v2 * into.order).zip(old_rows) {
            new.fill(0.0);
            let taps = new.chunks_exact_mut(into.order).zip(old.chunks_exact(from.order));
            taps.for_each(|(new, old)| new[..from.order].copy_from_slice(old));
        }
        larger
    }
}

/// Coefficients a_1..a_r of the polynomial with these roots.
fn monic(roots: &[f64]) -> Vec<f64> {
    let mut a = vec![1.0];
    for root in roots {
        a.push(0.0);
        for i in (1..a.len()).rev() {
            a[i] -= root * a[i - 1];
        }
    }
    a.split_off(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::{largest_root, time_constant};
    use crate::testing::noise;

    #[test]
    fn every_parameter_vector_is_a_stable_network() {
        for order in [1, 2, 3] {
            let structure = Structure { order, ..Structure::PAPER };
            for (seed, size) in [(1, 1.0), (2, 30.0), (3, 1e3)] {
                let values = noise(structure.parameters(), seed).iter().map(|e| size * e).collect();
                let scale = Scale { mean: 0.0, deviation: 1.0 };
                let network = Theta { structure, values }.network(vec![scale], vec![scale]);
                assert_eq!(network.structure(), Some(structure));
                assert!(network.is_stable(), "order {order}, size {size}");
            }
            // Of whatever order, no filter remembers for longer than it may.
            let structure = Structure { memory: Some(200), ..structure };
            let values = noise(structure.parameters(), 4).iter().map(|e| 1e3 * e).collect();
            let scale = Scale { mean: 0.0, deviation: 1.0 };
            let network = Theta { structure, values }.network(vec![scale], vec![scale]);
            let slowest = |neuron: &IirNeuron| time_constant(largest_root(&neuron.a));
            let slowest = network.iir.iter().map(slowest).fold(0.0, f64::max);
            assert!((100.0..200.0).contains(&slowest), "order {order}: {slowest}");
        }
    }

    #[test]
    fn a_network_embedded_in_a_larger_one_does_the_same() {
        let small = Structure { inputs: 2, outputs: 2, v1: 2, v2: 3, ..Structure::PAPER };
        let values = noise(small.parameters(), 5).iter().map(|e| 0.4 * e).collect();
        let small = Theta { structure: small, values };
        let inputs = noise(400, 6);
        let wanted = small.simulate(&inputs);
        for (v1, v2, order) in [(2, 3, 1), (4, 3, 1), (2, 6, 1), (2, 3, 2), (3, 5, 3)] {
            let into = Structure { v1, v2, order, ..small.structure };
            let mut draws = noise(into.parameters() + 20, 7).into_iter();
            let large = small.embedded(into, || draws.next().unwrap());
            for (found, wanted) in large.simulate(&inputs).iter().zip(&wanted) {
                assert!((found - wanted).abs() < 1e-12, "{into:?}");
            }
        }
        assert!(!small.structure.contains(&Structure { v1: 3, ..small.structure }));
    }

    #[test]
    fn a_start_has_the_poles_that_were_drawn() {
        assert_eq!(monic(&[0.5, 0.25]), [-0.75, 0.125]);
        let structure = Structure { order: 2, ..Structure::PAPER };
        let mut draws = noise(structure.parameters() + 10, 4).into_iter();
        let start = Theta::draw(structure, || draws.next().unwrap());
        assert_eq!(start.values.len(), structure.parameters());
        assert!(start.values.iter().all(|value| value.is_finite()));
    }
}
