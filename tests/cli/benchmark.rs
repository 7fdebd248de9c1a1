//! `benchmark detection`: the figures hold, and those of broken detectors collapse.

use crate::{done, folder, refused};

#[test]
fn faults_are_detected_and_broken_detectors_collapse() {
    let here = folder();
    let arguments = ["benchmark", "detection", "--seeds", "3", "--seed", "5", "--json", "-"];
    let answer = done(here.path(), &arguments).json();
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
}

#[test]
fn nothing_to_judge_is_refused() {
    let here = folder();
    let message = refused(here.path(), &["benchmark", "detection", "--seeds", "0"]);
    assert!(message.contains("--seeds 0"), "{message}");
}
