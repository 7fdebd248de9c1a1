//! One FMU over one experiment.

use drivescope_fmu::import::{Kind, RunOptions, Value, run};
use drivescope_recording::{Recording, Signal};

use crate::foreign::lags;
use crate::support::{probe, probe_with};

fn input(name: &str, unit: &str) -> Recording {
    let values = (0..=100).map(|k| if k < 50 { 0.0 } else { 2.0 }).collect();
    let signals = vec![Signal { name: name.into(), unit: unit.into(), values }];
    Recording::new("step.csv", 0.0, 0.01, signals)
}

#[test]
fn a_run_follows_its_input() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        for kind in [Kind::CoSimulation, Kind::ModelExchange] {
            let input = input("u", "rad/s");
            let options = RunOptions {
                input: Some(&input),
                kind: Some(kind),
                tolerance: Some(1e-10),
                parameters: vec![("T".into(), Value::Number(0.25))],
                ..RunOptions::default()
            };
            let recording = run(&fmu, &options).unwrap();
            assert_eq!((recording.len(), recording.period_s), (101, 0.01));
            let names: Vec<_> = recording.signals.iter().map(|s| s.name.as_str()).collect();
            assert_eq!(names, ["u", "x", "h", "held", "x_rpm", "twice", "n"]);
            let x = &recording.signal("x").unwrap().values;
            for k in [0, 50, 51, 80, 100_usize] {
                let after = k.saturating_sub(50) as f64 * 0.01;
                let exact = 2.0 * (1.0 - (-after / 0.25).exp());
                assert!((x[k] - exact).abs() < 1e-8, "{k}: {} {exact}", x[k]);
            }
            assert_eq!(recording.signal("u").unwrap().values, input.signals[0].values);
            assert_eq!(recording.signal("x").unwrap().unit, "rad/s");
        }
    }
}

#[test]
fn what_is_left_out_comes_from_the_fmu() {
    let Some(fmu) = probe("3") else { return };
    let options =
        RunOptions { record: Some(vec!["h".into(), "v".into()]), ..RunOptions::default() };
    let recording = run(&fmu, &options).unwrap();
    assert_eq!((recording.len(), recording.signals.len()), (101, 2));
    let bare = |text: String| {
        text.replace("<DefaultExperiment", "<!--").replace("stepSize=\"0.01\"/>", "-->")
    };
    let fmu = probe_with("3", bare).unwrap();
    let error = run(&fmu, &RunOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no stop time"), "{error}");
    let options = RunOptions { stop: Some(2.0), ..RunOptions::default() };
    assert_eq!(run(&fmu, &options).unwrap().period_s, 0.002);
}

#[test]
fn inputs_that_do_not_fit_are_refused() {
    let Some(fmu) = probe("2") else { return };
    let message = |recording: &Recording| {
        let options = RunOptions { input: Some(recording), ..RunOptions::default() };
        run(&fmu, &options).unwrap_err().to_string()
    };
    let error = message(&input("voltage", "V"));
    assert!(
        error.contains("no signal of `step.csv` is an input") && error.contains("u, on"),
        "{error}"
    );
    let error = message(&input("u", "V"));
    assert!(error.contains("`u` is in `rad/s`, but the signal is in `V`"), "{error}");
    let mut empty = input("u", "rad/s");
    empty.signals[0].values.clear();
    assert!(message(&empty).contains("has no sample"));
    let options = RunOptions { step: Some(-1.0), ..RunOptions::default() };
    assert!(run(&fmu, &options).unwrap_err().to_string().contains("step size -1 s"));
}

#[test]
fn foreign_fmus_are_run() {
    for path in lags() {
        let fmu = drivescope_fmu::import::Fmu::open(path).unwrap();
        let input = input("u", "1");
        let options = RunOptions {
            input: Some(&input),
            stop: Some(1.0),
            step: Some(0.01),
            ..RunOptions::default()
        };
        let y = run(&fmu, &options).unwrap().signal("y").unwrap().values.clone();
        assert!((y[100] - 2.0 * (1.0 - (-0.5_f64 / 2.0).exp())).abs() < 1e-12);
    }
}
