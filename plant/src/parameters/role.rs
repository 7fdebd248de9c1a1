//! What the numbers of a drive are for.

/// What a number of the drive is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// It enters the balances: what a fit estimates.
    Physics,
    /// Controller, amplifier or generator: set by people, not estimated.
    Control,
    /// Resolution or noise of a sensor, or a disturbance.
    Sensing,
    /// A figure of the rating plate, a scale only.
    Rating,
}
