//! The model driven by a recording: the recorded u, and T_l where there is one, held between
//! samples; the answer is what ideal sensors would show on the recording's own time axis.

use drivescope_discovery::driving;
use drivescope_plant::drive::Drive;
use drivescope_plant::unit::Unit;
use drivescope_recording::{Recording, Signal};
use indicatif::ProgressBar;

use super::start::{FIRST, Start};
use super::{SAMPLES_A_LOOK, column, has_current, place, position, shaft_states, speed};
use crate::failure::into_report;
use crate::interrupt;

/// How well the model reproduces a measured signal.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct Fit {
    pub(crate) signal: String,
    /// 100 (1 - |y - y_model| / |y - mean(y)|), %; none for a constant signal.
    pub(crate) percent: Option<f64>,
    /// Root of the mean squared difference, in the signal's unit.
    pub(crate) rms: f64,
    pub(crate) unit: String,
}

/// The candidate from which the model follows the first samples best, each signal measured by
/// its swing over the recording.
///
/// # Errors
/// As [`replay`].
pub(crate) fn start(drive: &Drive, measured: &Recording) -> miette::Result<Start> {
    let head = |signal: &Signal| Signal {
        values: signal.values[..signal.values.len().min(FIRST)].to_vec(),
        ..signal.clone()
    };
    let signals = measured.signals.iter().map(head).collect();
    let first = Recording::new(measured.name.clone(), measured.start_s, measured.period_s, signals);
    let mut best = None;
    for start in Start::candidates(drive, measured) {
        let model = replay(drive, &first, start, &ProgressBar::hidden())?;
        let misfit: f64 = fits(&first, &model)
            .iter()
            .filter_map(|fit| Some(fit.rms / swing(&measured.signal(&fit.signal)?.values)))
            .filter(|misfit| misfit.is_finite())
            .sum();
        if best.is_none_or(|(least, _)| misfit < least) {
            best = Some((misfit, start));
        }
    }
    let (_, start) = best.expect("there are candidates");
    Ok(start)
}

/// Standard deviation of the samples there are, or 1 for a constant signal.
fn swing(values: &[f64]) -> f64 {
    let values: Vec<f64> = values.iter().copied().filter(|y| y.is_finite()).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n;
    if variance > 0.0 { variance.sqrt() } else { 1.0 }
}

/// Drives the model by the recording from that start.
///
/// # Errors
/// The user stopped it, or the state overflowed.
pub(crate) fn replay(
    drive: &Drive,
    measured: &Recording,
    start: Start,
    progress: &ProgressBar,
) -> miette::Result<Recording> {
    let u = driving(drive, measured).map_err(into_report)?.1;
    let load = measured.signal("T_l");
    let mut unit = Unit::new(drive.clone(), true);
    let [at_u, at_load] = ["u", "T_l"].map(|name| place(&unit, name));
    let shown = [
        has_current(drive).then(|| ("i", "A".to_owned())),
        Some(speed(drive)),
        Some(position(drive)),
    ];
    let mut columns: Vec<(usize, Signal)> = shown
        .into_iter()
        .flatten()
        .map(|(name, of)| (place(&unit, name), column(name, of, measured.len())))
        .collect();
    let overflow = |error: drivescope_plant::unit::UnitError| miette::miette!("{error}");
    let [speed_state, position_state] = shaft_states(drive);
    for (name, value) in [
        ("armature.i", start.current),
        (speed_state.as_str(), start.speed),
        (position_state.as_str(), start.position),
    ] {
        let at = place(&unit, name);
        unit.set(at, value).map_err(overflow)?;
    }
    unit.initialize(measured.start_s);
    for k in 0..measured.len() {
        if k % SAMPLES_A_LOOK == 0 {
            interrupt::check()?;
            progress.set_position(k as u64);
        }
        unit.set_time(measured.time(k));
        unit.set(at_u, u.values[k]).map_err(overflow)?;
        if let Some(load) = load {
            unit.set(at_load, load.values[k]).map_err(overflow)?;
        }
        for (at, column) in &mut columns {
            column.values.push(unit.get(*at).unwrap_or(f64::NAN));
        }
        unit.step(measured.period_s).map_err(overflow)?;
    }
    progress.finish_and_clear();
    let given = [Some(u), load].into_iter().flatten().cloned();
    let mut signals: Vec<Signal> = given.collect();
    signals.extend(columns.into_iter().map(|(_, column)| column));
    // u and what it moves first, the load last, as a recording has them.
    if load.is_some() {
        let load = signals.remove(1);
        signals.push(load);
    }
    Ok(Recording { name: drive.name.clone(), signals, ..measured.like() })
}

/// The fit of every signal that is both measured and modelled.
pub(crate) fn fits(measured: &Recording, model: &Recording) -> Vec<Fit> {
    let modelled =
        model.signals.iter().filter(|signal| !["u", "T_l"].contains(&signal.name.as_str()));
    modelled
        .filter_map(|y| Some((measured.signal(&y.name)?, y)))
        .map(|(measured, model)| {
            let (name, unit) = (measured.name.clone(), measured.unit.clone());
            Fit::of(name, unit, &measured.values, &model.values)
        })
        .collect()
}

impl Fit {
    /// Of a signal with what the model shows; holes of either do not count.
    pub(crate) fn of(signal: String, unit: String, measured: &[f64], model: &[f64]) -> Self {
        let pairs =
            measured.iter().zip(model).filter(|(y, model)| y.is_finite() && model.is_finite());
        let squares: Vec<f64> = pairs.map(|(y, model)| (y - model).powi(2)).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let constant = measured.iter().all(|y| *y == measured[0]);
        let percent = (!constant).then(|| 100.0 * (1.0 - rms / swing(measured)));
        Self { signal, percent, rms, unit }
    }
}

#[cfg(test)]
mod tests {
    use super::super::without_noise;
    use super::*;

    fn dr300() -> Drive {
        without_noise(&crate::drive_source::drive("dr300").expect("it is built in"))
    }

    fn recording(signals: Vec<Signal>) -> Recording {
        Recording::new("bench", 1.5, 0.002, signals)
    }

    fn signal(name: &str, unit: &str, of: impl Fn(f64) -> f64) -> Signal {
        let values = (0..1000).map(|k| of(f64::from(k) * 0.002)).collect();
        Signal { name: name.into(), unit: unit.into(), values }
    }

    #[test]
    fn the_model_reproduces_its_own_run() {
        let given = recording(vec![signal("u", "V", |t| 12.0 * (3.0 * t).sin())]);
        let rest = Start { current: 0.0, speed: 0.0, position: 0.0 };
        let bar = ProgressBar::hidden();
        let first = replay(&dr300(), &given, rest, &bar).expect("it runs");
        assert_eq!((first.start_s, first.len()), (1.5, 1000));
        // From the middle on, started from the state that the first samples show.
        let tail =
            |signal: &Signal| Signal { values: signal.values[500..].to_vec(), ..signal.clone() };
        let middle = Recording {
            start_s: first.time(500),
            signals: first.signals.iter().map(tail).collect(),
            ..first.clone()
        };
        let start = start(&dr300(), &middle).expect("it runs");
        let second = replay(&dr300(), &middle, start, &bar).expect("it runs");
        let fits = fits(&middle, &second);
        assert_eq!(
            fits.iter().map(|fit| fit.signal.as_str()).collect::<Vec<_>>(),
            ["i", "omega", "theta"]
        );
        for fit in fits {
            // The first sample of a run without noise is the state itself.
            assert!(fit.percent.is_some_and(|percent| percent > 99.99), "{fit:?}");
        }
    }

    #[test]
    fn a_model_that_knows_the_mean_only_fits_nothing() {
        let measured = recording(vec![signal("omega", "rad/s", |t| t), signal("i", "A", |_| 1.0)]);
        let model = recording(vec![signal("omega", "rad/s", |_| 0.999), signal("i", "A", |_| 2.0)]);
        let fits = fits(&measured, &model);
        assert!(fits[0].percent.is_some_and(|percent| percent.abs() < 1e-9), "{fits:?}");
        assert_eq!((fits[1].percent, fits[1].rms), (None, 1.0));
    }
}
