//! `train` and `diagnose`: healthy recordings become a diagnoser that tells a fault from health, and
//! whatever cannot serve is refused with its place.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use crate::{done, folder, program, put, refused, run};

/// Sampling time of the recordings, s.
const PERIOD: f64 = 0.005;

/// A heater of no drive's kind: two lags in a row, y in K, driven by p in W; sensor noise of 0.05 K.
/// From `onset` on the sensor shows `gain` times the temperature.
pub(crate) fn heater(
    power: impl Fn(usize) -> f64,
    samples: usize,
    seed: u64,
    onset: usize,
    gain: f64,
) -> String {
    let mut state = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
    let mut noise = || {
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let mut text = "time [s],p [W],y [K]\n".to_owned();
    let (mut wall, mut core) = (0.0, 0.0);
    for k in 0..samples {
        let p = power(k) + 0.5 * noise();
        let shown = if k >= onset { gain * core } else { core };
        let _ = writeln!(text, "{:.3},{p:.4},{:.4}", k as f64 * PERIOD, shown + 0.05 * noise());
        wall += 0.05 * (p - wall);
        core += 0.1 * (wall - core) + 0.001 * wall * (10.0 - core).max(0.0);
    }
    text
}

pub(crate) fn swinging(k: usize) -> f64 {
    8.0 + 4.0 * (0.031 * k as f64).sin() + 3.0 * (0.0113 * k as f64).sin()
}

pub(crate) fn held(_: usize) -> f64 {
    8.0
}

const TRAIN: [&str; 11] = [
    "train",
    "one.csv",
    "two.csv",
    "--excited",
    "open.csv",
    "--input",
    "p",
    "--output-signal",
    "y",
    "-o",
    "heater.toml",
];

fn trained(here: &Path, without: &str) {
    put(here, "one.csv", heater(held, 3500, 1, usize::MAX, 1.0));
    put(here, "two.csv", heater(held, 12_000, 2, usize::MAX, 1.0));
    put(here, "open.csv", heater(swinging, 2500, 3, usize::MAX, 1.0));
    done(here, &[&TRAIN[..], &["--without", without]].concat());
}

#[test]
fn a_machine_of_another_kind_is_diagnosed() {
    let here = folder();
    let here = here.path();
    trained(here, "recurrent");
    let file = std::fs::read_to_string(here.join("heater.toml")).expect("it was written");
    assert!(file.starts_with("schema = 3") && file.contains("name = \"y\""), "{file}");
    put(here, "ill.csv", heater(held, 5000, 4, 4000, 1.1));
    put(here, "well.csv", heater(held, 5000, 5, usize::MAX, 1.0));
    let ask = |recording: &str| {
        let arguments = ["diagnose", "heater.toml", recording, "--json", "-"];
        done(here, &arguments).json()
    };
    let (ill, well) = (ask("ill.csv"), ask("well.csv"));
    assert_eq!((&ill["verdict"], &well["verdict"]), (&"fault".into(), &"healthy".into()));
    let methods = ill["methods"].as_array().expect("a list");
    let of_bands =
        |it: &&serde_json::Value| ["mem", "constant", "gmdh"].iter().any(|id| it["method"] == *id);
    assert_eq!(methods.iter().filter(of_bands).count(), 3, "{ill}");
    for found in methods.iter().filter(of_bands) {
        let declared = found["declared"][0]["sample"].as_u64().expect("declared");
        assert!((4050..4080).contains(&declared), "{found}");
    }
    for found in well["methods"].as_array().expect("a list") {
        assert!(found["exceedance_rate"].as_f64().is_some_and(|rate| rate < 0.1), "{found}");
        assert_eq!(found["declared"].as_array().map(Vec::len), Some(0), "{found}");
    }
    // A finding that the user forbids is an exit code; the same rows live say the same.
    assert_eq!(run(here, &["diagnose", "heater.toml", "ill.csv", "--check"]).code, Some(1));
    assert_eq!(run(here, &["diagnose", "heater.toml", "well.csv", "--check"]).code, Some(0));
    let live = piped(here, &["diagnose", "heater.toml", "-", "--json", "-"], "ill.csv");
    let live: serde_json::Value = serde_json::from_slice(&live).expect("JSON");
    assert_eq!(live["methods"], ill["methods"]);
    // Nor does it count whether anybody reads what is declared: the file rests on all rows.
    let mut unread = program(here)
        .args(["diagnose", "heater.toml", "-", "--check", "--json", "unread.json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    drop(unread.stdout.take());
    let rows = std::fs::read(here.join("ill.csv")).expect("written before");
    unread.stdin.take().expect("piped").write_all(&rows).expect("it reads to the end");
    assert_eq!(unread.wait().expect("it ends").code(), Some(1));
    let unread = std::fs::read_to_string(here.join("unread.json")).expect("it was written");
    let unread: serde_json::Value = serde_json::from_str(&unread).expect("JSON");
    assert_eq!(unread["methods"], ill["methods"]);
}

/// What the program prints when a file comes in through standard input.
fn piped(here: &Path, arguments: &[&str], file: &str) -> Vec<u8> {
    let mut live = program(here)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let rows = std::fs::read(here.join(file)).expect("written before");
    live.stdin.take().expect("piped").write_all(&rows).expect("it reads");
    live.wait_with_output().expect("it ends").stdout
}

#[test]
fn faults_that_were_shown_are_named_live_or_not_and_others_are_unknown() {
    let here = folder();
    let here = here.path();
    put(here, "one.csv", heater(held, 3500, 1, usize::MAX, 1.0));
    put(here, "two.csv", heater(held, 12_000, 2, usize::MAX, 1.0));
    put(here, "open.csv", heater(swinging, 2500, 3, usize::MAX, 1.0));
    for (file, seed, gain) in
        [("high", 7, 1.1), ("low", 8, 0.9), ("twice", 9, 1.2), ("same", 10, 1.1)]
    {
        put(here, &format!("{file}.csv"), heater(held, 2500, seed, 1500, gain));
    }
    let shown = ["--fault", "gain +10 %=high.csv", "--fault", "gain -10 %=low.csv"];
    let shown =
        [&shown[..], &["--fault", "gain +20 %=twice.csv", "--fault", "ten=same.csv"]].concat();
    let without = ["--without", "recurrent,gmdh", "--json", "-"];
    let learned = done(here, &[&TRAIN[..], &without, &shown].concat()).json();
    let classes = &learned["faults"]["classes"];
    assert_eq!(classes[0], serde_json::json!(["gain +10 %", "ten"]), "{learned}");
    assert_eq!(classes.as_array().map(Vec::len), Some(3), "{learned}");
    for fault in learned["faults"]["faults"].as_array().expect("a list") {
        assert!(fault["right"].as_f64().is_some_and(|share| share > 0.9), "{fault}");
    }
    for (seed, gain, class, group) in [
        (11, 1.1, "gain +10 % | ten", "small"),
        (12, 0.9, "gain -10 %", "small"),
        (13, 1.2, "gain +20 %", "large"),
        (14, 0.7, "unknown", "large"),
    ] {
        put(here, "ill.csv", heater(held, 3500, seed, 2500, gain));
        let answer = done(here, &["diagnose", "heater.toml", "ill.csv", "--json", "-"]).json();
        let fault = &answer["fault"];
        assert_eq!(fault["class"], class, "{answer}");
        // Of three that are nearly as large it is by chance which is called the smallest.
        assert_eq!(fault["group"] == "large", group == "large", "{answer}");
        assert!(fault["share"].as_f64().is_some_and(|share| share > 0.8), "{answer}");
        let live = piped(here, &["diagnose", "heater.toml", "-", "--json", "-"], "ill.csv");
        let live: serde_json::Value = serde_json::from_slice(&live).expect("JSON");
        assert_eq!(live["fault"], answer["fault"]);
        let said = piped(here, &["diagnose", "heater.toml", "-"], "ill.csv");
        assert!(String::from_utf8_lossy(&said).contains(class), "{class}");
    }
    for (wrong, said) in [
        ("high.csv", "NAME=REC"),
        ("healthy=two.csv", "two.csv: fault healthy stands declared at"),
        ("alone=high.csv", "at least two faults"),
        ("gone=none.csv", "none.csv"),
    ] {
        let message = refused(here, &[&TRAIN[..], &["--fault", wrong]].concat());
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn a_fault_of_a_drive_that_starts_from_rest_is_declared_at_its_onset() {
    let here = folder();
    let here = here.path();
    let simulate = |name: &str, more: &[&str]| {
        let rig = ["simulate", "dr300", "--reference", "2000 [rpm]", "-o", name];
        done(here, &[&rig[..], more].concat());
    };
    simulate("one.csv", &["--seed", "1", "--duration", "20"]);
    simulate("two.csv", &["--seed", "2", "--duration", "20"]);
    let fault = ["--seed", "3", "--duration", "12", "--fault", "tacho=5%@8..10"];
    simulate("ill.csv", &fault);
    let trained = done(here, &["train", "one.csv", "two.csv", "-o", "rig.toml", "--json", "-"]);
    // The noise of the tachometer and of the load is 5 rpm: the run-up from rest, in which speed and
    // effort do what they never do again, does not widen what is expected of the rest.
    let error = trained.json()["process_model"]["validation_rms"].as_f64();
    assert!(error.is_some_and(|error| error < 6.0), "{error:?}");
    let found = done(here, &["diagnose", "rig.toml", "ill.csv", "--json", "-"]).json();
    assert_eq!(found["verdict"], "fault", "{found}");
    let onset = found["declarations"][0]["from"].as_f64();
    assert!(onset.is_some_and(|onset| (onset - 8.0).abs() < 0.1), "{found}");
}

#[test]
fn what_cannot_train_a_diagnoser_is_refused() {
    let here = folder();
    let here = here.path();
    put(here, "open.csv", heater(swinging, 2500, 3, usize::MAX, 1.0));
    let good = heater(held, 3500, 1, usize::MAX, 1.0);
    let line = good.lines().nth(1401).expect("long enough").to_owned();
    let holed = good.replace(&line, &format!("{},,1.0", line.split(',').next().expect("a time")));
    let still: String = "time [s],p [W],y [K]\n".to_owned()
        + &(0..3500).map(|k| format!("{:.3},8,{}\n", k as f64 * PERIOD, k % 7)).collect::<String>();
    put(here, "two.csv", &good);
    for (text, said) in [
        (heater(held, 520, 1, usize::MAX, 1.0), "samples"),
        (holed, "one.csv:1402"),
        (still, "constant"),
        ("time [s],u [V],y [K]\n0,1,2\n0.005,2,3\n".to_owned(), "`p`"),
    ] {
        put(here, "one.csv", text);
        let message = refused(here, &[&TRAIN[..], &["--without", "gmdh,recurrent"]].concat());
        assert!(message.contains(said), "{said}: {message}");
    }
    put(here, "one.csv", &good);
    for (wrong, said) in [
        (["--beta", "1.5"], "beta = 1.5"),
        (["--window", "-1"], "--window"),
        (["--run-up", "1000"], "samples"),
    ] {
        let message = refused(here, &[&TRAIN[..], &wrong].concat());
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn a_diagnoser_is_not_run_on_what_it_was_not_made_for() {
    let here = folder();
    let here = here.path();
    trained(here, "gmdh,recurrent");
    let good = heater(held, 1000, 6, usize::MAX, 1.0);
    let slow: String = good
        .lines()
        .enumerate()
        .map(|(k, line)| match (k, line.split_once(',')) {
            (0, _) | (_, None) => format!("{line}\n"),
            (k, Some((_, rest))) => format!("{:.3},{rest}\n", (k - 1) as f64 * 2.0 * PERIOD),
        })
        .collect();
    for (text, said) in [
        (good.replace("p [W]", "q [W]"), "p"),
        (good.replace("y [K]", "y [V]"), "V"),
        (slow, "0.01"),
        (heater(held, 400, 6, usize::MAX, 1.0), "0 are left to judge"),
        (heater(held, 540, 6, usize::MAX, 1.0), "40 are left to judge, and a declaration takes 50"),
    ] {
        put(here, "other.csv", text);
        let message = refused(here, &["diagnose", "heater.toml", "other.csv"]);
        assert!(message.contains(said), "{said}: {message}");
    }
    put(here, "good.csv", &good);
    let file = std::fs::read_to_string(here.join("heater.toml")).expect("written");
    for (file, said) in [
        (file.replacen("schema = 3", "schema = 7", 1), "schema 7"),
        (file.replacen("run_up = 500", "run_up = \"long\"", 1), "line 2"),
        ("what = 1".to_owned(), "schema"),
    ] {
        put(here, "broken.toml", file);
        let message = refused(here, &["diagnose", "broken.toml", "good.csv"]);
        assert!(message.contains(said), "{said}: {message}");
    }
    let message = refused(here, &["diagnose", "heater.toml", "good.csv", "--method", "gmdh"]);
    assert!(message.contains("robust GMDH network"), "{message}");
    assert!(refused(here, &["diagnose", "none.toml", "good.csv"]).contains("none.toml"));
}

/// Rows a while after others: a second segment of the same file.
fn later(text: &str, seconds: f64) -> String {
    let row = |line: &str| {
        let (time, rest) = line.split_once(',').expect("columns");
        format!("{:.3},{rest}\n", seconds + time.parse::<f64>().expect("a time"))
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn every_segment_of_a_recording_trains() {
    let here = folder();
    let here = here.path();
    let joined = |parts: [String; 2]| parts[0].clone() + &later(&parts[1], 100.0);
    let well = |samples, seed| heater(held, samples, seed, usize::MAX, 1.0);
    put(here, "one.csv", joined([well(2500, 1), well(2500, 6)]));
    put(here, "two.csv", joined([well(6500, 2), well(6500, 7)]));
    put(here, "open.csv", heater(swinging, 2500, 3, usize::MAX, 1.0));
    let asked = [&TRAIN[..], &["--without", "recurrent", "--json", "-"]].concat();
    let answer = done(here, &asked).json();
    // 2.5 s settle the models in each of the two.
    let samples = &answer["bands"]["samples"];
    assert_eq!(samples, &serde_json::Value::from(2 * (6500 - 500)), "{answer}");
    put(here, "ill.csv", heater(held, 5000, 4, 4000, 1.1));
    put(here, "well.csv", joined([well(3000, 5), well(3000, 8)]));
    let verdict = |recording: &str| {
        done(here, &["diagnose", "heater.toml", recording, "--json", "-"]).json()["verdict"].clone()
    };
    assert_eq!((verdict("ill.csv"), verdict("well.csv")), ("fault".into(), "healthy".into()));
}

/// A program that gets rows through a pipe, its answer and what it says beside it.
fn streamed(here: &Path, more: &[&str], rows: &str) -> (serde_json::Value, String) {
    put(here, "stream.csv", rows);
    let input = std::fs::File::open(here.join("stream.csv")).expect("written before");
    let arguments = ["diagnose", "heater.toml", "-", "--json", "-"];
    let out = program(here).args(arguments).args(more).stdin(input).output().expect("it runs");
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.success(), "{said}");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    (serde_json::from_str(text.lines().last().expect("an answer")).expect("JSON"), said)
}

#[test]
fn a_stream_survives_what_happens_to_streams() {
    let here = folder();
    let here = here.path();
    trained(here, "gmdh,recurrent");
    let well = heater(held, 6000, 6, usize::MAX, 1.0);
    let lines: Vec<&str> = well.lines().collect();
    // Rows lost one by one and many at once: decided as on the recording of the same rows.
    let kept = |k: usize| ![500, 900, 901].contains(&k) && !(3000..3200).contains(&k);
    let gaps: String =
        (0..lines.len()).filter(|k| kept(*k)).map(|k| format!("{}\n", lines[k])).collect();
    let (answer, said) = streamed(here, &[], &gaps);
    let stream = &answer["stream"];
    assert_eq!((&stream["bridged"], &stream["gaps"]), (&3.into(), &1.into()), "{answer}");
    assert!(said.contains("before line 501: 1 rows are missing: bridged"), "{said}");
    assert!(said.contains("a new segment begins"), "{said}");
    let batch = done(here, &["diagnose", "heater.toml", "stream.csv", "--json", "-"]).json();
    assert_eq!(answer["methods"], batch["methods"]);
    assert_eq!((&answer["samples"], &answer["run_up"]), (&batch["samples"], &batch["run_up"]));

    // Late, repeated and malformed lines, a second header, a value that is none.
    let mut hostile: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    hostile.insert(1000, hostile[800].clone());
    hostile.insert(1200, hostile[1199].clone());
    hostile.insert(1400, "gar,\u{0}garbage".to_owned());
    hostile.insert(1500, hostile[0].clone());
    hostile.insert(1600, "1.0".to_owned());
    let time = hostile[2000].split(',').next().expect("a time").to_owned();
    hostile[2000] = format!("{time},nan,1.0");
    let (answer, said) = streamed(here, &[], &hostile.join("\n"));
    let stream = &answer["stream"];
    for (key, count) in [
        ("late", 1),
        ("repeated", 1),
        ("malformed", 3),
        ("incomplete", 1),
        ("bridged", 1),
        ("gaps", 0),
    ] {
        assert_eq!(stream[key], count, "{key}: {stream}");
    }
    assert_eq!((&answer["verdict"], &answer["samples"]), (&"healthy".into(), &6000.into()));
    assert!(said.contains("line 1001: later rows came before it"), "{said}");
    assert!(said.contains("5999 rows taken"), "{said}");

    // Twice the rate, put on the grid of the diagnoser; another rate alone is refused.
    let fast: String = lines[1..]
        .windows(2)
        .flat_map(|pair| {
            let row = |line: &str| -> Vec<f64> {
                line.split(',').map(|it| it.parse().expect("a number")).collect()
            };
            let (a, b) = (row(pair[0]), row(pair[1]));
            let middle: Vec<String> = (0..3).map(|k| format!("{}", 0.5 * (a[k] + b[k]))).collect();
            [format!("{}\n", pair[0]), format!("{}\n", middle.join(","))]
        })
        .collect();
    let fast = format!("{}\n{fast}", lines[0]);
    let (answer, _) = streamed(here, &["--resample", "0.005"], &fast);
    assert_eq!((&answer["verdict"], &answer["samples"]), (&"healthy".into(), &5999.into()));
    let asked = ["diagnose", "heater.toml", "-", "--json", "-"];
    let input = std::fs::File::open(here.join("stream.csv")).expect("written before");
    let out = program(here).args(asked).stdin(input).output().expect("it runs");
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && said.contains("--resample 0.005"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_live_run_that_is_ended_by_its_user_answers_with_what_it_found() {
    let here = folder();
    let here = here.path();
    trained(here, "gmdh,recurrent");
    let ill = heater(held, 5000, 4, 4000, 1.1);
    let mut live = program(here)
        .args(["diagnose", "heater.toml", "-", "--check", "--json", "found.json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    let mut rows = live.stdin.take().expect("piped");
    rows.write_all(ill.as_bytes()).and_then(|()| rows.flush()).expect("it reads");
    // It said that a fault is declared: it is at work. The pipe stays open.
    let mut said = std::io::BufReader::new(live.stdout.take().expect("piped"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut said, &mut line).expect("it says so");
    assert!(line.contains("fault declared"), "{line}");
    let kill = std::process::Command::new("kill").args(["-INT", &live.id().to_string()]).status();
    assert!(kill.expect("it can be sent").success());
    assert_eq!(live.wait().expect("it ends").code(), Some(1));
    drop(rows);
    let found = std::fs::read_to_string(here.join("found.json")).expect("it was written");
    let found: serde_json::Value = serde_json::from_str(&found).expect("JSON");
    assert_eq!(found["verdict"], "fault", "{found}");
}
