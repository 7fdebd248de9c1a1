//! One FMU over one experiment.

use drivescope_fmu::import::{Interface, RunOptions, Value, run};
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
        for kind in [Interface::CoSimulation, Interface::ModelExchange] {
            let input = input("u", "rad/s");
            let options = RunOptions {
                input: Some(&input),
                kind: Some(kind),
                tolerance: Some(1e-10),
                parameters: vec![("T".into(), Value::Number(0.25))],
                ..RunOptions::default()
            };
            let recording = run(&fmu, &options).unwrap().recording;
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
    let recording = run(&fmu, &options).unwrap().recording;
    assert_eq!((recording.len(), recording.signals.len()), (101, 2));
    let bare = |text: String| {
        text.replace("<DefaultExperiment", "<!--").replace("stepSize=\"0.01\"/>", "-->")
    };
    let fmu = probe_with("3", bare).unwrap();
    let error = run(&fmu, &RunOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no stop time"), "{error}");
    let options = RunOptions { stop: Some(2.0), ..RunOptions::default() };
    assert_eq!(run(&fmu, &options).unwrap().recording.period_s, 0.002);
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
        let y = run(&fmu, &options).unwrap().recording.signal("y").unwrap().values.clone();
        assert!((y[100] - 2.0 * (1.0 - (-0.5_f64 / 2.0).exp())).abs() < 1e-12);
    }
}

/// Model Exchange: a time event at a communication point belongs to it, and sees its inputs.
#[test]
fn an_event_in_time_is_recorded_after_it_happened() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        let input = input("u", "rad/s");
        let kind = Some(Interface::ModelExchange);
        let options = RunOptions { input: Some(&input), kind, ..RunOptions::default() };
        let recording = run(&fmu, &options).unwrap().recording;
        let at = |name: &str, k: usize| recording.signal(name).unwrap().values[k];
        // It samples u every 0.1 s, from 0 on; u steps to 2 at 0.5 s.
        assert_eq!([0, 9, 10, 11, 49, 50].map(|k| at("n", k)), [1.0, 1.0, 2.0, 2.0, 5.0, 6.0]);
        assert_eq!([49, 50, 51].map(|k| at("held", k)), [0.0, 2.0, 2.0]);
    }
}

/// The end of a run that the FMU ends belongs to it.
#[test]
fn the_end_that_an_fmu_asks_for_is_recorded() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        let parameters = vec![("fail".into(), Value::Number(100.0))];
        let options = RunOptions { parameters, ..RunOptions::default() };
        let ran = run(&fmu, &options).unwrap();
        assert_eq!(ran.recording.len(), 91, "FMI {fmi}: 0 to 0.9 s");
        assert!(ran.ended.is_some_and(|time| (time - 0.9).abs() < 1e-9), "{:?}", ran.ended);
        let whole = run(&fmu, &RunOptions::default()).unwrap();
        assert_eq!((whole.recording.len(), whole.ended), (101, None));
        let x = |ran: &drivescope_fmu::import::Ran| ran.recording.signal("x").unwrap().values[90];
        assert_eq!(x(&ran), x(&whole), "the state at the end, not that before it");
    }
}

/// Outputs of FMI 3.0 that are no scalar numbers.
fn more_outputs(text: String) -> String {
    let more = "<Int64 name=\"big\" valueReference=\"50\" causality=\"output\" initial=\"exact\" start=\"0\"/>\
        <Binary name=\"bytes\" valueReference=\"51\" causality=\"output\"/></ModelVariables>";
    let structure = "<Output valueReference=\"50\"/><Output valueReference=\"51\"/><ContinuousStateDerivative valueReference=\"4\"";
    text.replace("</ModelVariables>", more).replacen(
        "<ContinuousStateDerivative valueReference=\"4\"",
        structure,
        1,
    )
}

#[test]
fn nothing_that_can_be_recorded_vanishes() {
    let Some(fmu) = probe_with("3", more_outputs) else { return };
    let ran = run(&fmu, &RunOptions::default()).unwrap();
    let text = |ran: &drivescope_fmu::import::Ran, name: &str| {
        let found = ran.texts.iter().find(|text| text.name == name);
        found.unwrap_or_else(|| panic!("{name}: {:?}", ran.texts)).values.clone()
    };
    assert_eq!(text(&ran, "big"), vec!["9007199254740993"; 101], "not ...992");
    assert_eq!(text(&ran, "bytes"), vec!["01ff00"; 101]);

    let set = |name: &str, value: &str| (name.to_owned(), Value::Text(value.to_owned()));
    let options = RunOptions {
        record: Some(vec!["triple".into(), "label".into(), "big".into()]),
        parameters: vec![
            set("triple", "4 5, 6.5"),
            set("label", "a, \"b\""),
            set("big", "9007199254740992"),
        ],
        ..RunOptions::default()
    };
    let ran = run(&fmu, &options).unwrap();
    let names: Vec<_> = ran.recording.signals.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["triple[1]", "triple[2]", "triple[3]", "big"], "2^53 is a number");
    assert_eq!(
        ran.recording.signals.iter().map(|s| s.values[100]).collect::<Vec<_>>(),
        [4.0, 5.0, 6.5, 9_007_199_254_740_992.0]
    );
    assert_eq!(text(&ran, "label")[100], "a, \"b\"");

    let message = |name: &str, value: &str| {
        let options = RunOptions { parameters: vec![set(name, value)], ..RunOptions::default() };
        run(&fmu, &options).unwrap_err().to_string()
    };
    assert!(message("triple", "1 2").contains("`triple` has 3 elements, and 2 are given"));
    assert!(message("big", "9223372036854775808").contains("`big` is of type Int64"));
    assert!(message("T", "-1").contains("T must be positive, but is -1"));
}

/// What an FMU refuses is named: which variable, and what the FMU says.
#[test]
fn a_refused_value_names_its_variable() {
    let Some(fmu) = probe("2") else { return };
    let parameters = vec![("x_rpm".into(), Value::Number(1.0))];
    let error = run(&fmu, &RunOptions { parameters, ..RunOptions::default() }).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("set Float64 `x_rpm`") && error.contains("cannot set 11"), "{error}");
}
