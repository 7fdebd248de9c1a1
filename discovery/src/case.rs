//! One recording with one drive: what every estimate and every test is made of.

use drivescope_plant::drive::Drive;
use drivescope_plant::integrate::longest_substep;
use drivescope_plant::sampled::speed_bound;

use crate::measured::Measured;
use crate::observer::Observer;
use crate::start::Start;

/// How many times the sub-step of a plain simulation is taken. A simulation keeps 1e-8 of a
/// variable's range and its error grows with the fourth power of the sub-step: 5 leaves at most
/// 1e-5, below any sensor's resolution.
pub const PACE: f64 = 5.0;
/// The same where the sub-step is set by the speed at which a ripple over the position is passed:
/// 0.8 rad of it a sub-step. What is passed so fast is an integral over the sub-step, off by
/// x^4 / 2880 = 2e-4 of itself, and hardly moves the shaft any more.
pub const PASSING_PACE: f64 = 25.0;

/// What a fit freezes, for only so has the sum of squares no jumps. The observer is that of the base
/// along the whole ladder of added effects, for only so do errors compare; sub-steps are each drive's
/// own: they are finer than any sensor, and one fast candidate is not to slow down all that follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    pub observer: Observer,
    /// Greatest speed that sub-steps are made for, rad/s (m/s): a ripple over the position is the
    /// faster, the faster it is passed.
    pub speed: f64,
    /// Longest sub-step of the integration, s.
    pub longest_s: f64,
}

impl Setting {
    /// Freezes sub-steps of [`PACE`] times those of a simulation of the drive, and of
    /// [`PASSING_PACE`] times those at the greatest speed that its limits allow.
    pub fn new(drive: &Drive, observer: Observer) -> Self {
        Self::up_to(drive, observer, speed_bound(drive))
    }

    /// The same observer and speed with the sub-steps of that drive.
    pub fn of(&self, drive: &Drive) -> Self {
        Self::up_to(drive, self.observer, self.speed)
    }

    /// At that speed, rad/s (m/s).
    pub(crate) fn up_to(drive: &Drive, observer: Observer, speed: f64) -> Self {
        let model = drive.model();
        let own = PACE * longest_substep(&model, 0.0);
        let passing = PASSING_PACE * longest_substep(&model, speed);
        Self { observer, speed, longest_s: own.min(passing) }
    }
}

/// A drive with the recording that it is compared with.
#[derive(Debug, Clone, Copy)]
pub struct Case<'a> {
    /// The drive, with the values of its parameters for this recording.
    pub drive: &'a Drive,
    /// The recording.
    pub measured: &'a Measured,
    /// Standard deviation of the noise of each output, in its unit, in the order of the outputs.
    pub noise: &'a [f64],
    /// State at the beginning of each piece.
    pub starts: &'a [Start],
    /// What is frozen.
    pub setting: &'a Setting,
}

/// A sum of squared errors in units of the noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Squares {
    /// The sum; infinite where the model overflowed.
    pub sum: f64,
    /// Measured values in it.
    pub values: usize,
}

impl Squares {
    /// Root of the mean: 1 is the noise floor of a free run.
    pub fn error(&self) -> f64 {
        (self.sum / self.values as f64).sqrt()
    }

    /// Of residuals in units of the noise, one list an output; NaN are left out.
    pub(crate) fn of(residuals: &[Vec<f64>]) -> Self {
        let finite = residuals.iter().flatten().filter(|residual| residual.is_finite());
        finite.fold(Self::default(), |all, r| Self { sum: all.sum + r * r, values: all.values + 1 })
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { sum: self.sum + other.sum, values: self.values + other.values }
    }
}
