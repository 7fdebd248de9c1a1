//! What a bank must know of the process that it watches.
//!
//! The process is a state space with known noise: x' = f(x, row) + noise, y = h(x, row) + noise.
//! The last states are parameters of the machine, constant but for a slow drift, as offsets from
//! the values that the process was linearised about: filtering a healthy run learns them, and
//! what remains unknown of them is part of every later judgement.

use serde::{Deserialize, Serialize};

use crate::memory::{Memory, MemoryError, Walk};

/// Sensors of a drive: tachometer, current, voltage at the armature.
pub const SENSORS: usize = 3;
/// Mechanisms in a bank at most: the columns of all lie side by side.
pub const MECHANISMS: usize = 16;

/// One sample; what was not measured is not a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Control effort C_m, V: known exactly, for the controller computed it.
    pub control: f64,
    /// What the sensors show: speed, rad/s (m/s); current, A; voltage, V.
    pub shown: [f64; SENSORS],
}

/// A way in which the process can fail: one number, 0 when healthy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mechanism {
    /// Identifier.
    pub id: String,
    /// Unit of the size; `1` for a fraction.
    pub unit: String,
    /// Greatest magnitude of a size that is looked for.
    pub most: f64,
    /// Least size: a gain or a resistance does not change its sign.
    pub least: f64,
    /// Logarithm of how much less usual it is than the others: what decides between mechanisms that
    /// the rows do not tell apart.
    pub rarer: f64,
}

/// Mean and covariance of the state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief<const N: usize> {
    pub mean: [f64; N],
    /// Covariance, symmetric.
    pub covariance: [[f64; N]; N],
}

impl Row {
    /// A sample at which nothing was measured.
    pub const NOTHING: Self = Self { control: f64::NAN, shown: [f64::NAN; SENSORS] };
}

impl Memory for Row {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.control.walk(walk)?;
        self.shown.walk(walk)
    }
}

impl<const N: usize> Memory for Belief<N> {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.mean.walk(walk)?;
        self.covariance.walk(walk)
    }
}

/// What the sensors should show of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed<const N: usize> {
    /// Expected values.
    pub shown: [f64; SENSORS],
    /// Their derivatives by the state.
    pub rows: [[f64; N]; SENSORS],
    /// Variances of the sensors' noise; 0 for a sensor that the process does not have.
    pub variance: [f64; SENSORS],
    /// Derivatives of the expected values by the size of each mechanism.
    pub columns: [[f64; MECHANISMS]; SENSORS],
}

/// The state one sample later.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advanced<const N: usize> {
    /// Expected state.
    pub next: [f64; N],
    /// Its derivative by the state before.
    pub transition: [[f64; N]; N],
    /// Covariance that the sample adds.
    pub added: [[f64; N]; N],
    /// Derivatives by the size of each mechanism.
    pub columns: [[f64; MECHANISMS]; N],
}

/// A process with `N` states. A fault acts on the sensors of a row at once and on the state until
/// the next row.
pub trait Process<const N: usize>: Clone {
    /// The ways in which it can fail, at most [`MECHANISMS`].
    fn mechanisms(&self) -> &[Mechanism];

    /// Steps in which each sensor is read, in its unit; 0 where they are too fine to matter.
    fn quanta(&self) -> [f64; SENSORS];

    /// The parameters of the machine, which are the last states.
    fn learned(&self) -> &[String];

    /// What is known of the state before anything but the first row was seen.
    fn begin(&self, row: &Row) -> Belief<N>;

    /// What the sensors should show of that state.
    fn sense(&mut self, x: &[f64; N], row: &Row) -> Sensed<N>;

    /// Where the state goes until the next row.
    fn advance(&mut self, belief: &Belief<N>, row: &Row) -> Advanced<N>;

    /// Lets that fault act in place of any other.
    fn set_fault(&mut self, mechanism: usize, size: f64);

    /// The same process with that fault in place of any other.
    #[must_use]
    fn with_fault(&self, mechanism: usize, size: f64) -> Self {
        let mut made = self.clone();
        made.set_fault(mechanism, size);
        made
    }

    /// Takes what was learned of the machine out of the belief's mean and into the process.
    fn settle(&mut self, belief: &mut Belief<N>);

    /// Hands what was learned of the machine to a walk.
    ///
    /// # Errors
    /// As [`Memory::walk`].
    fn walk_machine(&mut self, walk: &mut Walk) -> Result<(), MemoryError>;
}
