//! What is learned of one machine from a short healthy run.

use thiserror::Error;

use super::examine::normal_score;
use super::filter::filter;
use super::process::{Belief, Process, Row, SENSORS};
use super::watch::{Event, Limits, Watch};

/// Rows below which no machine is learned.
pub const FEWEST_ROWS: usize = 100;
/// Speed in standard deviations of the tachometer's noise below which the shaft counts as at rest.
const AT_REST: f64 = 30.0;
/// Normal score of the sum of squares from which the drive model is not that of the machine.
const NOT_THIS_MACHINE: f64 = 8.0;
/// Passes over the run: the first finds the parameters, the others start from them.
const PASSES: usize = 3;
/// Standard deviations by which a parameter may lie off its nominal value.
const TOLERATED: f64 = 5.0;

/// Why no bank is made of a run.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BaselineError {
    /// Too few rows.
    #[error(
        "a healthy baseline needs {FEWEST_ROWS} samples or more, there are {rows}: give some seconds"
    )]
    TooShort {
        /// Rows given.
        rows: usize,
    },
    /// Nothing was measured of the sensors that the process has.
    #[error("the baseline shows neither speed nor current nor voltage: record one of them")]
    NothingMeasured,
    /// The shaft does not turn.
    #[error(
        "the baseline was recorded at rest: friction and resistance do not show there, let the \
         drive run"
    )]
    AtRest,
    /// A parameter is nowhere near its nominal value.
    #[error(
        "the baseline asks for a change of {parameter} by {change:+.3}, its tolerance is \
         {tolerance}: it shows another drive or a fault"
    )]
    OutOfTolerance {
        parameter: String,
        /// Change that the run asks for, as a fraction.
        change: f64,
        /// Standard deviation of the parameter over healthy machines.
        tolerance: f64,
    },
    /// The model with its best parameters does not explain the run.
    #[error(
        "the drive model leaves {rms:.2} times the noise that it predicts in the baseline: fit the \
         drive first, or record the baseline without a fault"
    )]
    NotThisMachine {
        /// Root mean square of the whitened innovations.
        rms: f64,
    },
    /// Something changes within the run.
    #[error("something changes at sample {sample} of the baseline: record it without a fault")]
    Changes {
        /// The first sample of it.
        sample: usize,
    },
}

/// Learns the machine's parameters from a healthy run of it and starts to watch after its last row.
/// Judgements rest on `horizon` rows from an onset on.
///
/// # Errors
/// A run that is too short, at rest, or not that of a healthy machine of this kind.
pub fn learn<const N: usize, P: Process<N>>(
    mut process: P,
    rows: &[Row],
    limits: Limits,
    horizon: usize,
) -> Result<Watch<N, P>, BaselineError> {
    let (Some(first), true) = (rows.first(), rows.len() >= FEWEST_ROWS) else {
        return Err(BaselineError::TooShort { rows: rows.len() });
    };
    let nominal = process.begin(first);
    let moving = N - process.learned().len();
    check_motion(&mut process, &nominal, rows)?;
    let Fitted { belief, offsets, squares, measured, .. } = fitted(&mut process, first, rows);
    if measured == 0 {
        return Err(BaselineError::NothingMeasured);
    }
    for (k, parameter) in process.learned().iter().enumerate() {
        let tolerance = nominal.covariance[moving + k][moving + k].sqrt();
        let change = offsets[k] - 1.0;
        if change.is_nan() || change.abs() > TOLERATED * tolerance {
            let parameter = parameter.clone();
            return Err(BaselineError::OutOfTolerance { parameter, change, tolerance });
        }
    }
    let score = normal_score(squares, measured as f64);
    if score.is_nan() || score >= NOT_THIS_MACHINE {
        let rms = (squares / measured as f64).sqrt();
        return Err(BaselineError::NotThisMachine { rms });
    }
    let watch = Watch::new(process, belief, limits, horizon);
    check_steady(&watch, rows)?;
    Ok(watch)
}

/// The machine that explains a run best, and how well it does.
struct Fitted<const N: usize> {
    /// Belief about the row after the last.
    belief: Belief<N>,
    /// Factor on each learned parameter.
    offsets: Vec<f64>,
    /// Sum of squares of the innovations, and their number.
    squares: f64,
    measured: usize,
    /// Logarithm of the likelihood of the run.
    log_likelihood: f64,
}

/// Moves the process to the machine of a run that begins with the row `first`.
fn fitted<const N: usize, P: Process<N>>(process: &mut P, first: &Row, rows: &[Row]) -> Fitted<N> {
    let moving = N - process.learned().len();
    let mut found = Fitted {
        belief: process.begin(first),
        offsets: vec![1.0; process.learned().len()],
        squares: 0.0,
        measured: 0,
        log_likelihood: 0.0,
    };
    for _ in 0..PASSES {
        found.belief = process.begin(first);
        (found.squares, found.measured, found.log_likelihood) = (0.0, 0, 0.0);
        filter(process, &mut found.belief, rows, |_, correction, _| {
            found.squares += correction.squares();
            found.measured += correction.measured();
            found.log_likelihood += (0..SENSORS).map(|m| correction.log_density(m)).sum::<f64>();
        });
        let learned = found.belief.mean[moving..].iter();
        found.offsets.iter_mut().zip(learned).for_each(|(whole, by)| *whole *= 1.0 + by);
        process.settle(&mut found.belief);
    }
    found
}

/// Logarithm of the likelihood of a run, its machine learned from it.
pub fn log_likelihood<const N: usize, P: Process<N>>(process: &P, rows: &[Row]) -> f64 {
    let fit = |first| fitted(&mut process.clone(), first, rows).log_likelihood;
    rows.first().map_or(0.0, fit)
}

/// Whether the shaft turns, if its speed was measured.
fn check_motion<const N: usize, P: Process<N>>(
    process: &mut P,
    belief: &Belief<N>,
    rows: &[Row],
) -> Result<(), BaselineError> {
    let Some(first) = rows.first() else { return Ok(()) };
    let variance = process.sense(&belief.mean, first).variance[0];
    let speeds = rows.iter().map(|row| row.shown[0].abs()).filter(|speed| speed.is_finite());
    let fastest = speeds.fold(f64::NEG_INFINITY, f64::max);
    if fastest.is_finite() && fastest < AT_REST * variance.sqrt() {
        return Err(BaselineError::AtRest);
    }
    Ok(())
}

/// Whether the run itself raises no alarm.
fn check_steady<const N: usize, P: Process<N>>(
    watch: &Watch<N, P>,
    rows: &[Row],
) -> Result<(), BaselineError> {
    let mut watch = watch.clone();
    if let Some(first) = rows.first() {
        watch.resume(first);
    }
    for row in rows {
        if let Some(Event::Alarm(alarm)) = watch.step(row) {
            return Err(BaselineError::Changes { sample: alarm.onset });
        }
    }
    Ok(())
}
