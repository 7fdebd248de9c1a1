//! The faults of the experiment: what fails, by how much, when.

use crate::profile::Profile;
use crate::results::{FaultName, TorqueReading};

/// A fault that acts from one sample to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// What it is, with the paper's label.
    pub name: FaultName,
    /// First faulty sample.
    pub from: usize,
    /// First sample after it.
    pub until: usize,
    /// How its size goes between them.
    pub profile: Profile,
}

/// Samples from which and to which the paper's faults act.
pub const SPAN: std::ops::Range<usize> = 4000..5000;

/// Sizes of f_1..6^1: the tachometer's faults.
const TACHO: [f64; 6] = [0.05, -0.05, 0.10, -0.10, 0.20, -0.20];
/// Sizes of f_1..6^2: the mechanical faults.
const TORQUE: [f64; 6] = [0.20, -0.20, 0.10, -0.10, 0.05, -0.05];

/// The paper's twelve faults, torque faults in that reading.
pub fn twelve(reading: TorqueReading) -> Vec<Fault> {
    let kinds = [(1, "tacho", TACHO), (2, reading.mechanism(), TORQUE)];
    let named = kinds.into_iter().flat_map(|(group, kind, sizes)| {
        sizes.into_iter().enumerate().map(move |(k, size)| FaultName {
            kind: kind.to_owned(),
            size,
            label: format!("f_{}^{group}", k + 1),
        })
    });
    let fault = |name| Fault { name, from: SPAN.start, until: SPAN.end, profile: Profile::Step };
    named.map(fault).collect()
}

impl FaultName {
    /// Name for people: `tacho +5 %`.
    pub fn shown(&self) -> String {
        format!("{} {:+.0} %", self.kind, 100.0 * self.size)
    }

    /// Name for files: `tacho_+5`.
    pub fn file_name(&self) -> String {
        format!("{}_{:+.0}", self.kind, 100.0 * self.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_and_sizes_are_the_papers() {
        let faults = twelve(TorqueReading::Flux);
        let find = |label: &str| {
            faults.iter().find(|fault| fault.name.label == label).expect("it is one of twelve")
        };
        assert_eq!(faults.len(), 12);
        assert_eq!(find("f_1^1").name.shown(), "tacho +5 %");
        assert_eq!(find("f_6^1").name.shown(), "tacho -20 %");
        assert_eq!(find("f_1^2").name.shown(), "flux +20 %");
        assert_eq!(find("f_6^2").name.file_name(), "flux_-5");
        assert_eq!((find("f_3^2").from, find("f_3^2").until), (4000, 5000));
    }
}
