//! The state in which each piece of a recording begins: a first guess, to be estimated on.
//!
//! Candidates are rest, the first samples themselves, and a straight line through the first few
//! (it averages the noise). The one from which the model follows the beginning best is taken;
//! rest unless another is clearly better, for most recordings begin there and a shaft at rest has
//! no speed to estimate.

use drivescope_numerics::Regression;
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::info::Beside;
use serde::Serialize;

use crate::case::{Case, Setting};
use crate::measured::{Measured, OUTPUTS, Output, SHORTEST_PIECE};

/// Samples that a line goes through.
const LINE: usize = 10;
/// Gain in squared errors (in units of the noise) that a moving start must bring: three
/// standard deviations of one value.
const CLEARLY: f64 = 9.0;

/// State at the beginning of a piece of a recording, and what sensors beside those of the motor
/// count from; what the drive does not have is 0, and own states of effects begin at 0.
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
}

/// The first guess for each piece.
pub fn first_starts(
    drive: &Drive,
    measured: &Measured,
    noise: &[f64],
    setting: &Setting,
) -> Vec<Start> {
    let of = |piece: &std::ops::Range<usize>| {
        let head = measured.part(piece.start..piece.start + SHORTEST_PIECE);
        // Pieces have at least that many samples.
        head.map_or(Start::REST, |head| best(drive, &head, noise, setting))
    };
    measured.pieces.iter().map(of).collect()
}

fn best(drive: &Drive, head: &Measured, noise: &[f64], setting: &Setting) -> Start {
    let misfit = |start: &Start| {
        let starts = &[*start];
        Case { drive, measured: head, noise, starts, setting }.squares().sum
    };
    let [rest, others @ ..] = candidates(drive, head);
    let (mut start, mut least) = (rest, misfit(&rest) - CLEARLY);
    for other in others {
        let misfit = misfit(&other);
        if misfit < least {
            (start, least) = (other, misfit);
        }
    }
    start
}

/// Rest, the first samples, and the line through the first few.
fn candidates(drive: &Drive, head: &Measured) -> [Start; 3] {
    let lines = [Output::Current, Output::Speed, Output::Position].map(|output| {
        let values = &head.output(output)?.values;
        line(&values[..LINE.min(values.len())])
    });
    let first = [Output::Current, Output::Speed, Output::Position].map(|output| {
        head.output(output)?.values.first().copied().filter(|value| value.is_finite())
    });
    // A position alone gives the speed by its slope.
    let slope = lines[2].map_or(0.0, |(_, slope)| slope / head.period_s);
    let position = first[2].or(lines[2].map(|line| line.0)).unwrap_or(0.0);
    let start = |current: Option<f64>, speed: f64, position: f64| Start {
        current: match drive.motor.input {
            Input::Voltage => current.unwrap_or_else(|| steady_current(drive, head.u[0], speed)),
            Input::Force => 0.0,
        },
        speed,
        position,
        load_zero: zero(head, Beside::LoadPosition),
        surroundings: zero(head, Beside::Temperature),
    };
    let by_line = start(
        lines[0].map(|line| line.0),
        lines[1].map_or(slope, |line| line.0),
        lines[2].map_or(position, |line| line.0),
    );
    let by_first = start(first[0], first[1].unwrap_or(slope), position);
    [start(first[0].or(Some(0.0)), 0.0, position), by_first, by_line]
}

/// What such a sensor counts from: the mean of what it shows more than the motor's own at the
/// beginning, or than a cold winding; 0 where it was not measured.
fn zero(head: &Measured, sensor: Beside) -> f64 {
    let Some(channel) = head.output(sensor.into()) else { return 0.0 };
    let of_motor = |k| if sensor == Beside::Temperature { 0.0 } else { head.of_motor(sensor, k) };
    let beyond = channel.values.iter().enumerate().map(|(k, y)| y - of_motor(k));
    let known: Vec<f64> = beyond.take(LINE).filter(|it| it.is_finite()).collect();
    known.iter().sum::<f64>() / known.len().max(1) as f64
}

/// The current of (20) in steady state; a resting shaft has none for certain.
fn steady_current(drive: &Drive, u: f64, speed: f64) -> f64 {
    match (drive.motor.k_e, drive.motor.r) {
        (Some(k_e), Some(r)) if speed != 0.0 => (u - k_e * speed) / r,
        _ => 0.0,
    }
}

/// Value and change a sample of the line through these values, at the first; none if fewer than
/// three are there.
fn line(values: &[f64]) -> Option<(f64, f64)> {
    let mut regression = Regression::new(2);
    for (k, value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        regression.push([1.0, k as f64], *value);
    }
    let fit = (regression.rows() > 2).then(|| regression.solve().ok())??;
    Some((fit.parameters[0], fit.parameters[1]))
}

impl Start {
    /// A shaft at rest without current.
    pub const REST: Self =
        Self { current: 0.0, speed: 0.0, position: 0.0, load_zero: 0.0, surroundings: 0.0 };

    /// Its numbers in the order of [`Output`]: a state, or what a sensor counts from.
    pub fn values(&self) -> [f64; OUTPUTS] {
        [self.current, self.speed, self.position, 0.0, self.load_zero, self.surroundings]
    }

    /// Places in [`Self::values`] of what is unknown: a shaft at rest has no speed to estimate,
    /// and a position or a temperature matters where it is measured.
    pub(crate) fn free_states(&self, drive: &Drive, measured: &Measured) -> Vec<usize> {
        let current = (drive.motor.input == Input::Voltage).then_some(Output::Current);
        let speed = (self.speed != 0.0).then_some(Output::Speed);
        let shown = [Output::Position, Output::LoadPosition, Output::Temperature].into_iter();
        let shown = shown.filter(|output| measured.output(*output).is_some());
        current.into_iter().chain(speed).chain(shown).map(|output| output as usize).collect()
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
            _ => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Observer;
    use crate::testing::{bench, dr300, gaussian};

    /// Standard deviations of the noise that a guess may be off.
    const OFF: f64 = 4.0;

    #[test]
    fn rest_stays_rest_and_motion_is_seen() {
        let drive = dr300();
        let mut recording = bench(&drive, 2.0, 0.001);
        let truth = recording.clone();
        for (signal, sd) in [(1, 0.01), (2, 0.3)] {
            let noise = gaussian(recording.signals[signal].values.len(), signal as u64);
            for (value, noise) in recording.signals[signal].values.iter_mut().zip(noise) {
                *value += sd * noise;
            }
        }
        recording.signals[0].values[700..710].fill(f64::NAN);
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let setting = Setting::new(&drive, Observer::NONE);
        let [rest, moving] = first_starts(&drive, &measured, &[0.01, 0.3], &setting)[..] else {
            panic!("two pieces");
        };
        assert_eq!(rest.speed, 0.0);
        let [i, omega] = [1, 2].map(|signal| truth.signals[signal].values[710]);
        assert!((moving.current - i).abs() < OFF * 0.01, "{moving:?} against {i}");
        assert!((moving.speed - omega).abs() < OFF * 0.3, "{moving:?} against {omega}");
    }

    #[test]
    fn a_position_alone_gives_the_speed() {
        let drive = dr300();
        let mut recording = bench(&drive, 2.0, 0.001);
        let omega = recording.signal("omega").expect("it is there").values[740];
        recording.signals.retain(|signal| ["u", "theta"].contains(&signal.name.as_str()));
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let part = measured.part(740..1040).expect("long enough");
        let setting = Setting::new(&drive, Observer::usual(std::slice::from_ref(&part)));
        let start = first_starts(&drive, &part, &[1e-3], &setting)[0];
        assert!((start.speed / omega - 1.0).abs() < 0.05, "{start:?} against {omega}");
        assert_eq!(start.with(1, 7.0).values()[1], 7.0);
    }
}
