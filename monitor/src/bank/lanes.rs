//! A step of the drive and of small changes of it, side by side in the lanes of one block.
//!
//! Lane 0 is the expected state; two lanes a state lie sqrt(3) standard deviations to either side
//! of it; one lane a mechanism has a small fault. Differences between the lanes are the filter's
//! derivatives, over the width that the state is uncertain by: what bends within it, such as dry
//! friction near rest, widens the prediction (second-order divided differences: M. Norgaard, N. K.
//! Poulsen, O. Ravn, Automatica 36 (2000), 1627-1638).

use drivescope_plant::integrate::{Block, State};
use drivescope_plant::model::{Applied, Model, SPEED};

/// Square root of 3: the width that suits a normal distribution.
pub(super) const WIDTH: f64 = 1.732_050_807_568_877_2;
/// Weight of a second difference over that width: sqrt(WIDTH^2 - 1) / (2 WIDTH^2).
const BEND: f64 = 0.235_702_260_395_515_84;
/// Least standard deviation that a difference is taken over, for a state that is known exactly.
const LEAST: f64 = 1e-8;

/// The lane above the expected value of state `n`; the one below follows it.
pub(super) fn above(n: usize) -> usize {
    1 + 2 * n
}

/// Standard deviations that differences are taken over.
pub(super) fn spread(variance: f64) -> f64 {
    WIDTH * variance.sqrt().max(LEAST)
}

/// Derivative by a state, and what bends, of a row over the lanes.
pub(super) fn differences<const L: usize>(row: &[f64; L], n: usize, spread: f64) -> (f64, f64) {
    let (up, down) = (row[above(n)], row[above(n) + 1]);
    ((up - down) / (2.0 * spread), BEND * (up + down - 2.0 * row[0]))
}

/// The block and its state.
#[derive(Debug, Clone)]
pub(super) struct Lanes<const L: usize> {
    pub(super) block: Block<f64, L>,
    pub(super) state: State<f64, L>,
}

impl<const L: usize> Lanes<L> {
    pub(super) fn new(model: &Model<f64, 1>, speed: f64) -> Self {
        let block = Block::new(Model::side_by_side([model; L]), speed);
        let state = State::at_rest(block.model());
        Self { block, state }
    }

    /// Sets the direction of every lane by its speed.
    fn set_directions(&mut self) {
        let model = self.block.model();
        for l in 0..L {
            let omega = self.state.x[SPEED][l];
            self.state.set_speed(model, l, omega);
        }
    }

    /// Moves all lanes on.
    pub(super) fn advance(&mut self, applied: &Applied<f64, L>, period_s: f64) {
        self.set_directions();
        self.block.advance(&mut self.state, applied, period_s);
    }
}
