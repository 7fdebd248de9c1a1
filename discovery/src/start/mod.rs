//! The state in which each piece of a recording begins: guessed by [`first`], then estimated.
//!
//! A moving shaft may have twisted its coupling, and a winding may be warm: those own states of
//! effects begin where the sensors of load and winding show them, and are estimated. The others
//! (the bristles of presliding, the lag of a sensor) forget their beginning within milliseconds,
//! and begin at zero.

mod first;

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::info::Beside;
use serde::Serialize;

pub use first::first_starts;

use crate::measured::{Measured, OUTPUTS, Output};

/// How many numbers a start has: one an output, and three own states.
pub(crate) const STARTS: usize = OUTPUTS + OWN_STATES.len();
/// Places in [`Start::values`] of the own states of effects, by the sensor that tells of them.
pub(crate) const OWN_STATES: [(Beside, usize); 3] = [
    (Beside::LoadPosition, OUTPUTS),
    (Beside::LoadSpeed, OUTPUTS + 1),
    (Beside::Temperature, OUTPUTS + 2),
];

/// State at the beginning of a piece of a recording, and what sensors beside those of the motor
/// count from; what the drive does not have is 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Start {
    /// Armature current, A.
    pub current: f64,
    /// Speed, rad/s (m/s); exactly 0 where the shaft is at rest.
    pub speed: f64,
    /// Position, rad (m).
    pub position: f64,
    /// What a position of the load is counted from, rad (m).
    pub load_zero: f64,
    /// Temperature of the surroundings, in the unit of the sensor.
    pub surroundings: f64,
    /// Twist of a coupling, rad (m).
    pub twist: f64,
    /// Speed of the motor less that of the load, rad/s (m/s).
    pub slip: f64,
    /// Temperature of the winding above the surroundings, K.
    pub warmth: f64,
}

impl Start {
    /// A cold shaft at rest without current.
    pub const REST: Self = Self {
        current: 0.0,
        speed: 0.0,
        position: 0.0,
        load_zero: 0.0,
        surroundings: 0.0,
        twist: 0.0,
        slip: 0.0,
        warmth: 0.0,
    };

    /// Its numbers: in the order of [`Output`] a state, or what a sensor counts from; then the own
    /// states of effects.
    pub(crate) fn values(&self) -> [f64; STARTS] {
        let Self { current, speed, position, load_zero, surroundings, twist, slip, warmth } = *self;
        [current, speed, position, 0.0, load_zero, surroundings, twist, slip, warmth]
    }

    /// Places in [`Self::values`] of what is unknown: a shaft at rest has no speed to estimate and
    /// its coupling no twist, unless it is seen; a position or a temperature matters where it is measured. The
    /// resistance is that at the beginning of the recording, piece 0, where nothing shows how warm
    /// the winding is.
    pub(crate) fn free_states(
        &self,
        drive: &Drive,
        measured: &Measured,
        piece: usize,
    ) -> Vec<usize> {
        let current = (drive.motor.input == Input::Voltage).then_some(Output::Current);
        let speed = (self.speed != 0.0).then_some(Output::Speed);
        let shown = [Output::Position, Output::LoadPosition, Output::Temperature].into_iter();
        let shown = shown.filter(|output| measured.output(*output).is_some());
        let model = drive.model();
        // Exactly 0 where nothing moves.
        let moves = [self.speed, self.twist, self.slip].iter().any(|it| *it != 0.0);
        let is_shown = measured.output(Output::Temperature).is_some();
        let own = OWN_STATES.into_iter().filter(|(sensor, _)| {
            model.has(*sensor)
                && match sensor {
                    Beside::LoadPosition | Beside::LoadSpeed => moves,
                    Beside::Temperature => is_shown || piece > 0,
                }
        });
        let outputs = current.into_iter().chain(speed).chain(shown).map(|output| output as usize);
        outputs.chain(own.map(|(_, number)| number)).collect()
    }

    /// The same with another value at that place.
    #[must_use]
    pub fn with(self, place: usize, value: f64) -> Self {
        match place {
            0 => Self { current: value, ..self },
            1 => Self { speed: value, ..self },
            2 => Self { position: value, ..self },
            4 => Self { load_zero: value, ..self },
            5 => Self { surroundings: value, ..self },
            6 => Self { twist: value, ..self },
            7 => Self { slip: value, ..self },
            8 => Self { warmth: value, ..self },
            _ => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::beside::tests::{SDS, coupled, heating};
    use crate::{Evidence, Measured, Observer, Setting, evaluate};

    /// Standard deviations of the noise that a start may be off.
    const OFF: f64 = 4.0;
    /// Most of an error that is noise alone.
    const NOISE: f64 = 1.03;

    #[test]
    fn a_recording_begun_in_motion_finds_its_coupling_twisted() {
        let (drive, recording) = coupled();
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let setting = Setting::new(&drive, Observer::NONE);
        // The motor is held by friction and the load swings; it turns; it has just been reversed.
        for from in [780, 1030, 1260] {
            let part = measured.part(from..2000).expect("long enough");
            let evidence = Evidence { recordings: vec![part], noise: vec![SDS.to_vec()] };
            let found = evaluate(&drive, &evidence, &setting, false).expect("it runs");
            let start = found.recordings[0].starts[0];
            assert!(found.squares.error() < NOISE, "{from}: {} {start:?}", found.squares.error());
            assert!(start.slip.abs() > 0.5, "{from}: {start:?}");
            assert!((start.load_zero - 3.0).abs() < 1e-3, "{from}: {start:?}");
        }
    }

    #[test]
    fn a_winding_begins_as_warm_as_it_was_measured() {
        let (drive, mut recording) = heating(4.0);
        recording.signals[0].values[2500..2510].fill(f64::NAN);
        let warm = recording.signal("temperature").expect("it is there").values[2510] - 293.0;
        assert!(warm > 5.0, "{warm}");
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let noise = vec![vec![0.01, 0.3, 0.1]];
        let evidence = Evidence { recordings: vec![measured], noise };
        let setting = Setting::new(&drive, Observer::NONE);
        let found = evaluate(&drive, &evidence, &setting, false).expect("it runs");
        assert!(found.squares.error() < NOISE, "{}", found.squares.error());
        let [cold, hot] = found.recordings[0].starts[..] else { panic!("two pieces") };
        assert!(cold.warmth.abs() < 1.0, "{cold:?}");
        let shown = hot.warmth + hot.surroundings - 293.0;
        assert!((shown - warm).abs() < OFF * 0.1, "{hot:?}, measured {warm}");
        assert!((hot.warmth - warm).abs() < 1.0, "{hot:?}, measured {warm}");
    }
}
