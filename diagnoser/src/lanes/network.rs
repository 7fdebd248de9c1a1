//! A locally recurrent network (1), (5) of one input and one output over lanes.

use std::sync::Arc;

use crate::network::{Network, activation};

/// The network as [`crate::network`] runs it, each number one of `N` lanes.
#[derive(Debug, Clone)]
pub(super) struct NetworkLanes<const N: usize> {
    network: Arc<Network>,
    order: usize,
    /// x1: of each IIR neuron its filter's last r values, newest first.
    x1: Vec<[f64; N]>,
    /// x2: of each FIR neuron its last r values, newest first.
    x2: Vec<[f64; N]>,
    /// C, its one row.
    c: Vec<f64>,
    sigma: Vec<[f64; N]>,
}

impl<const N: usize> NetworkLanes<N> {
    pub(super) fn new(network: &Arc<Network>) -> Option<Self> {
        let structure = network.structure()?;
        Some(Self {
            network: Arc::clone(network),
            order: structure.order,
            x1: vec![[0.0; N]; structure.v1 * structure.order],
            x2: vec![[0.0; N]; structure.v2 * structure.order],
            c: network.c.first()?.clone(),
            sigma: vec![[0.0; N]; structure.v1],
        })
    }

    #[inline(always)]
    pub(super) fn step(&mut self, u: &[f64; N]) -> [f64; N] {
        let Self { network, order, x1, x2, c, sigma } = self;
        let (input, output) = (&network.input_scales[0], &network.output_scales[0]);
        let mut standard = [0.0; N];
        for l in 0..N {
            standard[l] = input.standardise(u[l]);
        }
        for (i, neuron) in network.iir.iter().enumerate() {
            let x = &mut x1[i * *order..][..*order];
            let mut drive = [0.0; N];
            for l in 0..N {
                drive[l] = neuron.w[0] * standard[l];
            }
            let (seen, fed_back) = (sum(&neuron.b, x), sum(&neuron.a, x));
            let mut next = [0.0; N];
            for l in 0..N {
                let q = neuron.b_0 * drive[l] + seen[l] - neuron.g_1;
                sigma[i][l] = activation(neuron.g_2 * q);
                next[l] = drive[l] - fed_back[l];
            }
            shift_in(x, &next);
        }
        let standard_y = sum(c, x2);
        let mut y = [0.0; N];
        for l in 0..N {
            y[l] = output.restore(standard_y[l]);
        }
        for (j, neuron) in network.fir.iter().enumerate() {
            let fed = sum(&neuron.w_2, sigma);
            let mut value = [0.0; N];
            for l in 0..N {
                value[l] = fed[l] + neuron.w_u[0] * standard[l];
            }
            shift_in(&mut x2[j * *order..][..*order], &value);
        }
        y
    }
}

#[inline(always)]
fn sum<const N: usize>(weights: &[f64], rows: &[[f64; N]]) -> [f64; N] {
    let mut sum = [0.0; N];
    for (weight, row) in weights.iter().zip(rows) {
        for l in 0..N {
            sum[l] += weight * row[l];
        }
    }
    sum
}

#[inline(always)]
fn shift_in<const N: usize>(rows: &mut [[f64; N]], newest: &[f64; N]) {
    for r in (1..rows.len()).rev() {
        rows[r] = rows[r - 1];
    }
    rows[0] = *newest;
}
