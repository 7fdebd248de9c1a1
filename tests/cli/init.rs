//! `init`: a first drive file that reads, simulates and says what to fill in.

use crate::{done, folder, put, refused};

#[test]
fn a_recording_becomes_a_drive_that_runs() {
    let here = folder();
    let input = "12 * sin(2 * t) + 6 * sin(7 * t) + 4 * sign(sin(20 * t))";
    done(
        here.path(),
        &["simulate", "dr300", "--duration", "8", "--input", input, "-o", "bench.csv"],
    );
    let answer =
        done(here.path(), &["init", "bench.csv", "-o", "first.toml", "--json", "-"]).json();
    assert_eq!((&answer["motion"], &answer["input"]), (&"rotary".into(), &"voltage".into()));
    let value = |name: &str| {
        let all = answer["parameters"].as_array().expect("a list");
        all.iter().find(|p| p["name"] == name).and_then(|p| p["value"].as_f64()).expect("a value")
    };
    assert!((value("R") / 3.13 - 1.0).abs() < 0.02, "{}", value("R"));
    assert!((value("J") / 8.2e-5 - 1.0).abs() < 0.05, "{}", value("J"));
    let replay = ["simulate", "first.toml", "--measured", "bench.csv", "-o", "model.csv"];
    let fit = done(here.path(), &[&replay[..], &["--json", "-"]].concat()).json();
    let omega = fit["fit"].as_array().expect("a list").iter().find(|fit| fit["signal"] == "omega");
    assert!(omega.and_then(|fit| fit["percent"].as_f64()).is_some_and(|p| p > 98.0), "{fit}");
    done(here.path(), &["export", "first.toml", "-o", "first.fmu"]);
}

#[test]
fn what_a_recording_does_not_tell_is_marked() {
    let here = folder();
    let rows: String = (0..200).map(|k| format!("{},{},{}\n", 0.01 * f64::from(k), 6, k)).collect();
    put(here.path(), "log.csv", format!("time [s],u [V],speed [rpm]\n{rows}"));
    let ran = done(here.path(), &["init", "log.csv", "-o", "first.toml"]);
    assert!(ran.out.contains("fill in R"), "{}", ran.out);
    let text = std::fs::read_to_string(here.path().join("first.toml")).expect("it was written");
    assert!(text.contains("FILL IN") && text.contains("kind = \"coulomb\""), "{text}");
    done(
        here.path(),
        &["simulate", "first.toml", "--input", "6", "--duration", "0.1", "-o", "a.csv"],
    );
}

#[test]
fn what_is_no_recording_of_a_drive_is_refused() {
    let here = folder();
    for (text, said) in [
        ("time [s],u [V]\n0,1\n0.1,2\n0.2,1\n", "neither speed nor position"),
        ("time [s],omega [rad/s]\n0,1\n0.1,2\n0.2,1\n", "`u`"),
        ("time [s],u [V],omega [rad/s]\n0,1,2\n", "one sample"),
        ("time [s],u [V],omega [rad/s]\n0,1,2\n0.1,1,\n0.2,1,2\n", "log.csv:3"),
        ("", "log.csv"),
    ] {
        put(here.path(), "log.csv", text);
        let message = refused(here.path(), &["init", "log.csv", "-o", "first.toml"]);
        assert!(message.contains(said), "{text:?}: {message}");
    }
}
