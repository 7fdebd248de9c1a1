//! `fit`: the loop from a recording to a drive file with values, and what cannot be fitted.

use std::path::Path;

use serde_json::Value;

use crate::{column, done, folder, put, refused, run};

const INPUT: &str = "12 * sin(2 * t) + 6 * sin(7 * t) + 4 * sign(sin(20 * t))";
const OTHER: &str = "9 * sin(3 * t) + 7 * sign(sin(9 * t))";

/// DR300 with other values and a comment of its own.
fn wrong(folder: &Path) {
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let text = text.replace("R = 3.13 ", "R = 3.7 ").replace("J = 8.2e-5 ", "J = 7e-5 ");
    put(folder, "wrong.toml", text.replace("# ohm", "# ohm, from the plate"));
}

/// A recording without a random load, so that the model has all there is.
fn record(folder: &Path, name: &str, input: &str) {
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let text = text.replace("torque = 1.0e-3", "").replace("torque_time = 0.05", "");
    let text: String = text
        .lines()
        .filter(|line| !line.contains("noise.torque"))
        .flat_map(|l| [l, "\n"])
        .collect();
    put(folder, "truth.toml", text.replace("K_m = 0.06 ", "K_m = 0.0599 "));
    let period = ["--period", "0.001", "--duration", "4"];
    done(
        folder,
        &[&["simulate", "truth.toml", "--input", input, "-o", name][..], &period].concat(),
    );
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_recording_becomes_values_and_the_error_falls() {
    let here = folder();
    let here = here.path();
    wrong(here);
    record(here, "one.csv", INPUT);
    record(here, "two.csv", OTHER);
    let fit = ["fit", "wrong.toml", "one.csv", "--validate", "two.csv", "-o", "fitted.toml"];
    let answer = done(here, &[&fit[..], &["--json", "-"]].concat()).json();
    for (name, truth) in [("R", 3.13), ("J", 8.2e-5), ("K_e", 0.0599), ("coulomb.T_c", 0.016)] {
        let found = &answer["parameters"][name];
        let off = number(&found["value"]) - truth;
        assert!(off.abs() < 5.0 * number(&found["std_error"]), "{name}: {found}");
    }
    for (error, before) in [("error", "error"), ("validation_error", "validation_error")] {
        assert!((number(&answer[error]) - 1.0).abs() < 0.05, "{error}: {}", answer[error]);
        assert!(number(&answer["before"][before]) > 3.0, "{}", answer["before"]);
    }
    assert_eq!(
        (number(&answer["observer_hz"]), &answer["not_identifiable"]),
        (0.0, &Value::Array(vec![]))
    );
    assert!(answer["split"].as_str().is_some_and(|split| split.contains("two.csv")));
    let text = std::fs::read_to_string(here.join("fitted.toml")).expect("it was written");
    assert!(
        text.contains("# ohm, from the plate") && text.contains("R = \"fitted: one.csv;"),
        "{text}"
    );
    // The same seed gives the same bytes; the file is a drive that runs and can be fitted again.
    let again =
        done(here, &["fit", "wrong.toml", "one.csv", "--validate", "two.csv", "-o", "b.toml"]);
    assert!(
        again.out.contains("Standard") && again.out.contains("judged by two.csv"),
        "{}",
        again.out
    );
    assert_eq!(std::fs::read(here.join("b.toml")).expect("written"), text.into_bytes());
    let twice =
        done(here, &["fit", "fitted.toml", "one.csv", "two.csv", "-o", "c.toml", "--json", "-"]);
    let twice = twice.json();
    assert!(twice["split"].as_str().is_some_and(|s| s.contains("two.csv is held out")), "{twice}");
    assert!(number(&twice["before"]["error"]) < 1.05);
}

#[test]
fn holes_are_left_out_and_one_recording_is_split() {
    let here = folder();
    let here = here.path();
    wrong(here);
    record(here, "one.csv", INPUT);
    let text = std::fs::read_to_string(here.join("one.csv")).expect("recorded");
    let holed = text.lines().enumerate().map(|(k, line)| {
        let cells: Vec<&str> = line.split(',').collect();
        // time, u, i, omega, ..
        match k {
            500..600 => [cells[0], cells[1], cells[2], "", cells[4]].join(","),
            1200..1300 => [cells[0], "NaN", cells[2], cells[3], cells[4]].join(","),
            _ => cells[..5].join(","),
        }
    });
    put(here, "holed.csv", holed.collect::<Vec<_>>().join("\n"));
    let ran = done(here, &["fit", "wrong.toml", "holed.csv", "-o", "f.toml", "--json", "-"]);
    assert!(ran.err.contains("lines 501 to 600"), "{}", ran.err);
    let answer = ran.json();
    assert!((number(&answer["error"]) - 1.0).abs() < 0.05, "{answer}");
    assert!(answer["split"].as_str().is_some_and(|split| split.contains("last third")), "{answer}");
}

#[test]
fn a_constant_input_is_no_failure_but_said() {
    let here = folder();
    let here = here.path();
    wrong(here);
    record(here, "still.csv", "6");
    let ran = done(here, &["fit", "wrong.toml", "still.csv", "-o", "f.toml", "--json", "-"]);
    assert!(ran.err.contains("u is constant"), "{}", ran.err);
    let stated = ran.json();
    // The run-up from rest tells the rest.
    let kept = stated["not_identifiable"].as_array().expect("a list");
    assert!(kept.iter().any(|name| name == "B_m"), "{stated}");
    let doubts = stated["doubts"].as_array().expect("a list");
    let says = |doubt: &Value| doubt.as_str().is_some_and(|doubt| doubt.contains("record steps"));
    assert!(doubts.iter().any(says), "{stated}");
}

#[test]
fn what_cannot_be_fitted_is_refused_with_the_next_step() {
    let here = folder();
    let here = here.path();
    wrong(here);
    record(here, "one.csv", INPUT);
    let (time, u) = (column(here, "one.csv", "time [s]"), column(here, "one.csv", "u [V]"));
    let omega = column(here, "one.csv", "omega [rad/s]");
    let table = |header: &str, row: &dyn Fn(usize) -> String| {
        let rows = (0..time.len()).map(|k| row(k) + "\n");
        format!("{header}\n{}", rows.collect::<String>())
    };
    let fast = table("time [s],u [V],omega [rad/s]", &|k| {
        format!("{},{},{}", time[k], u[k], 60.0 * omega[k])
    });
    let backwards =
        table("time [s],u [V],omega [rad/s]", &|k| format!("{},{},{}", -time[k], u[k], omega[k]));
    let alone = table("time [s],u [V]", &|k| format!("{},{}", time[k], u[k]));
    let driven = table("time [s],omega [rad/s]", &|k| format!("{},{}", time[k], omega[k]));
    for (text, said) in [
        (fast, "looks like"),
        (backwards, "sort the rows by time"),
        (alone, "nothing to compare"),
        (driven, "--columns u=COLUMN"),
        ("time [s],u [V],omega [rad/s]\n".to_owned(), "log.csv"),
        ("time [s],u [V],omega [rad/s]\n0,1,2\n".to_owned(), "log.csv"),
        ("time [s],u [V],omega [rad/s]\n0,1,2\n0.1,1,2\n".to_owned(), "record for longer"),
        (String::new(), "log.csv"),
    ] {
        put(here, "log.csv", &text);
        let message = refused(here, &["fit", "wrong.toml", "log.csv", "-o", "f.toml"]);
        assert!(message.contains(said), "{}: {message}", text.lines().next().unwrap_or_default());
    }
    for (noise, said) in [("i=0", "`i=0`"), ("x=0.1", "`x`"), ("omega", "`omega`")] {
        let message =
            refused(here, &["fit", "wrong.toml", "one.csv", "-o", "f.toml", "--noise", noise]);
        assert!(message.contains(said), "{message}");
    }
    assert!(refused(here, &["fit", "wrong.toml", "-o", "f.toml"]).contains("<REC>"));
    assert_eq!(run(here, &["fit", "none.toml", "one.csv", "-o", "f.toml"]).code, Some(2));
}

/// Stiffness of the first joint of other people's arm as published, N m/rad, and what a fit may
/// differ from it by.
const STIFFNESS: (f64, f64) = (39.96, 0.3);

#[test]
fn the_load_s_position_tells_the_stiffness_of_a_real_joint() {
    let data = std::env::var_os("DRIVESCOPE_DATA");
    let file = data.map(|data| Path::new(&data).join("flexible_link/ctu_stage1.csv"));
    let Some(file) = file.filter(|file| file.exists()) else {
        println!("NOT RUN: DRIVESCOPE_DATA names no folder with flexible_link/");
        return;
    };
    let file = file.to_str().expect("a plain path");
    let here = folder();
    // The motor's constant of its data sheet, behind the gear.
    let begun = ["init", file, "-o", "first.toml", "--given", "K_m=11.9", "--json", "-"];
    let begun = done(here.path(), &begun).json();
    assert!(begun["fit"][1]["signal"] == "theta_load", "{begun}");
    done(here.path(), &["add", "first.toml", "flexible_coupling", file, "-o", "second.toml"]);
    let fitted = ["fit", "second.toml", file, "-o", "third.toml", "--json", "-"];
    let fitted = done(here.path(), &fitted).json();
    assert!(number(&fitted["error"]) < 600.0, "the twist was 1585 without it: {fitted}");
    let text = std::fs::read_to_string(here.path().join("third.toml")).expect("it was written");
    let table: toml::Table = text.parse().expect("it is TOML");
    let k = table["effect"]
        .as_array()
        .and_then(|all| all.iter().find_map(|it| it.get("k")?.as_float()))
        .expect("the coupling is there");
    let (published, off) = STIFFNESS;
    assert!((k / published - 1.0).abs() < off, "{k} N m/rad, published {published}");
}

/// Where the shaft is fast throughout, least squares on the balances find any Stribeck torque, and one that
/// would hold the shaft takes so many sub-steps that no search ends.
#[test]
fn a_loop_that_is_fast_throughout_is_fitted() {
    let here = folder();
    let here = here.path();
    let reference = "120 + 60 * sign(sin(1.5 * t))";
    let run = ["simulate", "dr300", "-o", "fast.csv", "--duration", "12", "--seed", "14"];
    done(here, &[&run[..], &["--reference", reference]].concat());
    let answer =
        done(here, &["fit", "dr300", "fast.csv", "-o", "fitted.toml", "--json", "-"]).json();
    let k_e = answer["parameters"]["K_e"]["value"].as_f64().expect("it is estimated");
    assert!((k_e / 0.0599 - 1.0).abs() < 0.01, "{answer}");
}

/// Samples of 5 ms are slow beside a winding of 1.6 ms: least squares on its balance explain it better with
/// another L, and the motion five times worse.
#[test]
fn a_fit_to_a_slowly_sampled_loop_does_not_raise_the_error() {
    let here = folder();
    let here = here.path();
    let run = ["simulate", "dr300", "-o", "steps.csv", "--duration", "8", "--seed", "3"];
    done(here, &[&run[..], &["--reference", "150 * sign(sin(2 * t))"]].concat());
    let answer =
        done(here, &["fit", "dr300", "steps.csv", "-o", "fitted.toml", "--json", "-"]).json();
    let error = |of: &Value| of["error"].as_f64().expect("a number");
    assert!(error(&answer) < error(&answer["before"]), "{answer}");
}
