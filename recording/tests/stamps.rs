//! What stamps say is kept where nothing that the file is read for speaks against it.

use std::fmt::Write;

use drivescope_recording::{ReadOptions, Recording, Report, read_csv};

fn read(text: &str) -> (Recording, Report) {
    read_csv(text.as_bytes(), "log.csv", &ReadOptions::default()).unwrap()
}

/// Numbers within one half that follow no pattern.
fn random(k: usize) -> f64 {
    let mut state = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for _ in 0..3 {
        state ^= state >> 30;
        state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    state as f64 / u64::MAX as f64 - 0.5
}

fn speed(t: f64) -> f64 {
    20.0 + 5.0 * (2.0 * t).sin()
}

fn angle(t: f64) -> f64 {
    20.0 * t - 2.5 * (2.0 * t).cos()
}

/// Stamps that never go back, of a logger that waits now 20 ms and now as long as it needs.
fn two_steps() -> Vec<f64> {
    let mut now = 0.5;
    let step = |k: usize| {
        let (stretch, within) = (k / 150, k % 150);
        let waits = within < 30 + stretch * 37 % 40 || within > 120 && k.is_multiple_of(3);
        now += if waits { 0.020 } else { 0.0107 } + 4e-4 * random(k);
        now
    };
    (0..3000).map(step).collect()
}

#[test]
fn a_logger_of_two_steps_keeps_its_time() {
    let stamps = two_steps();
    for noise in [0.0, 0.5] {
        let mut text = String::from("time [s],theta [rad],omega [rad/s],torque [N m]\n");
        for (k, t) in stamps.iter().enumerate() {
            let (theta, omega) = (angle(*t), speed(*t) + noise * random(k + 9000));
            writeln!(text, "{t:.6},{theta:.6},{omega:.6},{:.6}", 0.1 * random(k + 7)).unwrap();
        }
        let (recording, report) = read(&text);
        let stated = report.to_string();
        assert!(!stated.contains("runs back") && report.sampling.moved == 0, "{stated}");
        assert!(recording.start_s >= stamps[0] - 0.02, "{stated}");
        assert!(report.end_s <= stamps[stamps.len() - 1] + 0.02, "{stated}");
        // 25 rad/s over the jitter of half a millisecond.
        let theta = &recording.signal("theta").unwrap().values;
        let off = |(k, theta): (usize, &f64)| (theta - angle(recording.time(k))).abs();
        let most = theta.iter().enumerate().map(off).fold(0.0, f64::max);
        assert!(most < 0.02, "{most} {stated}");
    }
}

#[test]
fn a_column_that_is_not_read_does_not_say_when_rows_were_sampled() {
    let step = 0.01;
    let stamps: Vec<f64> = (0..3000).map(|k| step * (k as f64 + 0.8 * random(k))).collect();
    let log = |beside: usize| {
        let mut text = String::from("time [s],theta [rad],omega [rad/s]");
        (0..beside).for_each(|n| write!(text, ",des{n}").unwrap());
        for (k, t) in stamps.iter().enumerate() {
            write!(text, "\n{t:.6},{:.6},{:.6}", angle(*t), speed(*t)).unwrap();
            // Set points, written evenly.
            let even = step * k as f64;
            let written = |n: usize| ((3.0 + n as f64) * even).sin();
            (0..beside).for_each(|n| write!(text, ",{:.6}", written(n)).unwrap());
        }
        text
    };
    let (alone, _) = read(&log(0));
    let (beside, report) = read(&log(6));
    assert!(report.sampling.by_stamps, "{report}");
    assert_eq!(alone.signal("omega"), beside.signal("omega"));
    assert_eq!((alone.period_s, alone.len()), (beside.period_s, beside.len()));
}
