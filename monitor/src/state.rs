//! Where a monitor stands after a row.

use crate::declaration::Declaration;

/// Residual and band of a detector at the last row.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shown {
    /// What was measured less what the model makes of the inputs, in the unit of the output; of
    /// windows the mean over the last one, less that of the baseline; of a bank in standard
    /// deviations.
    pub residual: f64,
    /// Lower bound of a healthy one.
    pub lower: f64,
    /// Upper bound of a healthy one.
    pub upper: f64,
    /// Whether it lies outside and was judged.
    pub outside: bool,
    /// Whether a fault stands declared.
    pub standing: bool,
}

/// Decision of a method at the last row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// The machine is being learned, or the models settle.
    NotYet,
    /// Nothing is outside.
    Healthy,
    /// A statistic of the bank went over its limit; what it is will be judged.
    Alarm,
    /// A fault stands declared.
    Fault,
    /// Its baseline makes no machine, or the operating point was never shown.
    NotJudged,
}

impl State {
    /// All of them with what they mean, in the order of their codes from 0 on.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::NotYet, "not judged yet"),
        (Self::Healthy, "healthy"),
        (Self::Alarm, "alarm, being judged"),
        (Self::Fault, "fault declared"),
        (Self::NotJudged, "not judged here"),
    ];

    /// Its code: the place among [`Self::ALL`].
    pub fn code(self) -> usize {
        Self::ALL.iter().position(|(state, _)| *state == self).unwrap_or(0)
    }
}

/// What a method has declared until now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing<'a> {
    /// Its decision at the last row.
    pub state: State,
    /// How often it declared a fault.
    pub declared: usize,
    /// The fault that stands declared.
    pub declaration: Option<&'a Declaration>,
}
