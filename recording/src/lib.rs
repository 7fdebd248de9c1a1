//! Measured or simulated signals: names, units, uniform sampling.
//!
//! A [`Recording`] is what every other part exchanges: the program reads it from a file,
//! the plant's runs and the co-simulation fill one, the diagnoser and the discovery read one.

mod signal;

pub use signal::{Recording, Signal};
