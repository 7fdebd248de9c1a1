//! `study --hidden`: what an effect that the model lacks costs in the size of faults.

use crate::{done, folder, put, refused};

#[test]
fn a_hidden_effect_costs_sensitivity_and_adding_it_gives_it_back() {
    let here = folder();
    let here = here.path();
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let drag = "[[effect]]\nkind = \"quadratic_drag\"\nc = 4e-7\n\n[controller]";
    put(here, "drag.toml", text.replacen("[controller]", drag, 1));
    let study = ["study", "--drive", "drag.toml", "--out", "study", "--seed", "4", "--json", "-"];
    let hidden = ["--hidden", "quadratic_drag", "--hidden-machines", "4"];
    let answer = done(here, &[&study[..], &hidden].concat()).json();
    let found = &answer["hidden_effect"];
    let torque = |model: &str| found[model]["torque_noise"].as_f64().expect("N m");
    // What the model lacks it takes for a random load.
    assert!(torque("before") > 1.5 * torque("after"), "{found}");
    let size = |model: &str, mechanism: &str| {
        let rows = found[model]["mechanisms"].as_array().expect("a list");
        let row = rows.iter().find(|row| row["mechanism"] == mechanism).expect("it is tried");
        row["size"].as_f64().unwrap_or(f64::INFINITY)
    };
    assert!(size("before", "load") > 1.5 * size("after", "load"), "{found}");
    assert!(size("after", "tacho") < 0.05, "{found}");
    let page = std::fs::read_to_string(here.join("study/report.html")).expect("it was written");
    assert!(page.contains("What a hidden effect costs"), "the report shows it");

    let message = refused(here, &["study", "--out", "other", "--hidden", "cogging"]);
    assert!(message.contains("no such effect") && message.contains("coulomb"), "{message}");
    // Before any file is read.
    let none = ["study", "--drive", "absent.toml", "--hidden", "coulomb", "--hidden-machines", "0"];
    assert!(refused(here, &none).contains("--hidden-machines 0"));
    assert!(!here.join("other").exists());
}
