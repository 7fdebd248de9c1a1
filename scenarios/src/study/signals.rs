//! Signals of a run, as the study takes them.

use drivescope_diagnoser::{Column, Data, DataError};
use drivescope_recording::Recording;

/// Control signal and tachometer signal of one run.
#[derive(Debug, Clone)]
pub struct Signals {
    /// C_m, V.
    pub c_m: Vec<f64>,
    pub t: Vec<f64>,
}

impl Signals {
    /// Those of a recording.
    pub fn of(recording: &Recording) -> Self {
        let of = |name| values(recording, name).to_vec();
        Self { c_m: of("C_m"), t: of("T") }
    }

    /// The signals as a diagnoser takes them.
    ///
    /// # Errors
    /// A signal that is not finite.
    pub fn data(&self) -> Result<Data<'_>, DataError> {
        let column = |name, values| Column { name, values };
        Data::new(vec![column("C_m", &self.c_m)], column("T", &self.t))
    }
}

/// The values of a signal; none if the recording does not have it.
pub(super) fn values<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    recording.signal(name).map_or(&[], |signal| &signal.values)
}

/// Root mean square about the mean: what these values do, not an estimate of what others would.
pub(super) fn rms_about_mean(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt()
}
