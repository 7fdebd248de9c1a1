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
        let found = answer["where"].as_array().map_or(0, Vec::len);
        wrong
            .extend((found > 0).then(|| format!("{duration} s, seed {seed}: {}", answer["where"])));
    }
    // One in a hundred is the level; with lateness judged by what comes, eleven of these twelve.
    assert!(wrong.len() <= 1, "{wrong:#?}");
    let answer = done(here, &["discover", "dr300", "loop.csv", "--json", "-"]).json();
    assert_eq!(answer["verdict"], "none", "{answer}");
}
