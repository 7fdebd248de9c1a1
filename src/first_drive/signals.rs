//! What was measured, and what that says about the kind of drive.

use drivescope_plant::drive::{Input, Motion};
use drivescope_recording::{Recording, Unit};

use super::FirstDriveError;
use crate::failure::told;

/// Half the time over which a position is differentiated, s.
const HALF_DIFFERENCE_S: f64 = 0.005;

/// The signals of a recording that an estimate needs, SI.
#[derive(Debug, Clone)]
pub(crate) struct Signals {
    /// The recording's name.
    pub(super) name: String,
    /// Sampling time, s.
    pub(super) period_s: f64,
    /// Rotary or linear.
    pub(super) motion: Motion,
    /// What u is, and why it is taken as that.
    pub(super) input: (Input, &'static str),
    /// Voltage or force signal.
    pub(super) u: Vec<f64>,
    /// Unit of u.
    pub(super) u_unit: String,
    /// Armature current, A.
    pub(super) i: Option<Vec<f64>>,
    /// Speed; from the position where it was not measured.
    pub(super) speed: Vec<f64>,
    /// Load torque or force.
    pub(super) load: Option<Vec<f64>>,
    /// Whether a reference was recorded.
    pub(super) controlled: bool,
}

impl Signals {
    /// Finds the signals of the recording.
    ///
    /// # Errors
    /// There is no u, or nothing that tells the motion.
    pub(crate) fn of(recording: &Recording, input: Option<Input>) -> miette::Result<Self> {
        let u = recording.needed("u").map_err(told)?;
        let values = |name: &str| recording.signal(name).map(|signal| signal.values.clone());
        let (motion, speed) = speed(recording).ok_or_else(|| FirstDriveError::NoMotion {
            file: recording.name.clone(),
            signals: recording.signals.iter().map(|s| s.header()).collect::<Vec<_>>().join(", "),
        })?;
        let i = values("i").or_else(|| values("I_m"));
        let input = match input {
            Some(given) => (given, "as given"),
            None => kind_of_input(&u.unit, motion, i.is_some()),
        };
        Ok(Self {
            name: recording.name.clone(),
            period_s: recording.period_s,
            motion,
            input,
            u: u.values.clone(),
            u_unit: u.unit.clone(),
            i,
            speed,
            load: values("T_l"),
            controlled: recording.signal("reference").is_some(),
        })
    }
}

/// What u is, by its unit and by what else was measured.
fn kind_of_input(unit: &str, motion: Motion, current: bool) -> (Input, &'static str) {
    match (unit, current, motion) {
        ("V", true, _) => (Input::Voltage, "u is in V and the current was recorded"),
        ("V", false, Motion::Rotary) => (Input::Voltage, "u is in V; no current was recorded"),
        ("V", false, Motion::Linear) => (
            Input::Force,
            "a linear axis without a recorded current is most often driven by a current amplifier",
        ),
        _ => (Input::Force, "the unit of u is that of a current, torque or force"),
    }
}

/// The motion and the speed, by what was measured: speed, tachometer, or position.
fn speed(recording: &Recording) -> Option<(Motion, Vec<f64>)> {
    for (name, motion) in [("omega", Motion::Rotary), ("v", Motion::Linear)] {
        if let Some(speed) = recording.signal(name) {
            return Some((motion, speed.values.clone()));
        }
    }
    if let Some(tacho) = recording.signal("T")
        && let Some(unit) = Unit::parse(&tacho.unit)
        && let Some(motion) = match unit.quantity.si() {
            "rad/s" => Some(Motion::Rotary),
            "m/s" => Some(Motion::Linear),
            _ => None,
        }
    {
        return Some((motion, tacho.values.iter().map(|value| unit.to_si(*value)).collect()));
    }
    for (name, motion) in [("theta", Motion::Rotary), ("x", Motion::Linear)] {
        if let Some(position) = recording.signal(name) {
            return Some((motion, slope(&position.values, recording.period_s)));
        }
    }
    None
}

/// Central difference over about 10 ms, one-sided at the ends.
fn slope(position: &[f64], period_s: f64) -> Vec<f64> {
    let reach = ((HALF_DIFFERENCE_S / period_s).round() as usize).max(1);
    let last = position.len().saturating_sub(1);
    let at = |k: usize| {
        let (from, to) = (k.saturating_sub(reach), (k + reach).min(last));
        (position[to] - position[from]) / ((to - from).max(1) as f64 * period_s)
    };
    (0..position.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_recording::Signal;

    fn recording(columns: &[(&str, &str)]) -> Recording {
        let signals = columns.iter().map(|(name, unit)| Signal {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            values: (0..50).map(|k| f64::from(k) * 0.5).collect(),
        });
        Recording { name: "r".into(), start_s: 0.0, period_s: 0.001, signals: signals.collect() }
    }

    #[test]
    fn columns_tell_the_kind_of_drive() {
        for (columns, motion, input) in [
            (&[("u", "V"), ("i", "A"), ("omega", "rad/s")][..], Motion::Rotary, Input::Voltage),
            (&[("u", "V"), ("T", "rpm")], Motion::Rotary, Input::Voltage),
            (&[("u", "V"), ("x", "m")], Motion::Linear, Input::Force),
            (&[("u", "A"), ("theta", "rad")], Motion::Rotary, Input::Force),
        ] {
            let found = Signals::of(&recording(columns), None).expect("it is enough");
            assert_eq!((found.motion, found.input.0), (motion, input), "{columns:?}");
        }
        assert!(Signals::of(&recording(&[("u", "V")]), None).is_err());
        assert!(Signals::of(&recording(&[("omega", "rad/s")]), None).is_err());
    }

    #[test]
    fn a_ramp_has_one_slope() {
        let found = Signals::of(&recording(&[("u", "V"), ("theta", "rad")]), None);
        // Differences of multiples of one half are exact.
        assert!(found.expect("it is enough").speed.iter().all(|w| (w - 500.0).abs() < 1e-9));
    }
}
