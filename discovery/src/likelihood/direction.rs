//! In which direction a shaft moves at each sample, as its sensors show it.
//!
//! Dry friction enters the filter with this sign. Were it that of the model, a friction that is a
//! little too large would hold a shaft that in truth moves, and the likelihood would jump with
//! every such event; with the sign of what was measured it is smooth in all parameters.

use std::ops::Range;

use super::state::SENSORS;
use crate::measured::{Measured, Output};

/// Standard deviations of the smoothed speed below which a shaft may stand still.
const STANDS: f64 = 3.0;
/// Samples on either side of which a speed is the mean; of differences of a position at most so
/// many, s.
const SMOOTHED: usize = 2;
const LONGEST_S: f64 = 0.025;
/// Standard deviation of the smoothed speed over the fastest that is wanted of a position.
const FINE: f64 = 2e-3;

/// Share of the fastest speed below which dry friction is not what its law says: bristles bend.
const SLOW: f64 = 5e-3;

/// Factor on the change of speed that was measured there, which makes the model's own worth nothing.
const LOOSE: f64 = 10.0;

/// Signs of the motion. Where the shaft rests or turns round, dry friction is whatever it takes, and
/// the balance of torques tells nothing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Direction {
    /// 0 where the shaft may rest or turns round.
    signs: Vec<f64>,
    /// By how much the speed may change there over a sample, rad/s (m/s); 0 elsewhere.
    loose: Vec<f64>,
}

impl Direction {
    /// Along a recording whose sensors have that noise.
    pub(super) fn of(measured: &Measured, noise: &[f64; SENSORS]) -> Self {
        let shown = |output| measured.output(output).map(|channel| &channel.values);
        match (shown(Output::Speed), shown(Output::Position)) {
            (Some(speed), _) => Self::of_speeds(measured, speed, noise[Output::Speed as usize]),
            (None, Some(x)) => {
                let (speeds, sd) = slopes(measured, x, noise[Output::Position as usize]);
                Self::of_smooth(measured, &speeds, sd)
            }
            (None, None) => {
                Self { signs: vec![1.0; measured.len()], loose: vec![0.0; measured.len()] }
            }
        }
    }

    /// Of speeds with that standard deviation.
    pub(super) fn of_speeds(measured: &Measured, speeds: &[f64], sd: f64) -> Self {
        let (speeds, sd) = means(measured, speeds, sd);
        Self::of_smooth(measured, &speeds, sd)
    }

    fn of_smooth(measured: &Measured, speeds: &[f64], sd: f64) -> Self {
        let level = (STANDS * sd).max(SLOW * fastest(speeds));
        let (mut signs, mut loose) = (vec![1.0; speeds.len()], vec![0.0; speeds.len()]);
        for piece in &measured.pieces {
            for k in piece.clone() {
                let (from, to) = (k.saturating_sub(1).max(piece.start), (k + 2).min(piece.end));
                let near = &speeds[from..to];
                let turns = near.iter().any(|it| it.signum() != speeds[k].signum());
                if turns || near.iter().any(|it| it.abs() <= level) {
                    signs[k] = 0.0;
                    let apart = near.iter().map(|it| (it - speeds[k]).abs());
                    loose[k] = LOOSE * apart.fold(level, f64::max);
                } else {
                    signs[k] = speeds[k].signum();
                }
            }
        }
        Self { signs, loose }
    }

    /// In those samples alone.
    pub(super) fn part(&self, range: Range<usize>) -> Self {
        Self { signs: self.signs[range.clone()].to_vec(), loose: self.loose[range].to_vec() }
    }

    pub(crate) fn at(&self, sample: usize) -> f64 {
        self.signs[sample]
    }

    pub(super) fn loose(&self, sample: usize) -> f64 {
        self.loose[sample]
    }
}

fn fastest(speeds: &[f64]) -> f64 {
    speeds.iter().fold(0.0_f64, |most, it| most.max(it.abs()))
}

/// Means over neighbours within each piece, and their standard deviation.
fn means(measured: &Measured, values: &[f64], sd: f64) -> (Vec<f64>, f64) {
    let mut smooth = values.to_vec();
    for piece in &measured.pieces {
        for k in piece.clone() {
            let from = k.saturating_sub(SMOOTHED).max(piece.start);
            let window = &values[from..(k + SMOOTHED + 1).min(piece.end)];
            let finite = || window.iter().filter(|value| value.is_finite());
            smooth[k] = finite().sum::<f64>() / finite().count().max(1) as f64;
        }
    }
    (smooth, sd / ((2 * SMOOTHED + 1) as f64).sqrt())
}

/// Slopes of a position over as many samples as its noise needs, and their standard deviation.
fn slopes(measured: &Measured, x: &[f64], sd: f64) -> (Vec<f64>, f64) {
    let period = measured.period_s;
    let over = |reach: usize| {
        let mut speeds = vec![0.0; x.len()];
        for piece in &measured.pieces {
            for k in piece.clone() {
                let from = k.saturating_sub(reach).max(piece.start);
                let to = (k + reach).min(piece.end - 1);
                let slope = (x[to] - x[from]) / ((to - from).max(1) as f64 * period);
                speeds[k] = if slope.is_finite() { slope } else { 0.0 };
            }
        }
        (speeds, 2.0_f64.sqrt() * sd / (2.0 * reach as f64 * period))
    };
    let longest = ((LONGEST_S / period) as usize).max(1);
    let mut reach = 1;
    loop {
        let (speeds, sd) = over(reach);
        if reach >= longest || sd <= FINE * fastest(&speeds) {
            return (speeds, sd);
        }
        reach = (2 * reach).min(longest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    #[test]
    fn friction_is_not_judged_where_the_shaft_rests_or_turns_round() {
        let drive = dr300();
        let recording = noisy(bench(&drive, 2.0, 0.001), [0.01, 0.3], 7);
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let direction = Direction::of(&measured, &[0.01, 0.3, 1.0]);
        let speed = &measured.output(Output::Speed).expect("it was measured").values;
        let fastest = fastest(speed);
        let (mut moving, mut turning) = (0, 0);
        for (k, omega) in speed.iter().enumerate() {
            let sign = direction.at(k);
            if omega.abs() > 0.1 * fastest {
                assert!(sign == 0.0 || sign == omega.signum(), "sample {k}: {omega} and {sign}");
                moving += usize::from(sign != 0.0);
            }
            if omega.abs() < 1e-3 * fastest {
                assert_eq!(sign, 0.0, "sample {k}: {omega}");
                turning += 1;
            }
            assert_eq!(direction.loose(k) > 0.0, sign == 0.0);
        }
        assert!(moving > speed.len() / 2 && turning > 0, "{moving} {turning}");
    }
}
