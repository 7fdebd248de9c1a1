//! The shared library of an FMU: a [`Model`](drivescope_fmu::export::Model) and one line.

mod model;

pub use model::Oscillator;

drivescope_fmu::export_model!(Oscillator);
