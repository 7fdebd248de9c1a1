//! The words of the standard that descriptions are made of, once for what is written and what is
//! read: their meaning, their spelling, which of them go together and what holds where none is said.
//!
//! FMI 2.0.4 and 3.0.2 spell them alike; `structuralParameter` is a word of FMI 3.0 alone.

mod rules;
mod words;

#[cfg(feature = "import")]
pub(crate) use rules::default_variability;
pub(crate) use rules::{default_initial, go_together};
pub(crate) use words::Word;
pub use words::{Causality, Initial, Variability};
