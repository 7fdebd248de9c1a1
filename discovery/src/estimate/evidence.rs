//! What an estimate rests on.

use drivescope_plant::drive::Drive;

use crate::case::{Case, Setting};
use crate::measured::{Channel, Measured, largest};
use crate::start::Start;

/// Recordings of one machine with what is known of their noise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evidence {
    pub recordings: Vec<Measured>,
    /// Standard deviation of the noise of each one's outputs, in their units.
    pub noise: Vec<Vec<f64>>,
}

impl Evidence {
    /// Samples of all recordings.
    pub(crate) fn samples(&self) -> usize {
        self.recordings.iter().map(Measured::len).sum()
    }

    /// One of the recordings alone.
    pub(crate) fn alone(&self, recording: usize) -> Self {
        let noise = self.noise.get(recording).cloned().into_iter().collect();
        Self { recordings: vec![self.recordings[recording].clone()], noise }
    }

    /// The greatest torque (force) that drives in any of them, N m (N).
    pub(crate) fn driving(&self, drive: &Drive) -> f64 {
        let currents = self.recordings.iter().map(|it| largest(it.current(drive)));
        drive.motor.k_m * currents.fold(0.0, f64::max)
    }

    /// A recording with the drive as it is in it, and the state at the beginning of each of its pieces.
    pub fn case<'a>(
        &'a self,
        recording: usize,
        drive: &'a Drive,
        starts: &'a [Start],
        setting: &'a Setting,
    ) -> Case<'a> {
        let (measured, noise) = (&self.recordings[recording], &self.noise[recording]);
        Case { drive, measured, noise, starts, setting }
    }

    /// Measured values in all of them.
    pub fn values(&self) -> usize {
        self.recordings.iter().map(Measured::values).sum()
    }

    /// Squares of all measured values less their mean, in units of the noise.
    pub fn power(&self) -> f64 {
        let of = |(channel, sd): (&Channel, &f64)| {
            let values = || channel.values.iter().filter(|value| value.is_finite());
            let mean = values().sum::<f64>() / values().count() as f64;
            values().map(|y| ((y - mean) / sd).powi(2)).sum::<f64>()
        };
        let each = self.recordings.iter().zip(&self.noise);
        each.flat_map(|(measured, noise)| measured.outputs.iter().zip(noise)).map(of).sum()
    }
}
