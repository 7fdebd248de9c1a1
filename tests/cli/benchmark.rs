//! `benchmark detection`, `benchmark isolation` and `benchmark bank`: the figures hold, and those of broken detectors
//! collapse.

use crate::{done, folder, program, refused};

#[test]
fn faults_are_detected_and_broken_detectors_collapse() {
    let here = folder();
    let arguments = ["benchmark", "detection", "--seeds", "3", "--seed", "5", "--json", "-"];
    let curves = ["--machines", "6", "--healthy", "60000", "--keep", "kept"];
    let answer = done(here.path(), &[&arguments[..], &curves].concat()).json();
    let first = answer["first_seed"].as_u64().expect("a seed");
    assert!(first > answer["design_seed"].as_u64().expect("a seed"));
    let methods = answer["methods"].as_array().expect("a list");
    let mem = methods.iter().find(|rows| rows["method"] == "mem").expect("a method");
    assert_eq!(mem["all_detected"]["share"], 1.0, "{mem}");
    for row in mem["faults"].as_array().expect("twelve") {
        assert!(row["r_td"]["least"].as_f64().is_some_and(|r_td| r_td > 0.97), "{row}");
    }
    // Three runs of 4000 samples, neighbours alike: r_fd scatters by 0.01 about 0.05.
    let r_fd = mem["r_fd"]["mean"].as_f64().expect("a rate");
    assert!((r_fd - 0.05).abs() < 0.03, "{r_fd}");
    let broken = &answer["broken"];
    let value = |name: &str| broken[name].as_f64().expect("a rate");
    assert!(value("always_r_td") > 0.999 && value("always_r_fd") > 0.999, "{broken}");
    assert_eq!(broken["always_detected"]["hits"], 0, "{broken}");
    assert!(value("shuffled_r_td") < 0.15, "{broken}");
    assert_eq!(broken["shuffled_detected"]["hits"], 0, "{broken}");
    let curves = &answer["curves"];
    assert_eq!(curves["always"]["detected"][0]["hits"], 0, "{curves}");
    let detectors = curves["detectors"].as_array().expect("a list");
    assert_eq!(detectors.len(), 5, "{curves}");
    // At the limits for 1e5 samples: where nothing fails nothing is found, and the bank is first.
    let delay = |row: &serde_json::Value| row["faults"][0]["delay"][2]["mean"].as_f64();
    let of_bank = delay(&detectors[0]).expect("it detects a tachometer");
    for row in &detectors[1..] {
        let faults = row["faults"].as_array().expect("a list");
        let nothing = faults.last().expect("one");
        assert_eq!(
            (&nothing["mechanism"], &nothing["detected"][2]["hits"]),
            (&"nothing".into(), &0.into())
        );
        assert!(delay(row).is_none_or(|delay| delay > of_bank), "{row}");
    }
    // What detectors of other people are given.
    let manifest = std::fs::read_to_string(here.path().join("kept/manifest.json")).expect("kept");
    let manifest: serde_json::Value = serde_json::from_str(&manifest).expect("JSON");
    for file in manifest["files"].as_array().expect("a list") {
        let name = file["file"].as_str().expect("a name");
        let text = std::fs::read_to_string(here.path().join("kept").join(name)).expect("kept");
        assert!(text.starts_with("run,C_m [V],T [rpm],I_m [A]\n0,"), "{name}");
        let runs = text.lines().last().and_then(|row| row.split(',').next()?.parse::<usize>().ok());
        let onsets = file["onsets"].as_array().expect("a list").len();
        assert!(onsets == 0 || runs == Some(onsets - 1), "{file}");
    }
}

#[test]
fn classifiers_are_judged_on_other_noise_and_machines_beside_the_bank() {
    let here = folder();
    let arguments = ["benchmark", "isolation", "--designs", "1", "--seeds", "4", "--machines", "4"];
    let answer =
        done(here.path(), &[&arguments[..], &["--seed", "3", "--json", "-"]].concat()).json();
    let share = |of: &serde_json::Value| of["share"].as_f64().expect("a rate");
    let rows = answer["designs"][0]["classifiers"].as_array().expect("a list");
    assert_eq!(rows.len(), 4, "{answer}");
    for row in rows {
        assert!(share(&row["shuffled"]) < 0.2, "{row}");
        assert!(row["samples"]["mean"].as_f64().is_some_and(|mean| mean > 0.6), "{row}");
    }
    // Ten classes are fewer than twelve.
    let discriminant = |classes: &str| {
        let of = |row: &&serde_json::Value| {
            row["classifier"] == "discriminant" && row["classes"] == classes
        };
        rows.iter().find(of).and_then(|row| row["samples"]["mean"].as_f64()).expect("it is there")
    };
    assert!(discriminant("paper") >= discriminant("twelve"), "{answer}");
    assert!(share(&answer["bank"]["with_current"]["among_twelve"]) > 0.95, "{answer}");
    let message = refused(here.path(), &["benchmark", "isolation", "--designs", "0"]);
    assert!(message.contains("--designs 0"), "{message}");
}

#[test]
fn a_table_of_no_cases_is_refused() {
    let here = folder();
    let message = refused(here.path(), &["benchmark", "rule", "--cases", "0"]);
    assert!(message.contains("give 1 or more"), "{message}");
}

#[test]
fn the_bank_names_what_failed_on_machines_it_has_never_seen() {
    let here = folder();
    let arguments = ["benchmark", "bank", "--machines", "6", "--healthy", "80000"];
    let more = ["--designs", "1", "--seed", "3", "--quiet", "--json", "-"];
    let answer = done(here.path(), &[&arguments[..], &more].concat()).json();
    assert_ne!(answer["design_seed"], answer["judged_seed"]);
    let share = |of: &serde_json::Value| of["share"].as_f64().expect("a rate");
    // A miss of 72 is allowed: the published table has more machines.
    let with = &answer["classes"]["with_current"];
    assert!(share(&with["among_twelve"]) > 0.98, "{with}");
    assert!(share(&with["shuffled"]) < 0.1, "{with}");
    let without = &answer["classes"]["without_current"];
    assert!(share(&without["named"]) <= share(&with["named"]), "{without}");
    let all = &answer["mechanisms"]["rows"][0];
    assert!(share(&all["in_set"]) > 0.9 && share(&all["detected"]) > 0.6, "{all}");
    assert!(share(&answer["mechanisms"]["shuffled"]) < 0.2, "{answer}");
    let sizes = answer["mechanisms"]["sizes"].as_array().expect("a list");
    assert!(share(&sizes[0]["covered"]) > 0.85, "{}", sizes[0]);
    for row in answer["delays"].as_array().expect("a list") {
        for delay in row["delays"].as_array().expect("a list") {
            let mean = |of: &str| delay[of]["mean"].as_f64().expect("it was detected");
            // The limit is one on average: six machines scatter by some samples.
            assert!(mean("samples") > mean("known") - 5.0, "{row}");
        }
    }
    for row in answer["incipient"].as_array().expect("a list") {
        assert!(share(&row["in_time"]) > 0.8 && share(&row["always"]) == 0.0, "{row}");
    }
    assert!(share(&answer["unknown"]["unknown"]) > 0.85, "{}", answer["unknown"]);
    for row in answer["healthy"]["rows"].as_array().expect("a list") {
        let alarms = |k: usize| row["alarms"][k].as_u64().expect("a count");
        // Designed for 1e3 and 1e6 samples in 20,000: 20 and 0.02 are expected.
        assert!((1..60).contains(&alarms(0)) && alarms(3) <= 1, "{row}");
    }
    assert!(answer["bars"].as_array().is_some_and(|bars| bars.len() > 15));
    for (option, message) in [("--machines", "--machines 1"), ("--healthy", "--healthy 1:")] {
        let said = refused(here.path(), &["benchmark", "bank", option, "1"]);
        assert!(said.contains(message), "{said}");
    }
    let none = refused(here.path(), &["benchmark", "bank", "--designs", "0"]);
    assert!(none.contains("--designs 0"), "{none}");
}

#[test]
fn what_runs_cost_is_told_beside_other_programs() {
    let here = folder();
    // Python is not there: its figures are absent and the reason is said.
    let out = program(here.path())
        .args(["benchmark", "speed", "--short", "--out", "speed.html", "--json", "-", "--quiet"])
        .env("DRIVESCOPE_PYTHON", here.path().join("no_python"))
        .output()
        .expect("it runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let answer: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let number = |key: &str| answer[key].as_f64().expect("a number");
    assert!(answer["peers"]["scipy_s"].is_null(), "{}", answer["peers"]);
    let why = answer["peers"]["fmpy_why"].as_str().expect("a reason");
    assert!(why.contains("no_python"), "{why}");
    // Bounds that hold on any machine, whatever the build: a step takes longer than its arithmetic,
    // is closer to the reference than the other solver's, and no core is faster than 10 THz.
    assert!(number("lane_s") > number("lane_bound_s"), "{answer}");
    assert!(answer["machine"]["latency_s"].as_f64().expect("s") > 1e-13, "{answer}");
    let errors = [0, 1].map(|k| answer["errors"][k].as_f64().expect("rad/s"));
    assert!(errors[0] < errors[1] && errors[1] < 1e-3, "{errors:?}");
    let growth = answer["growth"].as_array().expect("a list");
    let of_samples = growth.iter().find(|it| it["over"] == "samples").expect("it is there");
    let run = |k: usize| of_samples["points"][k][1].as_f64().expect("us");
    assert!(run(2) > 3.0 * run(1) && run(1) > 3.0 * run(0), "{of_samples}");
    let page = std::fs::read_to_string(here.path().join("speed.html")).expect("it was written");
    assert!(page.contains("How costs grow") && page.contains("<svg"));
}

#[test]
fn nothing_to_judge_is_refused() {
    let here = folder();
    let message = refused(here.path(), &["benchmark", "detection", "--seeds", "0"]);
    assert!(message.contains("--seeds 0"), "{message}");
}
