//! How well each output is followed, as a person knows it: in per cent.

use std::collections::BTreeMap;

use drivescope_plant::drive::Drive;

use super::{Evidence, Fit, with_own};
use crate::case::Setting;

/// Fit of each output, by its name, %: 100 (1 - |y - y_model| / |y - mean y|), the mean that of each
/// recording; none where the output is constant, -inf where the model overflowed.
pub type OutputFits = BTreeMap<&'static str, Option<f64>>;

/// The fit of a root mean square error of an output with that standard deviation, %; none of an
/// output that is constant.
pub(crate) fn fit_percent(rms: f64, swing: f64) -> Option<f64> {
    (swing > 0.0).then(|| 100.0 * (1.0 - rms / swing))
}

/// How well a drive follows all recordings together, run freely or with the setting's observer;
/// `fits` is what belongs to each recording.
pub fn output_fits(
    drive: &Drive,
    evidence: &Evidence,
    setting: &Setting,
    fits: &[Fit],
) -> OutputFits {
    let mut squares: BTreeMap<&'static str, [f64; 2]> = BTreeMap::new();
    for (place, (measured, fit)) in evidence.recordings.iter().zip(fits).enumerate() {
        let drive = &with_own(drive, fit);
        let shown = evidence.case(place, drive, &fit.starts, setting).trajectory();
        for channel in &measured.outputs {
            let [error, swing] = squares.entry(channel.name).or_default();
            let known = || channel.values.iter().filter(|y| y.is_finite());
            let mean = known().sum::<f64>() / known().count().max(1) as f64;
            let model = &shown[channel.output as usize];
            for piece in measured.pieces.iter().cloned() {
                for k in piece.filter(|k| channel.values[*k].is_finite()) {
                    let r = channel.values[k] - model[k];
                    // What overflowed is not followed at all.
                    *error += if r.is_finite() { r * r } else { f64::INFINITY };
                    *swing += (channel.values[k] - mean).powi(2);
                }
            }
        }
    }
    let of = |[error, swing]: [f64; 2]| fit_percent(error.sqrt(), swing.sqrt());
    squares.into_iter().map(|(name, both)| (name, of(both))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::evaluate;
    use crate::observer::Observer;
    use crate::testing::{bench, dr300};
    use crate::{Measured, case::Squares};

    /// The fit in per cent is the root mean square error over the swing, whatever the recordings.
    #[test]
    fn a_perfect_model_has_a_hundred_and_a_wrong_one_what_its_error_says() {
        let mut drive = dr300();
        drive.motor.tie_k = false;
        let measured = Measured::new(&drive, &bench(&drive, 4.0, 0.001)).expect("it can be used");
        let evidence = Evidence {
            noise: vec![vec![1e-3; measured.outputs.len()]],
            recordings: vec![measured],
        };
        let setting = Setting::new(&drive, Observer::NONE);
        let of = |drive: &Drive| {
            let judged = evaluate(drive, &evidence, &setting, false).expect("it can be judged");
            (output_fits(drive, &evidence, &setting, &judged.recordings), judged.squares)
        };
        let (fits, _) = of(&drive);
        assert!(fits.values().all(|it| it.expect("it moves") > 99.9), "{fits:?}");
        drive.motor.k_m *= 1.2;
        let (fits, squares) = of(&drive);
        // From the fits back to the squares: each output's error is (1 - fit) of its swing.
        let channels = &evidence.recordings[0].outputs;
        let mut sum = 0.0;
        for channel in channels {
            let count = channel.values.len() as f64;
            let mean = channel.values.iter().sum::<f64>() / count;
            let swing: f64 = channel.values.iter().map(|y| (y - mean).powi(2)).sum();
            let missed = 1.0 - fits[channel.name].expect("it moves") / 100.0;
            assert!(missed > 0.01, "{} does not show it: {missed}", channel.name);
            sum += missed.powi(2) * swing / 1e-6;
        }
        let Squares { sum: all, .. } = squares;
        assert!((sum / all - 1.0).abs() < 1e-9, "{sum} {all}");
    }
}
