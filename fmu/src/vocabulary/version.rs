//! Version of the standard, and the interface types that both versions have.

use std::fmt;

/// Major version of the FMI standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0 and its compatible successors.
    Three,
}

/// The interface type: who integrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    /// The FMU.
    CoSimulation,
    /// The importer.
    ModelExchange,
}

impl fmt::Display for Interface {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self {
            Interface::CoSimulation => "Co-Simulation",
            Interface::ModelExchange => "Model Exchange",
        })
    }
}
