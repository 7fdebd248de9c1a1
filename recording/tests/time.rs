//! Rows as loggers write them, put on a uniform grid: what is recovered is what was there.

use std::fmt::Write;

use drivescope_recording::{ReadOptions, Recording, Report, read_csv};

/// Sampling time of the machine, s.
const STEP: f64 = 0.002;
/// Rows of a log.
const ROWS: usize = 5000;

/// Speed of the machine at a time: what every log is of.
fn speed(t: f64) -> f64 {
    100.0 * (3.0 * t).sin() + 20.0 * (31.0 * t).sin()
}

/// The voltage, held over each sample.
fn voltage(k: usize) -> f64 {
    if (k / 100).is_multiple_of(2) { 6.0 } else { -3.0 }
}

/// Numbers within one half that follow no pattern.
fn random(k: usize, seed: u64) -> f64 {
    let mut state = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ seed;
    for _ in 0..3 {
        state ^= state >> 30;
        state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    state as f64 / u64::MAX as f64 - 0.5
}

/// A row: its stamp, the number of its sample, its speed.
type Row = (f64, usize, f64);

fn rows() -> Vec<Row> {
    (0..ROWS).map(|k| (k as f64 * STEP, k, speed(k as f64 * STEP))).collect()
}

fn log(rows: &[Row]) -> String {
    let mut text = String::from("time [s],u [V],omega [rad/s]\n");
    for (stamp, k, speed) in rows {
        writeln!(text, "{stamp:.6},{},{speed:.6}", voltage(*k)).unwrap();
    }
    text
}

fn read(text: &str) -> (Recording, Report) {
    read_csv(text.as_bytes(), "log.csv", &ReadOptions::default()).unwrap()
}

/// Root mean square of the speed's error at the recording's times, in rad/s, whatever the constant
/// between the clocks.
fn error(recording: &Recording, clock: f64) -> f64 {
    let omega = &recording.signal("omega").unwrap().values;
    let squares = omega.iter().enumerate();
    let squares = squares.map(|(k, value)| (value - speed(recording.time(k) - clock)).powi(2));
    (squares.sum::<f64>() / omega.len() as f64).sqrt()
}

#[test]
fn stamps_that_jitter_are_told_from_samples_that_do() {
    let mut late = rows();
    for (k, row) in late.iter_mut().enumerate() {
        row.0 += 0.3 * STEP * random(k, 1);
    }
    let (recording, report) = read(&log(&late));
    assert_eq!((recording.len(), recording.period_s), (ROWS, STEP));
    assert!(!report.sampling.by_stamps && report.sampling.interpolated == 0.0);
    // The rows themselves: only the first stamp's jitter moves the clock.
    let clock = late[0].0;
    assert!(error(&recording, clock) < 1e-3, "{}", error(&recording, clock));
    let stated = report.to_string();
    assert!(stated.contains("a uniform grid of 0.002 s; rows taken as evenly sampled"), "{stated}");

    for (k, row) in late.iter_mut().enumerate() {
        row.2 = speed(row.0) + 1e-3 * random(k, 2);
    }
    let (recording, report) = read(&log(&late));
    assert!(report.sampling.by_stamps, "{report}");
    // A straight line over a step of a sine of 31 rad/s is off by 20 (31 h)^2 / 8 = 0.01 rad/s.
    assert!(error(&recording, 0.0) < 0.01, "{}", error(&recording, 0.0));
}

#[test]
fn interpolation_changes_the_noise_as_it_says() {
    let mut rows = rows();
    for (k, row) in rows.iter_mut().enumerate() {
        row.0 += 0.8 * STEP * random(k, 1);
        row.2 = speed(row.0) + random(k, 2);
    }
    let (recording, _) = read(&log(&rows));
    let gain = recording.noise_gain;
    assert!(gain.of_difference(0) < 0.9, "{gain:?}");
    let omega = &recording.signal("omega").unwrap().values;
    let noise = |k: usize| omega[k] - speed(recording.time(k));
    let plain = (0..ROWS - 5).map(|k| noise(k).powi(2)).sum::<f64>();
    let third = |k: usize| noise(k + 3) - 3.0 * noise(k + 2) + 3.0 * noise(k + 1) - noise(k);
    let third = (0..ROWS - 5).map(|k| third(k).powi(2)).sum::<f64>();
    let of = |sum: f64, white: f64| (sum / (ROWS - 5) as f64 / (white / 12.0)).sqrt();
    assert!((of(plain, 1.0) / gain.of_difference(0) - 1.0).abs() < 0.03, "{}", of(plain, 1.0));
    assert!((of(third, 20.0) / gain.of_difference(3) - 1.0).abs() < 0.03, "{}", of(third, 20.0));
}

#[test]
fn lost_late_repeated_and_disordered_rows_are_mended() {
    let mut spoiled: Vec<Row> = Vec::new();
    for (k, row) in rows().into_iter().enumerate() {
        // One in thirty is lost, two at a time now and then.
        if k % 31 == 7 || k % 310 == 8 {
            continue;
        }
        spoiled.push(row);
        if k % 500 == 100 {
            spoiled.push(row);
        }
    }
    for k in (50..spoiled.len() - 1).step_by(400) {
        spoiled.swap(k, k + 1);
    }
    // The logger stands still once: 25 rows get the stamp of the last.
    let still = spoiled[1025].0;
    spoiled[1000..1025].iter_mut().for_each(|row| row.0 = still);
    let (recording, report) = read(&log(&spoiled));
    assert_eq!((recording.len(), recording.period_s), (ROWS, STEP));
    // Ten were sent twice, one of them lost.
    assert_eq!(report.repeated.samples, 9);
    assert!(report.sampling.disordered > 9 && recording.breaks.is_empty(), "{report}");
    assert!((0.03..0.04).contains(&report.sampling.interpolated), "{report}");
    // Where the logger stood still, nothing tells which of the rows were lost: up to 25 rows are a
    // step off, 1.4 rad/s at most.
    assert!(error(&recording, 0.0) < 0.05, "{}", error(&recording, 0.0));
}

#[test]
fn gaps_restarts_and_run_numbers_make_segments() {
    let all = rows();
    let gap: Vec<Row> = [&all[..2000], &all[2600..]].concat();
    let (recording, report) = read(&log(&gap));
    assert_eq!(recording.segments(), [0..2000, 2000..4400]);
    assert!((recording.time(2000) - 5.2).abs() < 1e-9 && error(&recording, 0.0) < 1e-3);
    assert!(report.to_string().contains("a new segment begins at line 2002"), "{report}");

    let restart: Vec<Row> = [&all[..2000], &all[..3000]].concat();
    let (recording, report) = read(&log(&restart));
    assert_eq!((recording.segments(), report.sampling.moved), (vec![0..2000, 2000..5000], 1));
    assert!(recording.time(2000) > recording.time(1999) + 0.5);

    let mut numbered = String::from("time [s],run,omega [rad/s]\n");
    for (stamp, k, speed) in &all {
        writeln!(numbered, "{stamp},{},{speed}", if *k < 1234 { 1 } else { 2 }).unwrap();
    }
    let numbered = numbered.replace("run", "segment");
    let (recording, _) = read(&numbered);
    assert_eq!(recording.segments(), [0..1234, 1234..ROWS]);
    assert!(recording.signal("segment").is_none());
}

#[test]
fn joined_runs_of_different_rates_share_one_grid() {
    let fast: Vec<Row> = rows();
    let slow: Vec<Row> =
        (0..800).map(|k| 20.0 + k as f64 * 0.01).map(|t| (t, 0, speed(t))).collect();
    let (recording, _) = read(&log(&[fast, slow].concat()));
    assert_eq!((recording.period_s, recording.breaks.len()), (STEP, 1));
    assert_eq!(recording.segments()[1].len(), 799 * 5 + 1);
    // 20 (31 rad/s 0.01 s)^2 / 8 = 0.24 rad/s between the slow rows.
    assert!(error(&recording, 0.0) < 0.3, "{}", error(&recording, 0.0));
}

#[test]
fn coarse_stamps_keep_every_row() {
    let stamped: Vec<Row> = (0..4300)
        .map(|k| (k, k as f64 / 430.0))
        .map(|(k, t)| ((t * 1e3).floor() / 1e3, k, speed(t)))
        .collect();
    let (recording, _) = read(&log(&stamped));
    assert_eq!((recording.len(), recording.breaks.len()), (4300, 0));
    assert!((recording.period_s * 430.0 - 1.0).abs() < 1e-4, "{}", recording.period_s);
    // Ten rows a stamp.
    let tenths: Vec<Row> =
        rows().into_iter().map(|(t, k, w)| ((t * 50.0).floor() / 50.0, k, w)).collect();
    let (recording, _) = read(&log(&tenths));
    assert_eq!((recording.len(), recording.period_s), (ROWS, STEP));
}

#[test]
fn slow_logs_are_logs() {
    let slow: Vec<Row> = (0..600)
        .map(|k| (k, k as f64 * 0.1 + 0.02 * random(k, 5)))
        .map(|(k, t)| (t, k, speed(0.1 * t)))
        .collect();
    let (recording, report) = read(&log(&slow));
    assert_eq!((recording.len(), recording.period_s, report.sampling.uneven), (600, 0.1, true));
}

#[test]
fn what_is_no_clock_is_said() {
    let refused = |text: &str| {
        read_csv(text.as_bytes(), "log.csv", &ReadOptions::default()).unwrap_err().to_string()
    };
    let mut falling = rows();
    falling.reverse();
    assert!(refused(&log(&falling)).contains("sort the rows by time"));
    let mut chaos = rows();
    for (k, row) in chaos.iter_mut().enumerate() {
        row.0 = 1e6 * random(k, 9);
    }
    let said = refused(&log(&chaos));
    assert!(said.contains("time jumps") || said.contains("sort the rows"), "{said}");
}

#[test]
fn segments_survive_writing() {
    let all = rows();
    let restart: Vec<Row> = [&all[..2000], &all[..1000], &all[3000..]].concat();
    let (recording, _) = read(&log(&restart));
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.csv", "a.parquet"] {
        let path = folder.path().join(name);
        drivescope_recording::write(&path, &recording).unwrap();
        let (again, _) = drivescope_recording::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(again.segments(), recording.segments(), "{name}");
        assert_eq!(again.signals, recording.signals, "{name}");
        assert_eq!(again.time(2500), recording.time(2500), "{name}");
    }
}
