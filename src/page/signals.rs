//! Signals for the browser: measured, modelled and left over, as many points as it can draw.
//!
//! An answer is a line of JSON (its length first, u32, padded to four bytes) and then one column
//! of f32 after the other, little endian. Points lie at `start + k step`. Of more samples than
//! [`MOST_POINTS`] the least and the greatest of each bucket stay, in the order in which they
//! occurred, so that a peak of one sample is seen.

use drivescope_plant::drive::{Drive, Input};
use serde::Serialize;

use super::bench::State;
use crate::failure::Failure;

/// Points of a column at most, unless the browser asks for fewer.
pub(super) const MOST_POINTS: usize = 100_000;

/// Time over which the residual is averaged, s: what noise leaves of an error that stays.
const SMOOTH_S: f64 = 0.05;

/// A column: what it shows of which output.
#[derive(Debug, Clone, Serialize)]
struct Column {
    /// Name of the output, or `u`.
    output: &'static str,
    unit: String,
    /// `measured`, `model`, `residual`, `mean residual`, or some with `ghost` before.
    role: &'static str,
}

#[derive(Debug, Serialize)]
struct Head {
    /// Of every segment: its first point, and the time of that, s. The point before it has no
    /// values.
    segments: Vec<(usize, f64)>,
    /// Time between points, s.
    step: f64,
    /// Points of every column.
    count: usize,
    /// Samples that a bucket holds; 1: every sample is a point.
    bucket: usize,
    columns: Vec<Column>,
}

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    /// Number of the recording.
    pub(super) recording: usize,
    /// Step whose model is drawn, and another one beside it.
    pub(super) step: usize,
    /// The other one.
    pub(super) ghost: Option<usize>,
    /// From and to, s; nothing for all.
    pub(super) window: Option<(f64, f64)>,
    /// Points of a column at most.
    pub(super) points: usize,
}

/// The answer.
///
/// # Errors
/// A recording or a step that there is not.
pub(super) fn signals(state: &State, wanted: &Wanted) -> Result<Vec<u8>, Failure> {
    let step = state.step(wanted.step)?;
    let ghost = wanted.ghost.map(|number| state.step(number)).transpose()?;
    let whole = state.whole.as_ref();
    let measured = whole.and_then(|it| it.recordings.get(wanted.recording));
    let compared = step.compared.recordings.get(wanted.recording);
    let (Some(measured), Some(compared)) = (measured, compared) else {
        return Err(Failure::Usage {
            what: format!("there is no recording {}", wanted.recording),
            instead: "reload the page".to_owned(),
        });
    };
    // The nearest sample.
    let sample = |time: f64| measured.clock.sample(time + 0.5 * measured.period_s);
    let all = measured.len();
    let (from, to) = wanted.window.map_or((0, all), |(from, to)| (sample(from), sample(to) + 1));
    let to = to.min(all);
    let from = from.min(to.saturating_sub(1));
    let most = wanted.points.clamp(4, MOST_POINTS);
    let bucket = bucket(to - from, most);
    let mut columns = vec![Column { output: "u", unit: input_unit(&step.drive), role: "measured" }];
    // Nothing is drawn through the gap between segments: a point without values stands there.
    let segments = measured.clock.part(&(from..to)).segments(to - from);
    let parted = |column: &[f64]| {
        let parts = segments.iter().map(|segment| reduced(&column[segment.clone()], bucket));
        parts.collect::<Vec<_>>().join(&f32::NAN)
    };
    let mut values = vec![parted(&measured.u[from..to])];
    for (place, output) in compared.outputs.iter().enumerate() {
        let mut push = |role, of: &dyn Fn(usize) -> f64| {
            let column: Vec<f64> = (from..to).map(of).collect();
            values.push(parted(&column));
            columns.push(Column { output: output.name, unit: output.unit.clone(), role });
        };
        push("measured", &|k| output.model[k] + output.residual[k]);
        push("model", &|k| output.model[k]);
        push("residual", &|k| output.residual[k] / output.noise);
        let smooth = smoothed(&output.residual, (SMOOTH_S / measured.period_s) as usize);
        push("mean residual", &|k| smooth[k] / output.noise);
        let other = ghost.as_ref().and_then(|it| it.compared.recordings.get(wanted.recording));
        if let Some(other) = other.and_then(|it| it.outputs.get(place)) {
            push("ghost model", &|k| other.model[k]);
            let smooth = smoothed(&other.residual, (SMOOTH_S / measured.period_s) as usize);
            push("ghost mean residual", &|k| smooth[k] / other.noise);
        }
    }
    let spacing = if bucket == 1 { 1.0 } else { bucket as f64 / 2.0 };
    let mut point = 0;
    let starts = segments.iter().map(|segment| {
        let begin = (point, measured.time(from + segment.start));
        point += reduced(&measured.u[from..to][segment.clone()], bucket).len() + 1;
        begin
    });
    let head = Head {
        segments: starts.collect(),
        step: spacing * measured.period_s,
        count: values[0].len(),
        bucket,
        columns,
    };
    Ok(packed(&head, &values))
}

/// Unit of u; what a force-driven drive takes, its file does not say.
fn input_unit(drive: &Drive) -> String {
    if drive.motor.input == Input::Voltage { "V".to_owned() } else { String::new() }
}

/// The mean over that many samples around each, of those that are finite.
fn smoothed(values: &[f64], samples: usize) -> Vec<f64> {
    let finite = |value: &f64| if value.is_finite() { (*value, 1.0) } else { (0.0, 0.0) };
    let mut sums = vec![(0.0, 0.0)];
    for (value, count) in values.iter().map(finite) {
        let (sum, before) = sums[sums.len() - 1];
        sums.push((sum + value, before + count));
    }
    let half = samples / 2;
    let mean = |k: usize| {
        let (from, to) = (sums[k.saturating_sub(half)], sums[(k + half + 1).min(values.len())]);
        (to.0 - from.0) / (to.1 - from.1)
    };
    (0..values.len()).map(mean).collect()
}

/// Samples of a bucket, so that two points a bucket are at most that many.
fn bucket(samples: usize, most: usize) -> usize {
    if samples <= most { 1 } else { samples.div_ceil(most / 2) }
}

/// The least and the greatest value of each bucket, in their order; NaN where there is none.
fn reduced(values: &[f64], bucket: usize) -> Vec<f32> {
    if bucket == 1 {
        return values.iter().map(|value| *value as f32).collect();
    }
    let mut kept = Vec::with_capacity(2 * values.len().div_ceil(bucket));
    for chunk in values.chunks(bucket) {
        let mut ends: Option<((usize, f64), (usize, f64))> = None;
        for (k, value) in chunk.iter().copied().enumerate().filter(|it| it.1.is_finite()) {
            let (least, greatest) = ends.get_or_insert(((k, value), (k, value)));
            if value < least.1 {
                *least = (k, value);
            }
            if value > greatest.1 {
                *greatest = (k, value);
            }
        }
        kept.extend(match ends {
            None => [f32::NAN; 2],
            Some((least, greatest)) if least.0 <= greatest.0 => [least.1 as f32, greatest.1 as f32],
            Some((least, greatest)) => [greatest.1 as f32, least.1 as f32],
        });
    }
    kept
}

fn packed(head: &Head, columns: &[Vec<f32>]) -> Vec<u8> {
    // A head of numbers and names always has a text.
    let mut text = serde_json::to_string(head).unwrap_or_default();
    text.push_str(&" ".repeat((4 - text.len() % 4) % 4));
    let mut bytes = Vec::with_capacity(4 + text.len() + 4 * head.count * columns.len());
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
    for value in columns.iter().flatten() {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_of_one_sample_among_a_million_stays() {
        let mut values: Vec<f64> = (0..1_000_000).map(|k| f64::from(k % 7)).collect();
        values[765_432] = 1e3;
        values[123_456] = -1e3;
        values[10] = f64::NAN;
        let bucket = bucket(values.len(), 2000);
        let kept = reduced(&values, bucket);
        assert!(kept.len() <= 2000, "{}", kept.len());
        assert_eq!(kept.iter().filter(|it| **it == 1e3).count(), 1);
        assert_eq!(kept.iter().filter(|it| **it == -1e3).count(), 1);
        assert_eq!(kept[2 * (765_432 / bucket) + 1], 1e3, "in its bucket, after the least");
        assert!(kept.iter().all(|it| it.is_finite()));
    }

    #[test]
    fn few_samples_stay_as_they_are_and_holes_stay_holes() {
        assert_eq!(bucket(100, 100), 1);
        assert_eq!(reduced(&[1.0, 2.0], 1), [1.0, 2.0]);
        let holes = reduced(&[f64::NAN; 6], 3);
        assert!(holes.len() == 4 && holes.iter().all(|it| it.is_nan()));
        // Odd lengths end in a shorter bucket; the greater value came first there.
        assert_eq!(reduced(&[0.0, 1.0, 5.0, 4.0, 9.0], 3), [0.0, 5.0, 4.0, 9.0]);
    }

    #[test]
    fn a_mean_leaves_out_what_is_missing() {
        let mut values = vec![1.0; 50];
        values[20] = f64::NAN;
        values[30] = 6.0;
        let smooth = smoothed(&values, 5);
        assert_eq!((smooth[0], smooth[20], smooth[30], smooth[33]), (1.0, 1.0, 2.0, 1.0));
        assert!(smoothed(&[f64::NAN; 9], 3).iter().all(|it| it.is_nan()));
    }

    #[test]
    fn columns_begin_at_whole_words() {
        let column = Column { output: "u", unit: "V".to_owned(), role: "measured" };
        let head = Head {
            segments: vec![(0, 0.0)],
            step: 0.5,
            count: 2,
            bucket: 1,
            columns: vec![column],
        };
        let bytes = packed(&head, &[vec![1.5, -2.0]]);
        let length = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize;
        assert_eq!(length % 4, 0);
        assert_eq!(bytes[4 + length..], [1.5_f32.to_le_bytes(), (-2.0_f32).to_le_bytes()].concat());
    }
}
