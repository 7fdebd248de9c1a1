//! Means of neighbouring samples: what a drive does over seconds needs no thousand samples a second,
//! and sensors with steps tell more in the mean.
//!
//! Means of m samples of the outputs obey the drive's equations with the mean of the inputs that
//! act between them. That of the inputs is weighted by a triangle: each of the m samples of one
//! mean is moved to its place in the next by the m inputs after it.

use std::ops::Range;

use drivescope_plant::drive::{Drive, Input};
use drivescope_recording::{Break, Clock};

use crate::measured::{Channel, Measured, SHORTEST_PIECE};

/// Longest time between means, s: of a drive with an armature whose current follows the voltage, and
/// of one without.
const WITH_ARMATURE_S: f64 = 1e-3;
const WITHOUT_S: f64 = 4e-3;

/// The recording in means, as many samples a mean as the drive allows; nothing if it is one.
pub(super) fn averaged(drive: &Drive, measured: &Measured) -> Option<Measured> {
    let longest = match drive.motor.input {
        Input::Voltage => WITH_ARMATURE_S,
        Input::Force => WITHOUT_S,
    };
    let m = (longest / measured.period_s + 1e-6) as usize;
    let pieces: Vec<Range<usize>> = measured
        .pieces
        .iter()
        .filter(|piece| m > 1 && piece.len() >= m * SHORTEST_PIECE)
        .cloned()
        .collect();
    if pieces.is_empty() {
        return None;
    }
    let mean = |values: &Vec<f64>| -> Vec<f64> {
        let blocks = pieces.iter().flat_map(|piece| values[piece.clone()].chunks_exact(m));
        blocks.map(|block| block.iter().sum::<f64>() / m as f64).collect()
    };
    let driving = |values: &Vec<f64>| -> Vec<f64> {
        pieces.iter().flat_map(|piece| triangles(&values[piece.clone()], m)).collect()
    };
    let period_s = m as f64 * measured.period_s;
    let starts = pieces.iter().scan(0, |at, piece| {
        let from = *at;
        *at += piece.len() / m;
        Some(from..*at)
    });
    let averaged: Vec<Range<usize>> = starts.collect();
    let middle = 0.5 * (m - 1) as f64 * measured.period_s;
    let begins = |k: usize| measured.time(pieces[k].start) + middle;
    let breaks = (1..pieces.len()).map(|k| Break { at: averaged[k].start, start_s: begins(k) });
    Some(Measured {
        name: measured.name.clone(),
        clock: Clock { start_s: begins(0), period_s, breaks: breaks.collect() },
        period_s,
        driving: measured.driving,
        u: driving(&measured.u),
        load: measured.load.as_ref().map(driving),
        outputs: measured
            .outputs
            .iter()
            .map(|channel| Channel { values: mean(&channel.values), ..channel.clone() })
            .collect(),
        angle: measured.angle.as_ref().map(mean),
        pieces: averaged,
        by_load: measured.by_load,
        noise_gain: measured.noise_gain,
        remarks: Vec::new(),
    })
}

/// The input that acts from each mean of `m` samples to the next.
fn triangles(values: &[f64], m: usize) -> Vec<f64> {
    let weight = |l: usize| (m - l.abs_diff(m - 1)) as f64;
    let blocks = values.len() / m;
    let one = |block: usize| {
        let from = block * m;
        let inputs = values[from..values.len().min(from + 2 * m - 1)].iter().enumerate();
        let (sum, weights) = inputs.fold((0.0, 0.0), |(sum, weights), (l, value)| {
            (sum + weight(l) * value, weights + weight(l))
        });
        sum / weights
    };
    (0..blocks).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    #[test]
    fn means_obey_the_drive_with_the_mean_input() {
        let drive = dr300();
        let fine = noisy(bench(&drive, 2.0, 1e-4), [1e-9, 1e-9], 3);
        let fine = Measured::new(&drive, &fine).expect("it can be used");
        let means = averaged(&drive, &fine).expect("ten samples are a mean");
        assert!((means.period_s - 1e-3).abs() < 1e-12);
        assert_eq!(means.len(), fine.len() / 10);
        assert!((means.time(1) - means.time(0) - 1e-3).abs() < 1e-12);
        // J d(omega)/dt = K i - B omega - T_c away from rest: here the balance of voltages, whose
        // input is u: L di/dt = u - R i - K omega, by the trapezium over a mean.
        let motor = &drive.motor;
        let (r, l, k) = (
            motor.r.expect("it has one"),
            motor.l.expect("it has one"),
            motor.k_e.expect("it has one"),
        );
        let (i, omega) = (&means.outputs[0].values, &means.outputs[1].values);
        let (mut left, mut all) = (0.0, 0.0);
        for n in 10..means.len() - 10 {
            let middle = |values: &[f64]| 0.5 * (values[n] + values[n + 1]);
            let drop = r * middle(i) + k * middle(omega) + l * (i[n + 1] - i[n]) / means.period_s;
            left += (means.u[n] - drop).powi(2);
            all += means.u[n].powi(2);
        }
        assert!((left / all).sqrt() < 0.01, "{}", (left / all).sqrt());
    }
}
