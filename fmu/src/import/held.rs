//! A recorded signal as an input: held between its samples, in the unit of the input.

use std::sync::Arc;

use drivescope_recording::{Clock, Recording};

use drivescope_units::Conversion;

use crate::vocabulary::{Unit, convert};

/// One signal of a recording as an input.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    recording: Arc<Recording>,
    clock: Clock,
    signal: usize,
    conversion: Conversion,
}

impl Held {
    pub(crate) fn new(recording: Arc<Recording>, signal: usize, conversion: Conversion) -> Held {
        let clock = recording.clock();
        Held { recording, clock, signal, conversion }
    }

    /// The last sample that is not after `time` (s). Before the first sample it is the first one,
    /// after the last sample (of a segment: up to the next) the last one.
    pub(crate) fn at(&self, time: f64) -> f64 {
        let values = &self.recording.signals[self.signal].values;
        self.conversion.apply(values[self.clock.sample(time).min(values.len() - 1)])
    }
}

/// How a recorded signal becomes the value of an input.
pub(crate) fn from_recorded(unit: &str, to: Option<&Unit>, defined: &[Unit]) -> Option<Conversion> {
    let Some(to) = to else { return Some(Conversion::IDENTITY) };
    if unit.is_empty() || unit == "1" || unit == to.name {
        return Some(Conversion::IDENTITY);
    }
    let bare = Unit { name: unit.to_owned(), base: None };
    let from = defined.iter().find(|defined| defined.name == unit).unwrap_or(&bare);
    convert(Some(from), Some(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_recording::Signal;

    #[test]
    fn samples_are_held() {
        let values = vec![1.0, 2.0, 3.0];
        let signal = Signal { name: "u".into(), unit: "V".into(), values };
        let recording = Recording::new("r", 1.0, 0.1, vec![signal]);
        let conversion = Conversion { factor: 2.0, offset: 0.0 };
        let held = Held::new(Arc::new(recording), 0, conversion);
        let at = [0.0, 1.0, 1.09, 1.0 + 0.1, 1.0 + 2.0 * 0.1, 9.0];
        assert_eq!(at.map(|time| held.at(time)), [2.0, 2.0, 2.0, 4.0, 6.0, 6.0]);
    }

    #[test]
    fn recorded_units_convert_as_the_component_defines_them() {
        use drivescope_units::BaseUnit;
        let base =
            |factor| Some(BaseUnit { powers: [0, 0, -1, 0, 0, 0, 0, 1], factor, offset: 0.0 });
        let rad = Unit { name: "rad/s".into(), base: base(1.0) };
        let rpm = Unit { name: "rpm".into(), base: base(0.1) };
        let defined = [rad.clone(), rpm];
        assert_eq!(from_recorded("rpm", Some(&rad), &defined).unwrap().apply(10.0), 1.0);
        assert_eq!(from_recorded("1", Some(&rad), &defined), Some(Conversion::IDENTITY));
        assert_eq!(from_recorded("A", Some(&rad), &defined), None);
        assert_eq!(from_recorded("A", None, &defined), Some(Conversion::IDENTITY));
    }
}
