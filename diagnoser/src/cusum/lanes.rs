//! The test over lanes of runs, each with its own settings.

use std::sync::Arc;

use super::{Cusum, MOST};
use crate::lanes::{HistoryLanes, dot};

/// What the test says of a sample, lane by lane.
#[derive(Debug, Clone, Copy)]
pub struct CusumStep<const N: usize> {
    /// The innovation e, in its standard deviations.
    pub innovation: [f64; N],
    /// 1 where a sum exceeds its threshold, else 0: numbers, for loops over truth values do not
    /// become vector code.
    pub exceeds: [u64; N],
}

/// The running test; its clone is its state.
#[derive(Debug, Clone)]
pub struct CusumLanes<const N: usize> {
    cusum: Arc<Cusum>,
    past: HistoryLanes<N>,
    up: [f64; N],
    down: [f64; N],
    threshold: [f64; N],
    kappa: [f64; N],
}

impl<const N: usize> CusumLanes<N> {
    /// The test at its start, with a threshold h and a drift kappa a lane.
    pub fn new(cusum: &Cusum, threshold: [f64; N], kappa: [f64; N]) -> Self {
        let past = HistoryLanes::new(cusum.whitening.a.len());
        let cusum = Arc::new(cusum.clone());
        Self { cusum, past, up: [0.0; N], down: [0.0; N], threshold, kappa }
    }

    /// Takes r - y_e of the next sample, output unit.
    #[inline(always)]
    pub fn step(&mut self, remainder: &[f64; N]) -> CusumStep<N> {
        let whitening = &self.cusum.whitening;
        let past = dot(&whitening.a, self.past.window());
        let (mut centred, mut innovation, mut exceeds) = ([0.0; N], [0.0; N], [0; N]);
        let scale = 1.0 / whitening.deviation;
        for l in 0..N {
            centred[l] = remainder[l] - whitening.mean;
            let e = (centred[l] + past[l]) * scale;
            let most = MOST * self.threshold[l];
            let up = self.up[l] + e - self.kappa[l];
            let down = self.down[l] - e - self.kappa[l];
            let up = if up > 0.0 { up } else { 0.0 };
            let down = if down > 0.0 { down } else { 0.0 };
            self.up[l] = if up < most { up } else { most };
            self.down[l] = if down < most { down } else { most };
            let highest = if self.up[l] > self.down[l] { self.up[l] } else { self.down[l] };
            exceeds[l] = u64::from(highest > self.threshold[l]);
            innovation[l] = e;
        }
        self.past.push(&centred);
        CusumStep { innovation, exceeds }
    }

    /// Sets the sums of a lane to zero; the innovations go on.
    pub fn restart(&mut self, l: usize) {
        (self.up[l], self.down[l]) = (0.0, 0.0);
    }

    /// The same in every lane.
    #[inline(always)]
    pub fn restart_all(&mut self) {
        (self.up, self.down) = ([0.0; N], [0.0; N]);
    }
}
