//! Which signals a diagnoser was trained on, and the refusal of any others.

use drivescope_recording::Recording;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::data::{Column, Data, DataError};

/// Sampling times that differ by less than this share are the same: recordings print them to
/// finitely many digits. Over a 1000-sample window the time axes then differ by a tenth of a sample.
const PERIOD_TOLERANCE: f64 = 1e-4;

/// Why a recording does not fit a diagnoser.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InterfaceError {
    /// A signal is not in the recording.
    #[error("recording {recording} has no signal {name} (it has: {available})")]
    MissingSignal {
        recording: String,
        /// The signal looked for.
        name: String,
        /// The signals found.
        available: String,
    },
    /// A signal is in another unit.
    #[error(
        "signal {name} of {recording} is in {found}, the diagnoser was trained in {expected}: convert it"
    )]
    Unit {
        recording: String,
        /// The signal.
        name: String,
        /// Unit of the training.
        expected: String,
        /// Unit in the recording.
        found: String,
    },
    /// Another sampling time.
    #[error(
        "{recording} is sampled every {found} s, the diagnoser was trained at {expected} s: resample it"
    )]
    Period {
        recording: String,
        /// Sampling time of the training, s.
        expected: f64,
        /// Sampling time of the recording, s.
        found: f64,
    },
    /// The values themselves.
    #[error("recording {recording}: {source}")]
    Data {
        recording: String,
        /// What is wrong with them.
        source: DataError,
    },
}

/// Name and unit of one signal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Name of the signal in recordings.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
}

impl Channel {
    /// A channel of that name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// The signals that a model was trained on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// Sampling time, s.
    pub period_s: f64,
    /// Inputs, in the order in which the model takes them.
    pub inputs: Vec<Channel>,
    /// The watched output.
    pub output: Channel,
}

impl Interface {
    /// The signals of this interface in a recording, if it has them all, in these units, at this
    /// sampling time, and all finite.
    pub fn select<'a>(&self, recording: &'a Recording) -> Result<Data<'a>, InterfaceError> {
        let (expected, found) = (self.period_s, recording.period_s);
        // Written so that a NaN is refused too.
        let same = (found - expected).abs() <= PERIOD_TOLERANCE * expected;
        if !same {
            let recording = recording.name.clone();
            return Err(InterfaceError::Period { recording, expected, found });
        }
        let inputs = self.inputs.iter().map(|channel| find(recording, channel));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let output = find(recording, &self.output)?;
        Data::new(inputs, output)
            .map(|data| data.in_segments(recording.segments()))
            .map_err(|source| InterfaceError::Data { recording: recording.name.clone(), source })
    }
}

fn find<'a>(recording: &'a Recording, channel: &Channel) -> Result<Column<'a>, InterfaceError> {
    let Some(signal) = recording.signal(&channel.name) else {
        let names: Vec<_> = recording.signals.iter().map(|signal| signal.name.as_str()).collect();
        return Err(InterfaceError::MissingSignal {
            recording: recording.name.clone(),
            name: channel.name.clone(),
            available: names.join(", "),
        });
    };
    if signal.unit != channel.unit {
        return Err(InterfaceError::Unit {
            recording: recording.name.clone(),
            name: channel.name.clone(),
            expected: channel.unit.clone(),
            found: signal.unit.clone(),
        });
    }
    Ok(Column { name: &signal.name, values: &signal.values })
}

#[cfg(test)]
mod tests {
    use drivescope_recording::Signal;

    use super::*;

    fn interface() -> Interface {
        Interface {
            period_s: 0.005,
            inputs: vec![Channel::new("C_m", "V")],
            output: Channel::new("T", "rpm"),
        }
    }

    fn recording() -> Recording {
        let signal = |name: &str, unit: &str, values: Vec<f64>| Signal {
            name: name.into(),
            unit: unit.into(),
            values,
        };
        Recording::new(
            "bench",
            0.0,
            0.005,
            vec![
                signal("I_m", "A", vec![0.1, 0.2]),
                signal("T", "rpm", vec![10.0, 20.0]),
                signal("C_m", "V", vec![1.0, 2.0]),
            ],
        )
    }

    #[test]
    fn signals_are_found_by_name_whatever_their_order() {
        let recording = recording();
        let data = interface().select(&recording).unwrap();
        assert_eq!(data.inputs()[0].values, [1.0, 2.0]);
        assert_eq!(data.output().values, [10.0, 20.0]);
    }

    #[test]
    fn other_signals_units_and_sampling_times_are_refused() {
        let mut missing = recording();
        missing.signals.remove(2);
        let error = interface().select(&missing).unwrap_err();
        assert_eq!(error.to_string(), "recording bench has no signal C_m (it has: I_m, T)");
        let mut radians = recording();
        radians.signals[1].unit = "rad/s".into();
        let error = interface().select(&radians).unwrap_err();
        assert!(matches!(error, InterfaceError::Unit { ref found, .. } if found == "rad/s"));
        for period_s in [0.001, f64::NAN] {
            let slow = Recording { period_s, ..recording() };
            let error = interface().select(&slow).unwrap_err();
            assert!(matches!(error, InterfaceError::Period { expected: 0.005, .. }), "{error}");
        }
        let printed = Recording { period_s: 0.005_000_000_1, ..recording() };
        assert!(interface().select(&printed).is_ok());
        let mut gap = recording();
        gap.signals[2].values[1] = f64::NAN;
        let error = interface().select(&gap).unwrap_err();
        assert!(error.to_string().contains("C_m is not a finite number at sample 1"), "{error}");
    }
}
