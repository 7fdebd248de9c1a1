//! `simulate`: typed runs, runs driven by a recording, and what they refuse.

use std::path::Path;

use crate::{column, done, folder, put, refused};

#[test]
fn the_closed_loop_reaches_its_reference() {
    let here = folder();
    let arguments = ["simulate", "dr300", "--duration", "2", "-o", "a.csv", "--json", "-"];
    let answer = done(here.path(), &arguments).json();
    assert_eq!((&answer["samples"], &answer["period"]), (&401.into(), &0.005.into()));
    let tacho = column(here.path(), "a.csv", "T [rpm]");
    let late = &tacho[200..];
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    assert!((mean - 2000.0).abs() < 5.0, "{mean}");
    // The tachometer reads in steps of 2 rpm.
    assert!(tacho.iter().all(|t| (t / 2.0 - (t / 2.0).round()).abs() < 1e-9));
    assert_eq!(column(here.path(), "a.csv", "time [s]").last(), Some(&2.0));
}

#[test]
fn the_seed_decides_the_noise() {
    let here = folder();
    let bytes = |file: &str, more: &[&str]| {
        let run = ["simulate", "dr300", "--duration", "0.5", "-o", file];
        done(here.path(), &[&run, more].concat());
        std::fs::read(here.path().join(file)).expect("it was written")
    };
    let first = bytes("a.csv", &["--seed", "7"]);
    assert_eq!(first, bytes("b.csv", &["--seed", "7"]));
    assert_ne!(first, bytes("c.csv", &["--seed", "8"]));
    let quiet = bytes("d.csv", &["--noise", "off", "--seed", "7"]);
    assert_eq!(quiet, bytes("e.csv", &["--noise", "off", "--seed", "8"]));
}

#[test]
fn a_fault_acts_in_its_span() {
    let here = folder();
    let run = ["simulate", "dr300", "--noise", "off", "--duration", "4", "-o", "a.csv"];
    done(here.path(), &[&run[..], &["--fault", "tacho=10%@2..3"]].concat());
    let (tacho, control) =
        (column(here.path(), "a.csv", "T [rpm]"), column(here.path(), "a.csv", "C_m [V]"));
    assert!(
        (tacho[399] - 2000.0).abs() < 1.0 && tacho[400] > 2150.0,
        "{} {}",
        tacho[399],
        tacho[400]
    );
    // A tachometer that shows too much slows the drive down: less control signal.
    assert!(control[590] < 0.95 * control[399], "{} {}", control[590], control[399]);
    assert!((control[800] - control[399]).abs() < 0.01 * control[399]);
}

#[test]
fn a_load_takes_current() {
    let here = folder();
    let run = ["simulate", "dr300", "--noise", "off", "--duration", "3", "-o", "a.csv"];
    done(here.path(), &[&run[..], &["--load", "0.03 * (1 + sign(t - 1.5)) / 2"]].concat());
    let current = column(here.path(), "a.csv", "i [A]");
    // 0.03 N m over 0.06 N m/A.
    assert!((current[600] - current[299] - 0.5).abs() < 5e-3, "{} {}", current[600], current[299]);
    assert_eq!(column(here.path(), "a.csv", "T_l [N m]")[600], 0.03);
}

/// An open-loop run without noise to replay.
fn bench(folder: &Path) {
    let input = "12 * sin(2 * t) + 6 * sin(7 * t)";
    let run = ["simulate", "dr300", "--noise", "off", "--duration", "2", "-o", "bench.csv"];
    done(folder, &[&run[..], &["--input", input]].concat());
}

#[test]
fn a_replay_of_its_own_run_fits() {
    let here = folder();
    bench(here.path());
    let replay = ["simulate", "dr300", "--measured", "bench.csv", "-o", "model.csv"];
    let answer = done(here.path(), &[&replay[..], &["--json", "-", "--quiet"]].concat()).json();
    for fit in answer["fit"].as_array().expect("a list") {
        assert!(fit["percent"].as_f64().is_some_and(|percent| percent > 99.99), "{fit}");
    }
    let (measured, model) = ("bench.csv", "model.csv");
    let time = "time [s]";
    assert_eq!(column(here.path(), measured, time), column(here.path(), model, time));
}

#[test]
fn a_replay_takes_foreign_names_and_says_what_is_missing() {
    let here = folder();
    put(here.path(), "log.csv", "Seconds,Volts,Speed\n0,6,0\n0.01,6,60\n0.02,6,110\n0.03,6,150\n");
    let replay = ["simulate", "dr300", "--measured", "log.csv", "-o", "model.csv"];
    let named = ["--columns", "time=Seconds:s,u=Volts:V,omega=Speed:rpm"];
    let answer = done(here.path(), &[&replay[..], &named, &["--json", "-"]].concat()).json();
    assert_eq!(answer["fit"][0]["signal"], "omega");
    assert_eq!(answer["fit"][0]["unit"], "rad/s");
    let message =
        refused(here.path(), &[&replay[..], &["--columns", "time=Seconds:s,a=Volts"]].concat());
    assert!(message.contains("log.csv") && message.contains("`u`"), "{message}");
    put(here.path(), "holes.csv", "time [s],u [V]\n0,6\n0.01,\n0.02,6\n0.03,6\n");
    let replay = ["simulate", "dr300", "--measured", "holes.csv", "-o", "model.csv"];
    let message = refused(here.path(), &replay);
    assert!(message.contains("holes.csv:3") && message.contains("`u`"), "{message}");
}

#[test]
fn wrong_runs_are_refused_before_anything_is_written() {
    let here = folder();
    put(here.path(), "file", "");
    for (more, said) in [
        (&["-o", "none/a.csv"][..], "none/a.csv"),
        (&["-o", "file/a.csv"], "file/a.csv"),
        (&["-o", "."], "."),
        (&["-o", "a.xyz"], "a.xyz"),
        (&["-o", "a.csv", "--reference", "200 +"], "--reference"),
        (&["-o", "a.csv", "--reference", "1 / (t - 1)"], "t = 1 s"),
        (&["-o", "a.csv", "--reference", "3 [V]"], "`V`"),
        (&["-o", "a.csv", "--load", "omega"], "`omega`"),
        (&["-o", "a.csv", "--fault", "taco=1"], "`taco`"),
        (&["-o", "a.csv", "--fault", "tacho=5@9"], "run of 5 s"),
        (&["-o", "a.csv", "--fault", "tacho=5@2.001..2.002"], "no sample"),
        (&["-o", "a.csv", "--duration", "-1"], "--duration"),
        (&["-o", "a.csv", "--duration", "1e300"], "--duration"),
        (&["-o", "a.csv", "--period", "0.001"], "0.005"),
        (&["-o", "a.csv", "--period", "0"], "--period"),
        (&["-o", "a.csv", "--measured", "none.csv"], "none.csv"),
    ] {
        let message = refused(here.path(), &[&["simulate", "dr300"], more].concat());
        assert!(message.contains(said), "{more:?}: {message}");
    }
    let message = refused(here.path(), &["simulate", "emps", "-o", "a.csv"]);
    assert!(message.contains("--input"), "{message}");
}

#[test]
fn a_linear_axis_has_its_own_names() {
    let here = folder();
    let run = ["simulate", "emps", "--duration", "0.5", "-o", "a.csv", "--input", "2 * sin(9 * t)"];
    done(here.path(), &run);
    assert!(column(here.path(), "a.csv", "x [m]").iter().any(|x| *x > 0.0));
    assert_eq!(column(here.path(), "a.csv", "v [m/s]").len(), 501);
}
