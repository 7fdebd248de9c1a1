//! Positions that are read a moment sooner or later than their rows say: by a bus that waits, a loop that
//! polls, a clock that is read elsewhere.
//!
//! What such a position is off by grows with the speed. Differences of high order take the smooth motion out;
//! as far as they are greater where the shaft is fast than where it is slow, the moments are off.

use crate::measured::{Measured, Output};
use crate::noise::{ORDER, difference, of_white_noise};
use crate::rms::rms;

/// Share of the root of the mean square of the speed below which a shaft is slow.
const SLOW: f64 = 0.3;
/// Share of the differences that count, the smallest, and the standard deviations of a normal variable
/// within which as many lie: a spike or a blow is no jitter.
const COUNTED: f64 = 0.95;
const WITHIN: f64 = 1.96;
/// How much greater than of a slow shaft the squares of a fast one are at least: less is chance.
const CLEARLY: f64 = 1.3;
/// Fewest differences, fast or slow, that tell.
const FEWEST: usize = 100;

/// Standard deviation of the moments at which the position was read, s, no more than a sample; 0 where a
/// speed was measured, or too little tells.
pub(crate) fn jitter(measured: &Measured) -> f64 {
    let Some(position) = measured.output(Output::Position) else { return 0.0 };
    let pieces = measured.pieces.iter().map(|piece| &position.values[piece.clone()]);
    let of = |part: &[f64]| {
        let speed = (part[ORDER] - part[0]) / (ORDER as f64 * measured.period_s);
        [speed, difference(part, ORDER).abs()]
    };
    let each = pieces.flat_map(|values| values.windows(ORDER + 1).map(of));
    let all: Vec<[f64; 2]> = each.filter(|[speed, bent]| (speed + bent).is_finite()).collect();
    let usual = rms(all.iter().map(|[speed, _]| *speed));
    // Squares of what positions are off by, and of the speed.
    let squares = |wanted: &dyn Fn(f64) -> bool| {
        let mut some: Vec<[f64; 2]> =
            all.iter().copied().filter(|[speed, _]| wanted(speed.abs())).collect();
        let speed = rms(some.iter().map(|[speed, _]| *speed)).powi(2);
        let place = (COUNTED * some.len() as f64) as usize;
        (some.len() >= FEWEST).then(|| {
            let by_size = |a: &[f64; 2], b: &[f64; 2]| a[1].total_cmp(&b[1]);
            let [_, bent] = *some.select_nth_unstable_by(place, by_size).1;
            [(bent / WITHIN).powi(2) / of_white_noise(), speed]
        })
    };
    let both = squares(&|speed| speed > usual).zip(squares(&|speed| speed < SLOW * usual));
    let grows = both.filter(|([fast, _], [slow, _])| *fast > CLEARLY * slow);
    grows.map_or(0.0, |([fast, speed], [slow, slow_speed])| {
        ((fast - slow) / (speed - slow_speed)).sqrt().min(measured.period_s)
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use drivescope_plant::drive::Drive;
    use drivescope_recording::{Recording, Signal};

    use super::*;
    use crate::testing::gaussian;

    const DRIVE: &str = "schema = 1\nname = \"joint\"\n[motor]\ninput = \"force\"\nK_m = 0.05\n\
                         J = 1.0e-4\nB_m = 1.0e-3\n";

    #[test]
    fn moments_that_are_off_are_told_from_a_sensor_that_is_and_from_a_fast_motion() {
        let (period_s, count) = (0.002, 8000);
        let drive = Drive::parse(DRIVE, "joint.toml").expect("right");
        let [early, noise] = [1, 2].map(|seed| gaussian(count, seed));
        let found = |hz: f64, off_s: f64, off: f64| {
            let angle = |time: f64| 2.0 * (TAU * hz * time).sin();
            let at = |k: usize| angle(k as f64 * period_s + off_s * early[k]) + off * noise[k];
            let signal = |name: &str, unit: &str, values: Vec<f64>| Signal {
                name: name.to_owned(),
                unit: unit.to_owned(),
                values,
            };
            let signals = vec![
                signal("u", "A", noise.clone()),
                signal("theta", "rad", (0..count).map(at).collect()),
            ];
            let recording = Recording::new("joint", 0.0, period_s, signals);
            jitter(&Measured::new(&drive, &recording).expect("usable"))
        };
        let told = found(0.5, 1e-4, 1e-4);
        assert!((told / 1e-4 - 1.0).abs() < 0.15, "{told}");
        assert_eq!([found(0.5, 0.0, 1e-3), found(5.0, 0.0, 1e-5)], [0.0; 2]);
    }
}
