//! What drives and the motion, averaged over equal windows.

use crate::measured::{Channel, Measured, Output, bridged};

/// Windows that a relation needs at least.
const LEAST: usize = 40;

/// A recording over equal windows, one value a window.
pub(super) struct Averaged {
    /// Length of a window, s.
    pub(super) window_s: f64,
    pub(super) driver: Vec<f64>,
    pub(super) load: Option<Vec<f64>>,
    /// Where it was measured beside a voltage.
    pub(super) current: Option<Vec<f64>>,
    pub(super) speed: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    pub(super) angle: Vec<f64>,
}

impl Averaged {
    /// Over at most so many windows; none if no motion was measured or there are too few.
    pub(super) fn of(measured: &Measured, most: usize) -> Option<Self> {
        let samples: usize = measured.pieces.iter().map(|piece| piece.len()).sum();
        let length = samples.div_ceil(most);
        let window_s = length as f64 * measured.period_s;
        let shown = |output| measured.output(output).map(|it: &Channel| bridged(&it.values));
        let position = shown(Output::Position);
        let speed = match (shown(Output::Speed), &position) {
            (Some(speed), _) => speed,
            (None, Some(position)) => differences(measured, position),
            (None, None) => return None,
        };
        let angle = measured.angle.as_ref().or(position.as_ref())?;
        let means = |values: &[f64]| -> Vec<f64> {
            let of = |piece: &std::ops::Range<usize>| {
                values[piece.clone()]
                    .chunks_exact(length)
                    .map(|some| some.iter().sum::<f64>() / length as f64)
                    .collect::<Vec<_>>()
            };
            measured.pieces.iter().flat_map(of).collect()
        };
        let slow = means(&speed);
        let mut acceleration = Vec::with_capacity(slow.len());
        for piece in &measured.pieces {
            let from = acceleration.len();
            let count = piece.len() / length;
            acceleration.extend(slopes(&slow[from..from + count], window_s));
        }
        (slow.len() >= LEAST).then(|| Self {
            window_s,
            driver: means(&measured.u),
            load: measured.load.as_ref().map(|load| means(load)),
            current: shown(Output::Current).map(|current| means(&current)),
            speed: slow,
            acceleration,
            angle: means(angle),
        })
    }

    /// The greatest speed but for a few windows.
    pub(super) fn greatest_speed(&self) -> f64 {
        let mut all: Vec<f64> = self.speed.iter().map(|speed| speed.abs()).collect();
        let at = all.len() - 1 - all.len() / 50;
        *all.select_nth_unstable_by(at, f64::total_cmp).1
    }
}

/// Speed from the position, piece by piece.
fn differences(measured: &Measured, position: &[f64]) -> Vec<f64> {
    let mut speed = vec![0.0; position.len()];
    for piece in &measured.pieces {
        let slopes = slopes(&position[piece.clone()], measured.period_s);
        speed[piece.clone()].copy_from_slice(&slopes);
    }
    speed
}

/// Central differences over that step; one-sided at the ends.
fn slopes(values: &[f64], step: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slope = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        match after - before {
            0 => 0.0,
            apart => (values[after] - values[before]) / (apart as f64 * step),
        }
    };
    (0..values.len()).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300};

    #[test]
    fn speed_and_position_tell_the_same_motion() {
        let drive = dr300();
        let mut recording = bench(&drive, 2.0, 0.001);
        let by_speed = Measured::new(&drive, &recording).expect("usable");
        recording.signals.retain(|it| it.name != "omega");
        let by_angle = Measured::new(&drive, &recording).expect("usable");
        let [a, b] = [by_speed, by_angle].map(|it| Averaged::of(&it, 400).expect("it moves"));
        assert_eq!((a.window_s, a.speed.len()), (0.005, 400));
        let greatest = a.greatest_speed();
        for (a, b) in a.speed.iter().zip(&b.speed) {
            assert!((a - b).abs() < 0.02 * greatest, "{a} {b}");
        }
        assert!(a.acceleration.iter().any(|a| a.abs() > greatest));
    }
}
