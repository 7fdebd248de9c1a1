//! What else `train` can be asked for: sizes by AIC, orders, the paper's search, bounds of every neuron.

use crate::diagnose::{heater, held, swinging};
use crate::{done, folder, put, refused};

const TRAIN: [&str; 10] = [
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
];

#[test]
fn models_are_chosen_and_bounded_as_asked() {
    let here = folder();
    let here = here.path();
    put(here, "one.csv", heater(held, 2500, 1, usize::MAX, 1.0));
    put(here, "two.csv", heater(held, 4000, 2, usize::MAX, 1.0));
    put(here, "open.csv", heater(swinging, 2500, 3, usize::MAX, 1.0));
    let train = |more: &[&str]| {
        done(here, &[&TRAIN[..], &["heater.toml", "--json", "-"], more].concat()).json()
    };
    let bounded = ["--orthants", "all", "--without", "recurrent"];
    let answer = train(&[&["--structure", "aic", "--orders", "aic"], &bounded[..]].concat());
    let rows = answer["structures"].as_array().expect("a list");
    assert_eq!(rows.len(), 16, "{answer}");
    let aic = |v1: u64, v2: u64, order: u64| {
        let of =
            |row: &&serde_json::Value| row["v1"] == v1 && row["v2"] == v2 && row["order"] == order;
        rows.iter().find(of).and_then(|row| row["aic"].as_f64()).expect("a row")
    };
    // One class of functions has one figure; the least of those is used that follow a healthy recording
    // as well as the best.
    assert_eq!(aic(1, 1, 1).to_bits(), aic(1, 6, 1).to_bits());
    let chosen = rows.iter().find(|row| row["chosen"] == true).expect("one");
    let [aic, healthy] =
        ["aic", "healthy"].map(|of| move |row: &serde_json::Value| row[of].as_f64());
    let narrowest = rows.iter().filter_map(healthy).fold(f64::INFINITY, f64::min);
    let close = rows.iter().filter(|row| healthy(row) <= Some(1.1 * narrowest));
    let least = close.filter_map(aic).fold(f64::INFINITY, f64::min);
    assert!(narrowest > 0.0 && aic(chosen) == Some(least), "{rows:?}");
    let model = &answer["process_model"];
    assert_eq!((&model["v1"], &model["order"]), (&chosen["v1"], &chosen["order"]));
    assert!(answer["bands"]["orders"][0].as_u64().is_some_and(|n_a| n_a > 0), "{answer}");
    // The same network as a locally recurrent one.
    let gmdh = &answer["gmdh"];
    assert!(gmdh["bounded_neurons"] == 1 && gmdh["vertices"].as_u64() > Some(1), "{gmdh}");
    assert!(gmdh["recurrent_difference"].as_f64().is_some_and(|by| by < 1e-9), "{gmdh}");
    // Every part is stored and runs.
    put(here, "well.csv", heater(held, 4000, 5, usize::MAX, 1.0));
    let found = done(here, &["diagnose", "heater.toml", "well.csv", "--json", "-"]).json();
    assert_eq!(found["verdict"], "healthy", "{found}");

    let ars = ["--search", "ars", "--structure", "1,1,1", "--orders", "2,3"];
    let answer = train(&[&ars[..], &["--without", "recurrent,gmdh"]].concat());
    assert_eq!(answer["bands"]["orders"], serde_json::json!([2, 3]), "{answer}");
    assert_eq!(answer["process_model"]["v1"], 1, "{answer}");

    for (wrong, said) in [
        (["--structure", "0,1,1"], "three numbers"),
        (["--orders", "20"], "two numbers"),
        (["--search", "luck"], "luck"),
        // Hidden neurons of a network that was retrained as a whole need not be bounded, and it is said.
        (["--uncertain", "every"], "do not bound the parameters"),
    ] {
        let message = refused(here, &[&TRAIN[..], &["heater.toml"], &wrong[..]].concat());
        assert!(message.contains(said), "{message}");
    }
}
