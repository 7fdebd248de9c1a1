//! The words of the standard that descriptions are made of, once for what is written and what is
//! read: their meaning, their spelling, which of them go together and what holds where none is said.
//!
//! FMI 2.0.4 and 3.0.2 spell them alike; `structuralParameter` is a word of FMI 3.0 alone.
//!
//! A whole description there are two of. [`ModelDescription`](crate::description::ModelDescription)
//! is what a model of ours is, in numbers and value references; it is checked before it is written.
//! `import::Description` is what any file says, in its own texts and places, wrong ones among them.

mod experiment;
mod rules;
mod types;
mod unit;
mod version;
mod words;

pub use experiment::DefaultExperiment;
#[cfg(feature = "import")]
pub(crate) use rules::default_variability;
pub(crate) use rules::{default_initial, go_together};
pub use types::Type;
pub use unit::Unit;
#[cfg(feature = "import")]
pub use unit::convert;
pub use version::{Interface, Version};
pub(crate) use words::Word;
pub use words::{Causality, Initial, Variability};
