//! How far back an ARX model looks.

use serde::{Deserialize, Serialize};

/// Orders of an ARX model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orders {
    /// Past outputs.
    pub n_a: usize,
    /// Past samples of every input.
    pub n_b: usize,
    /// Whether a constant is fitted.
    pub constant: bool,
}

impl Orders {
    /// The paper's n_a = n_b = 20, and a constant.
    pub const PAPER: Self = Self { n_a: 20, n_b: 20, constant: true };

    /// Past samples that the first equation needs.
    pub(super) fn reach(&self) -> usize {
        self.n_a.max(self.n_b)
    }

    /// Parameters for that many inputs.
    pub fn parameters(&self, inputs: usize) -> usize {
        self.n_a + inputs * self.n_b + usize::from(self.constant)
    }
}
