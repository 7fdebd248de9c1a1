//! `compare`: what it says of a right model and of one that lacks something.

use std::path::Path;

use crate::{done, folder, put, refused, run};

const INPUT: &str = "10 * sin(2 * t) + 5 * sin(7 * t) + 4 * sign(sin(9 * t))";

/// The drive without random load, and the same with a torque that repeats with the angle.
fn drives(folder: &Path) {
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let text = text.replace("torque = 1.0e-3", "").replace("torque_time = 0.05", "");
    let kept = text.lines().filter(|line| !line.contains("noise.torque"));
    let text: String = kept.flat_map(|line| [line, "\n"]).collect();
    let hidden = "[[effect]]\nkind = \"cogging\"\na = 0.005\nb = 0.0\nN = 4\n\n[controller]";
    put(folder, "hidden.toml", text.replacen("[controller]", hidden, 1));
    put(folder, "base.toml", text);
}

fn record(folder: &Path, drive: &str, name: &str) {
    let usual = ["--period", "0.001", "--duration", "5", "--input", INPUT];
    done(folder, &[&["simulate", drive, "-o", name][..], &usual].concat());
}

#[test]
fn a_missing_effect_is_seen_and_forbidden_by_check() {
    let here = folder();
    let here = here.path();
    drives(here);
    record(here, "hidden.toml", "cogging.csv");
    let compare = ["compare", "base.toml", "cogging.csv", "--out", "report.html"];
    let answer = done(here, &[&compare[..], &["--json", "-"]].concat()).json();
    let first = &answer["where"][0];
    assert_eq!(first["variable"], "theta", "{}", answer["where"]);
    assert!(first["p_value"].as_f64().is_some_and(|p| p < 1e-3), "{first}");
    let period = first["period"].as_f64().expect("it repeats");
    assert!((period - std::f64::consts::TAU / 4.0).abs() < 1e-9, "{period}");
    assert!(answer["before"]["error"].as_f64().is_some_and(|error| error > 1.0));
    assert_eq!(answer["noise"]["source"], "given");
    let page = std::fs::read_to_string(here.join("report.html")).expect("it was written");
    assert!(page.contains("The model fails over theta") && !page.contains("<script"));
    let checked = run(here, &["compare", "base.toml", "cogging.csv", "--check"]);
    assert_eq!(checked.code, Some(1), "{}", checked.err);
}

#[test]
fn a_right_model_passes_the_check() {
    let here = folder();
    let here = here.path();
    drives(here);
    record(here, "base.toml", "healthy.csv");
    let text = done(here, &["compare", "base.toml", "healthy.csv", "--check"]).out;
    assert!(text.contains("down to their noise"), "{text}");
}

/// To first order the parameters of such a model leave errors of their own, beside which a law is hardly
/// seen: it is fitted to see where it fails.
#[test]
fn a_model_with_wrong_values_fails_where_the_fitted_one_does() {
    let here = folder();
    let here = here.path();
    drives(here);
    let text = std::fs::read_to_string(here.join("base.toml")).expect("it was written");
    let plate =
        [("R = 3.13", "R = 3.6"), ("K_e = 0.0599", "K_e = 0.067"), ("J = 8.2e-5", "J = 9.6e-5")];
    let off =
        plate.iter().fold(text.clone(), |text, (right, wrong)| text.replacen(right, wrong, 1));
    assert_ne!(off, text);
    put(here, "plate.toml", off);
    for (machine, found) in [("base.toml", None), ("hidden.toml", Some("theta"))] {
        record(here, machine, "run.csv");
        let answer = done(here, &["compare", "plate.toml", "run.csv", "--json", "-"]).json();
        assert_eq!(answer["where"][0]["variable"].as_str(), found, "{}", answer["where"]);
        assert_eq!(answer["fitted"], false, "{answer}");
        let number = |value: &serde_json::Value| value.as_f64().expect("a number");
        let (error, fitted) =
            (number(&answer["before"]["error"]), number(&answer["error_if_fitted"]));
        assert!(error > 10.0 && fitted < 0.3 * error, "{error} {fitted}");
        assert!(fitted < 1.1 || found.is_some(), "{fitted}");
        let verdict = answer["verdict"].as_str().unwrap_or_default();
        assert_eq!(verdict.contains("the values of its parameters"), found.is_none(), "{verdict}");
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let here = folder();
    let here = here.path();
    put(here, "none.csv", "time [s],u [V]\n0,1\n0.001,1\n0.002,1\n");
    let said = refused(here, &["compare", "dr300", "none.csv"]);
    assert!(said.contains("none.csv"), "{said}");
}

/// The loop answers the noise of its sensors, and a random load is in the recording: neither is a fault of
/// the model that made it.
#[test]
fn a_model_is_not_wrong_about_the_loop_that_it_made() {
    let here = folder();
    let here = here.path();
    let mut wrong = Vec::new();
    for (duration, seed) in
        ["5", "20"].into_iter().flat_map(|it| (1..7).map(move |seed| (it, seed)))
    {
        let seed = seed.to_string();
        let run = ["simulate", "dr300", "-o", "loop.csv", "--duration", duration, "--seed", &seed];
        done(here, &run);
        let answer = done(here, &["compare", "dr300", "loop.csv", "--json", "-"]).json();
        let verdict = answer["verdict"].as_str().unwrap_or_default();
        assert!(!verdict.contains("the values of its parameters"), "{verdict}");
        let found = answer["where"].as_array().map_or(0, Vec::len);
        wrong
            .extend((found > 0).then(|| format!("{duration} s, seed {seed}: {}", answer["where"])));
    }
    // One in a hundred is the level; with lateness judged by what comes, eleven of these twelve.
    assert!(wrong.len() <= 1, "{wrong:#?}");
    let answer = done(here, &["discover", "dr300", "loop.csv", "--json", "-"]).json();
    assert_eq!(answer["verdict"], "none", "{answer}");
}

/// Only these columns of a recording.
fn keep(folder: &Path, name: &str, columns: &[&str]) {
    let text = std::fs::read_to_string(folder.join(name)).expect("it was written");
    let header: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let places: Vec<usize> =
        columns.iter().filter_map(|it| header.iter().position(|column| column == it)).collect();
    assert_eq!(places.len(), columns.len(), "{header:?}");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.iter().map(|it| cells[*it]).collect::<Vec<_>>().join(",") + "\n"
    };
    put(folder, name, text.lines().map(row).collect::<String>());
}

/// Of a position alone the model follows by an observer, through which a random load leaves an error
/// that depends on how the shaft moves: that is no fault of the model, and does not hide one.
#[test]
fn what_an_observer_leaves_is_no_finding() {
    let here = folder();
    let here = here.path();
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let hidden = "[[effect]]\nkind = \"cogging\"\na = 0.006\nb = 0.0\nN = 4\n\n[controller]";
    put(here, "hidden.toml", text.replacen("[controller]", hidden, 1));
    let record = |drive: &str, input: &str, seed: &str| {
        let run = ["simulate", drive, "-o", "x.csv", "--duration", "10"];
        done(here, &[&run[..], &["--input", input, "--seed", seed]].concat());
        keep(here, "x.csv", &["time [s]", "u [V]", "theta [rad]"]);
        let answer = done(here, &["compare", "dr300", "x.csv", "--json", "-"]).json();
        assert_eq!(answer["observer_hz"], 10.0, "{answer}");
        answer["where"].clone()
    };
    let inputs = ["8*sin(2*t) + 5*sin(5.3*t)", "4*sin(9*t) + 7*sin(1.3*t)", "10*sign(sin(1.7*t))"];
    let mut wrong = Vec::new();
    for (seed, input) in inputs.iter().cycle().take(9).enumerate() {
        let found = record("dr300", input, &(40 + seed).to_string());
        wrong.extend((found != serde_json::json!([])).then(|| format!("{input}: {found}")));
    }
    // Without the filter, five or more of these nine.
    assert!(wrong.len() <= 1, "{wrong:#?}");
    let found = record("hidden.toml", inputs[0], "50");
    assert_eq!(found[0]["variable"], "theta", "{found}");
}
