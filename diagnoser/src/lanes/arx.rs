//! An ARX model of one input over lanes.

use std::sync::Arc;

use super::{HistoryLanes, dot};
use crate::arx::Arx;

#[derive(Debug, Clone)]
pub(super) struct ArxLanes<const N: usize> {
    model: Arc<Arx>,
    past_y: HistoryLanes<N>,
    past_u: HistoryLanes<N>,
}

impl<const N: usize> ArxLanes<N> {
    pub(super) fn new(model: &Arc<Arx>) -> Self {
        let past_u = HistoryLanes::new(model.b.first().map_or(0, Vec::len));
        Self { model: Arc::clone(model), past_y: HistoryLanes::new(model.a.len()), past_u }
    }

    #[inline(always)]
    pub(super) fn step(&mut self, u: &[f64; N]) -> [f64; N] {
        let own = dot(&self.model.a, self.past_y.window());
        let driven = match self.model.b.first() {
            Some(b) => dot(b, self.past_u.window()),
            None => [0.0; N],
        };
        let mut y = [0.0; N];
        for l in 0..N {
            y[l] = self.model.constant - own[l] + driven[l];
        }
        self.past_y.push(&y);
        self.past_u.push(u);
        y
    }
}
