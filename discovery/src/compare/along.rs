//! What the model does along a recording: the variables over which it may fail.

use crate::case::Case;
use crate::run::Runner;
use drivescope_plant::model::{CURRENT, POSITION, SPEED};

/// The model's own signals, one value a sample of the recording; NaN between the pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
    /// Current, A (force-driven: the command).
    pub i: Vec<f64>,
    /// Speed, rad/s (m/s).
    pub omega: Vec<f64>,
    /// Position, rad (m); the measured angle where there is one.
    pub theta: Vec<f64>,
    /// Sign of the motion: 0 where the shaft sticks.
    pub direction: Vec<f64>,
}

impl Case<'_> {
    /// The states of the run, as each sample finds them.
    pub fn along(&self) -> Along {
        let samples = self.measured.len();
        let empty = || vec![f64::NAN; samples];
        let mut along = Along { i: empty(), omega: empty(), theta: empty(), direction: empty() };
        let mut runner = Runner::of_values(self);
        let force = self.drive.motor.input == drivescope_plant::drive::Input::Force;
        for k in self.measured.pieces.iter().cloned().flatten() {
            let before = runner.state().clone();
            runner.sample(k, [0.0; 2]);
            // The start of a piece is set by its first sample.
            let state = if self.measured.pieces.iter().any(|piece| piece.start == k) {
                runner.state()
            } else {
                &before
            };
            along.i[k] = if force { self.measured.u[k] } else { state.x[CURRENT][0] };
            along.omega[k] = state.x[SPEED][0];
            along.theta[k] =
                self.measured.angle.as_ref().map_or(state.x[POSITION][0], |angle| angle[k]);
            along.direction[k] = if along.omega[k] == 0.0 { 0.0 } else { along.omega[k].signum() };
        }
        along
    }
}
