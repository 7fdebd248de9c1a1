//! A diagnoser as an FMU: it decides as `diagnose` does on the same rows, to the bit.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::bank::{live, simulated, trained};
use crate::{column, done, folder, put, refused};

const ILL: [&str; 6] =
    ["--duration", "12", "--reference", "2000 [rpm]", "--fault", "flux=-10%@8..10"];

/// The column of that name, whatever its unit.
fn output(here: &Path, file: &str, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(here.join(file)).expect("it was written");
    let header = text.lines().next().expect("a header");
    let is_it = |it: &&str| it.split(" [").next() == Some(name);
    column(here, file, header.split(',').find(is_it).expect("a column"))
}

/// Rows at which the number of faults that were declared rises, with code, size and interval.
fn declared(here: &Path, file: &str, prefix: &str) -> Vec<(usize, [f64; 4])> {
    let of = |name: &str| output(here, file, &format!("{prefix}{name}"));
    let alarms = of("alarms");
    let stated = ["mechanism", "size", "size_lower", "size_upper"].map(of);
    (1..alarms.len())
        .filter(|k| alarms[*k] > alarms[k - 1])
        .map(|k| (k, std::array::from_fn(|which| stated[which][k])))
        .collect()
}

/// The mechanisms of a trained bank, in the order of their codes.
fn codes(answer: &Value) -> Vec<&str> {
    let confusions = answer["bank"]["confusions"].as_array().expect("a list");
    confusions.iter().map(|it| it["mechanism"].as_str().expect("a name")).collect()
}

/// The same of the lines of a live run, rows counted by their times.
fn judged(lines: &[Value], codes: &[&str]) -> Vec<(usize, [f64; 4])> {
    let number = |value: &Value| value.as_f64().unwrap_or(0.0);
    let of = |line: &Value| {
        let row = (number(&line["time"]) / 0.005).round() as usize;
        let code = codes
            .iter()
            .position(|code| line["mechanism"] == **code)
            .map_or(-1.0, |at| at as f64 + 1.0);
        let interval = [0, 1].map(|k| number(&line["interval"][k]));
        (row, [code, number(&line["size"]), interval[0], interval[1]])
    };
    lines.iter().filter(|line| line["decision"] == "judged").map(of).collect()
}

#[test]
fn an_exported_diagnoser_decides_as_the_program_does() {
    let here = folder();
    let here = here.path();
    let answer = trained(here);
    let codes = codes(&answer);
    simulated(here, "ill.csv", 12, &ILL);
    let expected = judged(&live(here, "ill.csv"), &codes);
    assert_eq!(expected.len(), 1, "{expected:?}");
    for fmi in ["2", "3"] {
        let fmu = format!("rig{fmi}.fmu");
        let export = ["export", "rig.toml", "-o", &fmu, "--fmi", fmi, "--json", "-", "--quiet"];
        let exported = done(here, &export).json();
        assert_eq!((&exported["learns_for"], &exported["states"]), (&5.0.into(), &0.into()));
        let checked = done(here, &["fmu", "validate", &fmu, "--check", "--json", "-"]).json();
        assert_eq!(checked, serde_json::json!([]));
        let run = ["fmu", "run", &fmu, "--input", "ill.csv", "--stop", "12", "-o", "out.csv"];
        done(here, &[&run[..], &["--quiet"]].concat());
        // The outputs at a communication point are those of the row before it.
        let found: Vec<_> =
            declared(here, "out.csv", "").into_iter().map(|(k, of)| (k - 1, of)).collect();
        assert_eq!(found, expected, "FMI {fmi}");
    }
    // Its machine stored in it: it watches from the first row on.
    let export = ["export", "rig.toml", "-o", "known.fmu", "--baseline", "h1.csv", "--json", "-"];
    let exported = done(here, &export).json();
    assert_eq!(exported["learns_for"], Value::Null, "{exported}");
    let run = ["fmu", "run", "known.fmu", "--input", "ill.csv", "--stop", "1", "-o", "out.csv"];
    done(here, &run);
    assert_eq!(output(here, "out.csv", "decision")[5], 1.0);
    let message = refused(here, &["export", "dr300", "-o", "x.fmu", "--baseline", "h1.csv"]);
    assert!(message.contains("belongs to a diagnoser"), "{message}");
    simulated(here, "rest.csv", 4, &["--duration", "6", "--reference", "0 [rpm]"]);
    let message = refused(here, &["export", "rig.toml", "-o", "x.fmu", "--baseline", "rest.csv"]);
    assert!(message.contains("at rest") && !here.join("x.fmu").exists(), "{message}");
    let message =
        refused(here, &["fmu", "run", "rig3.fmu", "--step", "0.02", "--stop", "1", "-o", "o.csv"]);
    assert!(message.contains("passes over samples"), "{message}");
}

/// Noise as the rig has it, from outside as the drive's FMU takes it.
fn noise(samples: usize) -> String {
    let mut state = 99_u64;
    let mut uniform = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut normal = move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let mut text =
        "time [s],noise_T [rpm],noise_I_m [A],noise_T_l [N m],reference [rad/s],fault_tacho [1]\n"
            .to_owned();
    let (remainder, mut load) = ((-0.005_f64 / 0.05).exp(), 0.0);
    for k in 0..samples {
        load = remainder * load + (1.0 - remainder * remainder).sqrt() * 1e-3 * normal();
        let fault = if k >= 1600 { 0.05 } else { 0.0 };
        let (tacho, current) = (3.0 * normal(), 0.01 * normal());
        let time = 0.005 * k as f64;
        let _ = writeln!(text, "{time:.3},{tacho},{current},{load},209.44,{fault}");
    }
    text
}

#[test]
fn plant_and_diagnoser_run_connected_with_the_alarms_of_the_recorded_signals() {
    let here = folder();
    let here = here.path();
    let answer = trained(here);
    let codes = codes(&answer);
    done(here, &["export", "dr300", "-o", "plant.fmu", "--fmi", "2", "--quiet"]);
    done(here, &["export", "rig.toml", "-o", "watch.fmu", "--quiet"]);
    put(here, "noise.csv", noise(2401));
    let connect =
        |name: &str| format!("[[connect]]\nfrom = \"plant.{name}\"\nto = \"watch.{name}\"\n");
    let input = |name: &str| {
        format!(
            "[[input]]\nrecording = \"noise.csv\"\nsignal = \"{name}\"\nto = \"plant.{name}\"\n"
        )
    };
    let outside = ["noise_T", "noise_I_m", "noise_T_l", "reference", "fault_tacho"];
    let system = format!(
        "[experiment]\nstop = 12.0\nstep = 0.005\nalgorithm = \"jacobi\"\n\
         [[component]]\nname = \"plant\"\nfmu = \"plant.fmu\"\n\
         [[component]]\nname = \"watch\"\nfmu = \"watch.fmu\"\n{}{}",
        ["C_m", "T", "I_m"].map(connect).concat(),
        outside.map(input).concat()
    );
    put(here, "system.toml", system);
    done(here, &["cosim", "system.toml", "-o", "both.csv", "--quiet"]);
    let both = std::fs::read_to_string(here.join("both.csv")).expect("it was written");
    let (header, rows) = both.split_once('\n').expect("a header");
    put(here, "recorded.csv", format!("{}\n{rows}", header.replace("plant.", "")));
    let found: Vec<_> =
        declared(here, "both.csv", "watch.").into_iter().map(|(k, of)| (k - 1, of)).collect();
    let expected = judged(&live(here, "recorded.csv"), &codes);
    assert_eq!(found, expected);
    let tacho = codes.iter().position(|code| *code == "tacho").map(|at| at as f64 + 1.0);
    assert_eq!((expected.len(), Some(expected[0].1[0])), (1, tacho), "{expected:?}");
    assert!((expected[0].1[1] - 0.05).abs() < 0.005 && (1600..1800).contains(&expected[0].0));
}
