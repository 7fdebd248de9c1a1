//! Fault isolation (26): which class of faults a symptom belongs to.
//!
//! ```text
//!  symptoms (u, r) of every fault ──> separability test ──> classes
//!         └──> standardised ──> perceptron 2-15-10-4, Levenberg-Marquardt ──> nearest code (26)
//!                   └──> distance to the faults of that class too large? ──> unknown
//!
//!  labelled recordings ──> KnownFaults, stored ──> Naming: a fault that stands declared, sample by
//!                                                  sample: its class and its size (27)
//! ```

mod isolator;
mod known;
mod learn;
mod mlp;
mod options;
mod separability;
mod symptoms;
#[cfg(test)]
mod testing;
mod training;

pub use self::isolator::{Isolated, IsolationMatrix, IsolationReport, Isolator};
pub use self::known::{KnownFaults, Named, Naming};
pub use self::learn::{FaultsError, FaultsReport, FaultyRun};
pub use self::mlp::{Mlp, MlpSize};
pub use self::options::{IsolationError, IsolatorOptions};
pub use self::separability::{Cloud, Discriminant, Partition, Separability, discriminant};
pub use self::symptoms::{FaultSymptoms, SymptomError, Symptoms, symptoms_of};
