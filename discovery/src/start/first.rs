//! The first guess of the state in which each piece of a recording begins.
//!
//! Candidates are rest, the first samples themselves, and a straight line through the first few
//! (it averages the noise). The one from which the model follows the beginning best is taken;
//! rest unless another is clearly better, for most recordings begin there and a shaft at rest has
//! no speed to estimate.

use std::ops::Range;

use drivescope_numerics::Regression;
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::info::Beside;

use super::Start;
use crate::case::{Case, Setting};
use crate::measured::{Measured, Output, SHORTEST_PIECE};

/// Samples that a line goes through.
const LINE: usize = 10;
/// Gain in squared errors (in units of the noise) that a moving start must bring: three
/// standard deviations of one value.
const CLEARLY: f64 = 9.0;

/// The first guess for each piece.
pub fn first_starts(
    drive: &Drive,
    measured: &Measured,
    noise: &[f64],
    setting: &Setting,
) -> Vec<Start> {
    let of = |piece: &Range<usize>| {
        let head = measured.part(piece.start..piece.start + SHORTEST_PIECE);
        // Pieces have at least that many samples.
        let all = zero(measured, piece.clone(), Beside::LoadPosition);
        head.map_or(Start::REST, |head| best((drive, noise, setting), &head, all))
    };
    let mut starts: Vec<Start> = measured.pieces.iter().map(of).collect();
    if drive.model().has(Beside::Temperature) {
        // The coldest beginning is taken for that of a winding as warm as its surroundings.
        let coldest = starts.iter().map(|it| it.surroundings).fold(f64::INFINITY, f64::min);
        for start in &mut starts {
            start.warmth = start.surroundings - coldest;
            start.surroundings = coldest;
        }
    }
    starts
}

/// The best candidate for a piece that begins with `head`, on the whole of which the load's
/// position counts from about `load_zero`.
fn best(
    (drive, noise, setting): (&Drive, &[f64], &Setting),
    head: &Measured,
    load_zero: f64,
) -> Start {
    let misfit = |start: &Start| {
        let starts = &[*start];
        Case { drive, measured: head, noise, starts, setting }.squares().sum
    };
    let [rest, others @ ..] = candidates(drive, head, load_zero);
    let (mut start, mut least) = (rest, misfit(&rest) - CLEARLY);
    for other in others {
        let misfit = misfit(&other);
        if misfit < least {
            (start, least) = (other, misfit);
        }
    }
    start
}

/// Rest, a motor at rest on a twisted coupling, the first samples, and the line through the first
/// few.
fn candidates(drive: &Drive, head: &Measured, load_zero: f64) -> [Start; 4] {
    // At its beginning alone a twist cannot be told from the zero: it swings about none.
    let zero_now = zero(head, 0..LINE, Beside::LoadPosition);
    let may_twist = drive.model().has(Beside::LoadPosition);
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
        load_zero: zero_now,
        surroundings: zero(head, 0..LINE, Beside::Temperature),
        ..Start::REST
    };
    let twisted = |start: Start| match may_twist {
        true => {
            Start { load_zero, twist: load_zero - zero_now, slip: slip(head, start.speed), ..start }
        }
        false => start,
    };
    let by_line = start(
        lines[0].map(|line| line.0),
        lines[1].map_or(slope, |line| line.0),
        lines[2].map_or(position, |line| line.0),
    );
    let by_first = start(first[0], first[1].unwrap_or(slope), position);
    let rest = start(first[0].or(Some(0.0)), 0.0, position);
    [rest, twisted(rest), twisted(by_first), twisted(by_line)]
}

/// Speed of the motor less that of the load, which its own sensors show; 0 where none does.
fn slip(head: &Measured, speed: f64) -> f64 {
    let line_of = |output| {
        let values = &head.output(output)?.values;
        line(&values[..LINE.min(values.len())])
    };
    let of_load = line_of(Output::LoadSpeed).map(|line| line.0);
    let of_load = of_load.or_else(|| Some(line_of(Output::LoadPosition)?.1 / head.period_s));
    of_load.map_or(0.0, |of_load| speed - of_load)
}

/// What such a sensor counts from: the mean of what it shows more than the motor's own over those
/// samples, or than a cold winding; 0 where it was not measured.
fn zero(measured: &Measured, samples: Range<usize>, sensor: Beside) -> f64 {
    let Some(channel) = measured.output(sensor.into()) else { return 0.0 };
    let beyond = samples.map(|k| match sensor {
        Beside::Temperature => channel.values[k],
        _ => channel.values[k] - measured.of_motor(sensor, k),
    });
    let known: Vec<f64> = beyond.filter(|it| it.is_finite()).collect();
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
