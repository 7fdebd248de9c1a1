//! Rows at the ends of a log in which some sensors had not spoken yet, or no longer do; channels that
//! a device exports without having any.

use std::fmt::Write;

use drivescope_recording::{Mapping, ReadOptions, Recording, Report, read_csv};

fn read(text: &str, options: &ReadOptions) -> (Recording, Report) {
    read_csv(text.as_bytes(), "log.csv", options).unwrap()
}

/// Rows every 0.01 s; of speed and current some lack.
fn log(rows: usize, lacks: impl Fn(usize) -> [bool; 2]) -> String {
    let mut text = String::from("time [s],omega [rad/s],i [A],other\n");
    for k in 0..rows {
        let [omega, i] = lacks(k);
        let cell =
            |lacks: bool, value: f64| if lacks { "NaN".to_owned() } else { value.to_string() };
        let (t, phase) = (0.01 * k as f64, 0.1 * k as f64);
        let (omega, i) = (cell(omega, phase.sin()), cell(i, phase.cos()));
        writeln!(text, "{t:.2},{omega},{i},{}", if k < 90 { "NaN" } else { "1" }).unwrap();
    }
    text
}

#[test]
fn rows_before_the_first_and_behind_the_last_value_are_left_out() {
    let text = log(200, |k| [k < 5, k < 3 || k == 199]);
    let every = |rows_every| ReadOptions { rows_every, ..ReadOptions::default() };
    for options in [every(None), every(Some(0.01))] {
        let (recording, report) = read(&text, &options);
        assert_eq!((recording.len(), recording.start_s), (194, 0.05), "{report}");
        report.require(&recording, &["omega", "i"]).unwrap();
        assert_eq!(recording.signal("omega").unwrap().values[0], 0.5_f64.sin());
        let stated = report.to_string();
        assert!(
            stated.contains("left out: lines 2 to 6, before the first value of `omega`, `i`\n")
                && stated.contains("left out: line 201, behind the last value of `i`\n"),
            "{stated}"
        );
        // What nobody reads keeps its holes, at their lines.
        assert!(
            stated.contains("other: 85 samples missing or not finite, lines 7 to 91"),
            "{stated}"
        );
    }
}

#[test]
fn holes_inside_and_long_silence_stay_holes() {
    let (recording, report) = read(&log(200, |k| [k == 50, k < 60]), &ReadOptions::default());
    assert_eq!(recording.len(), 200);
    let refused = |name: &str| report.require(&recording, &[name]).unwrap_err().to_string();
    assert!(refused("omega").starts_with("log.csv:52: `omega` is missing"), "{report}");
    assert!(refused("i").starts_with("log.csv:2: `i` is missing"), "{report}");
}

#[test]
fn a_device_s_empty_channels_are_left_out_with_one_word() {
    let mut text = String::from("time [ms],Speed [rpm],Not selected,Not selected,Not selected\n");
    (0..50).for_each(|k| writeln!(text, "{k},{},0.0,0.0,0.0", k * k).unwrap());
    let (recording, report) = read(&text, &ReadOptions::default());
    assert_eq!(recording.signals.len(), 1);
    let stated = report.to_string();
    assert_eq!(stated.matches("Not selected`").count(), 1, "{stated}");
    assert!(
        stated.contains("left out: columns 3 to 5, called `Not selected`, and constant"),
        "{stated}"
    );
    let columns = Mapping::parse_list("mode=Not selected#2").unwrap();
    let (recording, _) = read(&text, &ReadOptions { columns, ..ReadOptions::default() });
    assert!(recording.signal("mode").is_some());
}

#[test]
fn rows_that_are_said_to_lie_too_close_are_told_how_far_apart_they_do() {
    let mut text = String::from("theta [rad],omega [rad/s]\n");
    for k in 0..2000 {
        let t = 0.02 * f64::from(k);
        writeln!(text, "{:.6},{:.6}", (0.7 * t).sin(), 0.7 * (0.7 * t).cos()).unwrap();
    }
    let stated = |rows_every| {
        let options = ReadOptions { rows_every: Some(rows_every), ..ReadOptions::default() };
        read(&text, &options).1.to_string()
    };
    assert!(stated(0.008).contains("say --rows-every 0.02;"), "{}", stated(0.008));
    assert!(!stated(0.02).contains("--rows-every"), "{}", stated(0.02));
}
