//! What a model of signals is: outputs simulated from inputs alone, one sample at a time.

use crate::data::{Column, Data};

/// Where a model begins a recording, and each of its segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// At rest, as a simulated run does that begins with a machine at rest.
    Rest,
    /// In the steady state of the first inputs: a machine that was found running.
    Steady,
}

/// Steps in which the steady state of held inputs is looked for, at most; and so many in a row that
/// change the output by less than this share of it are it.
const LONGEST: usize = 20_000;
const UNCHANGED: usize = 50;
const CHANGE: f64 = 1e-13;

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

    /// The steady state of inputs held at `u`.
    fn settle(&mut self, u: &[f64]) {
        self.reset();
        let (mut before, mut unchanged) = (f64::NAN, 0);
        for _ in 0..LONGEST {
            let y = self.step(u)[0];
            let same = (y - before).abs() <= CHANGE * y.abs().max(f64::MIN_POSITIVE);
            unchanged = if same { unchanged + 1 } else { 0 };
            if unchanged >= UNCHANGED {
                break;
            }
            before = y;
        }
    }
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

/// Residual r = y - y_m of the first output over a whole recording, run-up included; 0 between its
/// segments.
pub fn residual(model: &mut impl SignalModel, data: &Data, start: Start) -> Vec<f64> {
    let mut residual = vec![0.0; data.len()];
    let mut u = vec![0.0; data.inputs().len()];
    for segment in data.segments() {
        for k in segment.clone() {
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            if k == segment.start {
                match start {
                    Start::Rest => model.reset(),
                    Start::Steady => model.settle(&u),
                }
            }
            residual[k] = data.output().values[k] - model.step(&u)[0];
        }
    }
    residual
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::arx::Arx;

    #[test]
    fn a_model_that_was_found_running_has_no_transient() {
        let arx = Arc::new(Arx { a: vec![-1.5, 0.51], b: vec![vec![0.2, 0.1]], constant: 0.4 });
        let steady = (0.4 + 0.3 * 3.0) / (1.0 - 1.5 + 0.51);
        let u = [3.0; 40];
        let inputs = vec![Column { name: "u", values: &u }];
        let y = [steady; 40];
        let data = Data::new(inputs, Column { name: "y", values: &y }).expect("finite");
        let data = data.in_segments(vec![0..20, 20..40]);
        let found = residual(&mut arx.run(), &data, Start::Steady);
        assert!(found.iter().all(|r| r.abs() < 1e-9), "{found:?}");
        let from_rest = residual(&mut arx.run(), &data, Start::Rest);
        assert!(from_rest[20] > 1.0 && from_rest[0] > 1.0, "{from_rest:?}");
        // The same by stepping, which is what models without a formula do.
        #[derive(Clone)]
        struct Stepped(crate::arx::ArxRun);
        impl SignalModel for Stepped {
            fn inputs(&self) -> usize {
                1
            }
            fn outputs(&self) -> usize {
                1
            }
            fn reset(&mut self) {
                self.0.reset();
            }
            fn step(&mut self, u: &[f64]) -> &[f64] {
                self.0.step(u)
            }
        }
        let stepped = residual(&mut Stepped(arx.run()), &data, Start::Steady);
        assert!(stepped.iter().all(|r| r.abs() < 1e-8), "{stepped:?}");
    }
}
