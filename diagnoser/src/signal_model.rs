//! What a model of signals is: outputs simulated from inputs alone, one sample at a time.

use crate::data::{Column, Data};

/// A model in free run: it sees the inputs and never the measured outputs, so that a fault
/// cannot leak into what the model expects.
///
/// Its clone is its state: cloning and stepping the clone replays the same outputs. Memory is
/// fixed; a batch is the same steps in a loop, hence bit-identical to a stream.
pub trait SignalModel: Clone {
    /// Input signals a sample.
    fn inputs(&self) -> usize;

    /// Output signals a sample.
    fn outputs(&self) -> usize;

    /// Forgets the past: the state of a drive at rest with no input before.
    fn reset(&mut self);

    /// Outputs at this sample, in their units; `u` holds the inputs of the same sample.
    ///
    /// # Panics
    /// May panic if `u` does not hold [`SignalModel::inputs`] values.
    fn step(&mut self, u: &[f64]) -> &[f64];
}

/// Free run over whole signals from rest: one vector an output.
pub fn free_run(model: &mut impl SignalModel, inputs: &[Column]) -> Vec<Vec<f64>> {
    model.reset();
    let samples = inputs.first().map_or(0, |column| column.values.len());
    let mut outputs = vec![Vec::with_capacity(samples); model.outputs()];
    let mut row = vec![0.0; inputs.len()];
    for k in 0..samples {
        for (value, column) in row.iter_mut().zip(inputs) {
            *value = column.values[k];
        }
        for (signal, y) in outputs.iter_mut().zip(model.step(&row)) {
            signal.push(*y);
        }
    }
    outputs
}

/// Residual r = y - y_m of the first output over a whole recording, run-up included, each segment
/// from rest; 0 between them.
pub fn residual(model: &mut impl SignalModel, data: &Data) -> Vec<f64> {
    let mut residual = vec![0.0; data.len()];
    for segment in data.segments() {
        let part = data.span(segment.clone());
        let simulated = free_run(model, part.inputs()).swap_remove(0);
        let measured = part.output().values.iter().zip(simulated);
        for (r, (y, y_m)) in residual[segment.clone()].iter_mut().zip(measured) {
            *r = y - y_m;
        }
    }
    residual
}
