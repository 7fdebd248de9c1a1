//! The noise of a sensor: given, or estimated without the model.
//!
//! Differences of order d take the smooth motion out and leave sqrt(C(2d, d)) times the noise.
//! What answers u within a few samples (a current after a step, a ripple) is no noise: the part
//! of the differences that past differences of u explain, by least squares over [`LAGS`] samples,
//! is taken out first. Where a loop is closed around the sensor, u follows the noise, and that
//! would take the noise out too; it shows by what u's own present and future explain, and then
//! the plain differences are used. Samples beyond [`CLIP`] standard deviations (the jumps of
//! stick-slip) are left out, and the scale made right for their absence. A signal on a grid q has
//! at least q / sqrt(12).
//!
//! Where rows were interpolated onto a uniform grid, the differences are corrected by what that did
//! to white noise ([`Measured::noise_gain`]).
//!
//! Bias on the cases of the tests: below 10 %; larger where the drive moves within fewer samples
//! than d, for then a motion cannot be told from noise.

use drivescope_numerics::Regression;
use drivescope_plant::drive::{Drive, NoiseData, SensorData};
use drivescope_recording::Quantum;
use serde::Serialize;

use crate::measured::{Channel, Measured, Output};

/// Order of the differences.
pub(crate) const ORDER: usize = 5;
/// Past samples of u that may explain a difference: an armature answers within some of them.
const LAGS: usize = 20;
/// Present and future samples of u by which feedback is recognised.
const AHEAD: usize = 5;
/// From this share of what the past left unexplained on, u follows the noise.
const FEEDBACK: f64 = 0.05;
/// Standard deviations beyond which a difference is no noise.
const CLIP: f64 = 3.0;
/// Share of a normal variance within [`CLIP`] standard deviations, over that of the probability:
/// 1 - 2 c phi(c) / (2 Phi(c) - 1) at c = 3.
const KEPT: f64 = 0.973_337_1;
/// Rounds of clipping at most, and the change that ends them.
const ROUNDS: usize = 50;
const SETTLED: f64 = 1e-4;
/// Rows that the estimate uses at most: its own error is then about 1 %.
const MOST_ROWS: usize = 16_000;
/// Rows below which what u explains would be chance: five a coefficient.
const FEWEST_ROWS: usize = 5 * (LAGS + AHEAD);
/// Consecutive samples that are taken together where there are more.
const STRETCH: usize = 1000;

/// Where a standard deviation comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum NoiseSource {
    /// The drive file or the command line says it.
    Given,
    /// Differences of the recording say it.
    Estimated,
}

/// The noise of one output in one recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Noise {
    /// Standard deviation, in the output's unit.
    pub sd: f64,
    /// Where it comes from.
    pub source: NoiseSource,
}

/// The noise of every output of a recording, in their order: what the user gives by name first,
/// then what the drive file says, then what the differences say.
pub fn noise(drive: &Drive, measured: &Measured, given: &[(String, f64)]) -> Vec<Noise> {
    let of = |channel: &Channel| {
        let named = given.iter().find(|(name, _)| name == channel.name).map(|(_, sd)| *sd);
        match named.or_else(|| of_file(&drive.noise, &drive.sensors, channel.output)) {
            // What is given is the sensor's; interpolation left that much of it.
            Some(sd) => {
                let sd = sd * measured.noise_gain.of_difference(0);
                Noise { sd, source: NoiseSource::Given }
            }
            None => Noise { sd: estimated(measured, channel), source: NoiseSource::Estimated },
        }
    };
    measured.outputs.iter().map(of).collect()
}

/// What the drive file knows, quantisation included.
fn of_file(noise: &NoiseData, sensors: &SensorData, output: Output) -> Option<f64> {
    let (sd, quantum) = match output {
        Output::Current => (noise.i, sensors.current_quantum),
        Output::Speed => (noise.omega, sensors.tacho_quantum),
        Output::Position => (noise.theta, 0.0),
        Output::LoadSpeed | Output::LoadPosition | Output::Temperature => (0.0, 0.0),
    };
    (sd > 0.0).then(|| (sd * sd + quantum * quantum / 12.0).sqrt())
}

/// The standard deviation that the recording itself shows.
fn estimated(measured: &Measured, channel: &Channel) -> f64 {
    let rows = rows(measured, channel);
    let by_grid = Quantum::of(&channel.values).map_or(0.0, |quantum| quantum.step / 12f64.sqrt());
    // Interpolated noise is smooth: its differences are smaller than itself by more.
    let smooth = &measured.noise_gain;
    let gain = of_white_noise().sqrt() * smooth.of_difference(ORDER) / smooth.of_difference(0);
    let by_differences = if rows.len() < FEWEST_ROWS {
        clipped(&differences(measured, channel))
    } else {
        let plain = clipped(&rows.iter().map(|row| row.difference).collect::<Vec<_>>());
        match explained(&rows, LAGS) {
            Some(past) if !feedback(&rows, &past) => clipped(&past).min(plain),
            _ => plain,
        }
    };
    let sd = (by_differences / gain).max(by_grid);
    // A signal without any noise (a simulation) is known to the digits of its numbers.
    sd.max(swing(&channel.values) * LEAST)
}

/// Least noise, relative to the swing of the signal.
const LEAST: f64 = 1e-9;

fn swing(values: &[f64]) -> f64 {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (min, max) = finite()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    let scale = (max - min).max(max.abs());
    if scale > 0.0 { scale } else { 1.0 }
}

/// A difference of the output, and the differences of u around it: [`LAGS`] past ones, the latest
/// first, then [`AHEAD`] from the present on.
struct Row {
    difference: f64,
    u: [f64; LAGS + AHEAD],
}

/// The difference of that order that ends with sample `last`.
pub(crate) fn difference(values: &[f64], last: usize) -> f64 {
    let mut sum = 0.0;
    let mut binomial = 1.0;
    for j in 0..=ORDER {
        sum += binomial * values[last - j];
        binomial *= -((ORDER - j) as f64) / (j + 1) as f64;
    }
    sum
}

/// Variance of such a difference of white noise over that of the noise: C(2 d, d) of order d.
pub(crate) fn of_white_noise() -> f64 {
    (1..=ORDER).map(|k| (ORDER + k) as f64 / k as f64).product()
}

/// The differences of a recording too short for more.
fn differences(measured: &Measured, channel: &Channel) -> Vec<f64> {
    let pieces = measured.pieces.iter();
    let all = pieces.flat_map(|piece| piece.start + ORDER..piece.end);
    all.map(|k| difference(&channel.values, k)).filter(|it| it.is_finite()).collect()
}

/// The rows, in stretches spread over the recording where it is long.
fn rows(measured: &Measured, channel: &Channel) -> Vec<Row> {
    let samples: usize = measured.pieces.iter().map(|piece| piece.len()).sum();
    let every = samples.div_ceil(MOST_ROWS).max(1);
    let mut rows = Vec::new();
    for piece in &measured.pieces {
        let usable = piece.start + ORDER + LAGS..piece.end.saturating_sub(AHEAD);
        let chosen = usable.filter(|k| (k / STRETCH).is_multiple_of(every));
        rows.extend(chosen.filter_map(|k| {
            let y = difference(&channel.values, k);
            let shift = |j: usize| if j < LAGS { k - 1 - j } else { k + j - LAGS };
            let row = Row {
                difference: y,
                u: std::array::from_fn(|j| difference(&measured.u, shift(j))),
            };
            y.is_finite().then_some(row)
        }));
    }
    rows
}

/// What the first `columns` differences of u leave unexplained; nothing where u does not vary.
fn explained(rows: &[Row], columns: usize) -> Option<Vec<f64>> {
    let mut remainder: Vec<f64> = rows.iter().map(|row| row.difference).collect();
    // Twice: the second time without what the first showed to be no noise.
    for _ in 0..2 {
        let limit = CLIP * clipped(&remainder);
        let mut regression = Regression::new(columns);
        for (row, remainder) in rows.iter().zip(&remainder) {
            if remainder.abs() <= limit {
                regression.push(row.u[..columns].iter().copied(), row.difference);
            }
        }
        let fit = regression.solve().ok()?;
        let by_u = |row: &Row| row.u.iter().zip(&fit.parameters).map(|(u, p)| u * p).sum::<f64>();
        remainder = rows.iter().map(|row| row.difference - by_u(row)).collect();
    }
    Some(remainder)
}

/// Whether present and future u explain what the past left.
fn feedback(rows: &[Row], past: &[f64]) -> bool {
    explained(rows, LAGS + AHEAD).is_some_and(|all| {
        let (all, past) = (clipped(&all), clipped(past));
        1.0 - (all / past).powi(2) > FEEDBACK
    })
}

/// Standard deviation of the normal core of these values.
fn clipped(values: &[f64]) -> f64 {
    let mean_square = |limit: f64| {
        let within = values.iter().filter(|value| value.abs() <= limit);
        let (sum, count) =
            within.fold((0.0, 0usize), |(sum, n), value| (sum + value * value, n + 1));
        sum / count.max(1) as f64
    };
    let mut sd = mean_square(f64::INFINITY).sqrt();
    for _ in 0..ROUNDS {
        let next = (mean_square(CLIP * sd) / KEPT).sqrt();
        let moved = (next - sd).abs();
        sd = next;
        if moved <= SETTLED * sd {
            break;
        }
    }
    sd
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, closed_loop, dr300, driven, ripple};
    use drivescope_recording::Recording;

    /// What the estimate may be off.
    const BIAS: f64 = 0.10;

    fn noisy(recording: Recording, sds: [f64; 2], quanta: [f64; 2], seed: u64) -> Recording {
        let mut recording = crate::testing::noisy(recording, sds, seed);
        for (name, quantum) in ["i", "omega"].iter().zip(quanta).filter(|(_, q)| *q > 0.0) {
            let signal = recording.signals.iter_mut().find(|it| it.name == *name).expect("there");
            for value in &mut signal.values {
                *value = (*value / quantum).round() * quantum;
            }
        }
        recording
    }

    fn off(recording: &Recording, expected: [f64; 2]) -> [f64; 2] {
        let mut drive = dr300();
        drive.noise = NoiseData::default();
        let measured = Measured::new(&drive, recording).expect("it can be used");
        let found = noise(&drive, &measured, &[]);
        assert!(found.iter().all(|one| one.source == NoiseSource::Estimated));
        [0, 1].map(|j| found[j].sd / expected[j] - 1.0)
    }

    fn check(what: &str, recording: &Recording, expected: [f64; 2]) {
        let off = off(recording, expected);
        assert!(off.iter().all(|off| off.abs() <= BIAS), "{what}: {off:?}");
    }

    #[test]
    fn white_noise_on_steps_waves_and_ripple_is_found() {
        let drive = dr300();
        for (k, sds) in [[0.01, 0.3], [0.002, 0.05], [0.05, 1.5]].into_iter().enumerate() {
            let seed = 10 * k as u64;
            let bench = bench(&drive, 8.0, 0.001);
            check("bench", &noisy(bench.clone(), sds, [0.0; 2], seed), sds);
            let rippled = driven(&drive, ripple(8000), 0.001);
            check("ripple", &noisy(rippled, sds, [0.0; 2], seed), sds);
        }
    }

    #[test]
    fn a_grid_adds_its_own_noise() {
        let bench = bench(&dr300(), 8.0, 0.001);
        let q = [0.02, 0.4];
        let sds = [0.01, 0.2];
        let total = [0, 1].map(|j| (sds[j] * sds[j] + q[j] * q[j] / 12.0f64).sqrt());
        check("dithered", &noisy(bench.clone(), sds, q, 3), total);
        // Hardly any noise on a moving signal: the grid alone.
        check(
            "grid",
            &noisy(bench, [1e-5; 2], [0.05, 1.0], 4),
            [0.05, 1.0].map(|q| q / 12f64.sqrt()),
        );
    }

    #[test]
    fn a_closed_loop_does_not_explain_its_own_noise() {
        let mut drive = dr300();
        drive.noise = NoiseData { omega: 0.3, i: 0.01, ..NoiseData::default() };
        drive.sensors.tacho_quantum = 0.0;
        let recording = closed_loop(&drive, 20.0, 7);
        check("closed loop", &recording, [0.01, 0.3]);
    }

    #[test]
    fn what_is_given_is_taken() {
        let drive = dr300();
        let measured = Measured::new(&drive, &bench(&drive, 1.0, 0.001)).expect("it can be used");
        let found = noise(&drive, &measured, &[("i".to_owned(), 0.02)]);
        assert_eq!(found[0], Noise { sd: 0.02, source: NoiseSource::Given });
        // 3 rpm and a grid of 2 rpm.
        let rpm = std::f64::consts::PI / 30.0;
        assert!((found[1].sd - rpm * (9.0 + 4.0 / 12.0f64).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_short_recording_still_shows_its_noise() {
        let drive = dr300();
        for samples in [30, 60, 140] {
            let whole = noisy(bench(&drive, 2.0, 0.001), [0.01, 0.3], [0.0; 2], 3);
            let mut short = whole.clone();
            short.signals.iter_mut().for_each(|signal| signal.values.truncate(samples));
            let measured = Measured::new(&drive, &short).expect("it can be used");
            for (found, sd) in super::noise(&drive, &measured, &[]).iter().zip([0.01, 0.3]) {
                assert!((0.5..2.0).contains(&(found.sd / sd)), "{samples}: {} of {sd}", found.sd);
            }
        }
    }
}
