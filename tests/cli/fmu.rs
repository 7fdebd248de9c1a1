//! `fmu` and `cosim`: exported drives come back, and FMUs that are damaged, hostile or foreign are
//! refused by name.

use std::io::{Cursor, Read, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use crate::{Ran, column, done, folder, program, put, refused};

/// The archive with its entries renamed; `None` drops one.
pub(crate) fn repacked(fmu: &[u8], rename: impl Fn(&str) -> Option<String>) -> Vec<u8> {
    let mut archive = ZipArchive::new(Cursor::new(fmu)).expect("it is an archive");
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for k in 0..archive.len() {
        let mut entry = archive.by_index(k).expect("an entry");
        let name = entry.name().expect("a name").into_owned();
        let Some(renamed) = rename(&name) else { continue };
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("it can be read");
        writer.start_file(renamed, SimpleFileOptions::default()).expect("it can be added");
        writer.write_all(&bytes).expect("it can be written");
    }
    writer.finish().expect("it can be finished").into_inner()
}

fn exported(folder: &Path, more: &[&str]) -> Vec<u8> {
    done(folder, &[&["export", "dr300", "-o", "a.fmu", "--quiet"], more].concat());
    std::fs::read(folder.join("a.fmu")).expect("it was written")
}

#[test]
fn an_exported_drive_is_described_and_valid() {
    for fmi in ["2", "3"] {
        let here = folder();
        exported(here.path(), &["--fmi", fmi]);
        let info = done(here.path(), &["fmu", "info", "a.fmu", "--json", "-"]).json();
        assert_eq!(info["name"], "AMIRA DR300");
        assert_eq!(info["interfaces"], serde_json::json!(["Co-Simulation", "Model Exchange"]));
        let text = done(here.path(), &["fmu", "info", "a.fmu"]).out;
        for word in ["fault_tacho", "coulomb.T_c", "directional derivatives", "N m"] {
            assert!(text.contains(word), "{word} is not in {text}");
        }
        let ran = done(here.path(), &["fmu", "validate", "a.fmu", "--check"]);
        assert!(ran.out.contains("nothing found"), "{}", ran.out);
    }
}

#[test]
fn an_exported_drive_runs_as_the_program_does() {
    for (fmi, kind, tolerance) in [
        // The same code over the same steps.
        ("2", "cs", 1e-12),
        ("3", "cs", 1e-12),
        // Another integrator, at the FMU's own tolerance of 1e-9.
        ("3", "me", 1e-6),
    ] {
        let here = folder();
        exported(here.path(), &["--fmi", fmi, "--open-loop"]);
        let input = "12 * sin(2 * t) + 6 * sin(7 * t)";
        let native = ["simulate", "dr300", "--noise", "off", "--duration", "1", "-o", "native.csv"];
        done(here.path(), &[&native[..], &["--input", input]].concat());
        let run = ["fmu", "run", "a.fmu", "--input", "native.csv", "-o", "fmu.csv"];
        let more = ["--stop", "1", "--step", "0.001", "--kind", kind];
        done(here.path(), &[&run[..], &more].concat());
        for name in ["i [A]", "theta [rad]"] {
            let native = column(here.path(), "native.csv", name);
            let fmu = column(here.path(), "fmu.csv", name);
            assert_eq!(native.len(), fmu.len());
            let scale = native.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let worst = native.iter().zip(&fmu).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst <= tolerance * scale, "FMI {fmi} {kind}, {name}: {}", worst / scale);
        }
    }
}

#[test]
fn damaged_hostile_and_foreign_fmus_are_refused_by_name() {
    let here = folder();
    let fmu = exported(here.path(), &["--fmi", "2"]);
    std::fs::remove_file(here.path().join("a.fmu")).expect("it can be removed");
    let same = |name: &str| Some(name.to_owned());
    let hostile = |name: &str| {
        if name.ends_with("drive.toml") { Some("../drive.toml".to_owned()) } else { same(name) }
    };
    let foreign = |name: &str| {
        Some(name.replace("linux64", "vms").replace("darwin64", "vms").replace("win64", "vms"))
    };
    let empty = |name: &str| (!name.ends_with("modelDescription.xml")).then(|| name.to_owned());
    let mut flipped = fmu.clone();
    for byte in flipped.iter_mut().skip(2000).take(4000) {
        *byte ^= 0x55;
    }
    for (name, bytes, said) in [
        ("text.fmu", b"no archive at all".to_vec(), "archive"),
        ("none.fmu", Vec::new(), "archive"),
        ("cut.fmu", fmu[..fmu.len() / 2].to_vec(), "archive"),
        ("flipped.fmu", flipped, ""),
        ("hostile.fmu", repacked(&fmu, hostile), ".."),
        ("empty.fmu", repacked(&fmu, empty), "modelDescription.xml"),
    ] {
        put(here.path(), name, bytes);
        for command in ["info", "validate"] {
            let message = refused_cleanly(here.path(), &["fmu", command, name]);
            assert!(message.contains(name) && message.contains(said), "{name}: {message}");
        }
    }
    put(here.path(), "foreign.fmu", repacked(&fmu, foreign));
    let message = refused_cleanly(here.path(), &["fmu", "run", "foreign.fmu", "-o", "a.csv"]);
    assert!(message.contains("foreign.fmu") && message.contains("vms"), "{message}");
    // It can be described all the same.
    done(here.path(), &["fmu", "info", "foreign.fmu"]);
    let message = refused_cleanly(here.path(), &["fmu", "info", "nothing.fmu"]);
    assert!(message.contains("nothing.fmu"), "{message}");
}

/// As [`refused`], and nothing stays in the folder for temporary files either.
fn refused_cleanly(here: &Path, arguments: &[&str]) -> String {
    let temporary = folder();
    let mut program = program(here);
    program.args(arguments).env("TMPDIR", temporary.path());
    let ran = Ran::of(program.output().expect("the program starts"));
    assert_eq!(ran.code, Some(2), "{arguments:?}: {}{}", ran.out, ran.err);
    assert_eq!(temporary.path().read_dir().expect("a folder").count(), 0, "{arguments:?}");
    refused(here, arguments)
}

#[test]
fn wrong_runs_of_an_fmu_are_refused() {
    let here = folder();
    exported(here.path(), &[]);
    put(here.path(), "other.csv", "time [s],foo [V]\n0,1\n0.1,2\n0.2,1\n");
    for (more, said) in [
        (&["--set", "nothing=1"][..], "nothing"),
        (&["--set", "R=-1"], "R"),
        (&["--set", "R=many"], "many"),
        (&["--set", "R"], "NAME=VALUE"),
        (&["--stop", "-1"], "-1"),
        (&["--step", "0"], "step"),
        (&["--input", "other.csv"], "reference"),
        (&["--kind", "both"], "both"),
    ] {
        let message =
            refused(here.path(), &[&["fmu", "run", "a.fmu", "-o", "a.csv"], more].concat());
        assert!(message.contains(said), "{more:?}: {message}");
    }
    let message = refused(here.path(), &["fmu", "run", "a.fmu", "-o", "none/a.csv"]);
    assert!(message.contains("none/a.csv"), "{message}");
}

#[test]
fn findings_are_forbidden_by_check_alone() {
    let here = folder();
    let fmu = exported(here.path(), &["--fmi", "3"]);
    // Without a binary for this platform it was not tried: a warning.
    let folder = |name: &str| {
        Some(
            name.replace("binaries/x86_64-", "binaries/vax-")
                .replace("binaries/aarch64-", "binaries/vax-"),
        )
    };
    put(here.path(), "b.fmu", repacked(&fmu, folder));
    let ran = done(here.path(), &["fmu", "validate", "b.fmu", "--json", "-"]);
    assert_eq!(ran.json()[0]["severity"], "warning");
    assert_eq!(crate::run(here.path(), &["fmu", "validate", "b.fmu", "--check"]).code, Some(1));
}

#[test]
fn one_drive_follows_another() {
    let here = folder();
    done(here.path(), &["export", "dr300", "--open-loop", "-o", "leader.fmu"]);
    done(here.path(), &["export", "dr300", "--fmi", "2", "-o", "follower.fmu"]);
    put(here.path(), "u.csv", "time [s],u [V]\n0,10\n1,10\n2,10\n");
    let system = "\
[experiment]
stop = 2.0
step = 0.005
[[component]]
name = \"leader\"
fmu = \"leader.fmu\"
[[component]]
name = \"follower\"
fmu = \"follower.fmu\"
[[connect]]
from = \"leader.omega\"
to = \"follower.reference\"
[[input]]
recording = \"u.csv\"
signal = \"u\"
to = \"leader.u\"
";
    put(here.path(), "pair.toml", system);
    let answer = done(here.path(), &["cosim", "pair.toml", "-o", "pair.csv", "--json", "-"]).json();
    assert_eq!((&answer["complete"], &answer["samples"]), (&true.into(), &401.into()));
    let last = |header: &str| *column(here.path(), "pair.csv", header).last().expect("a sample");
    let (leader, follower) = (last("leader.omega [rad/s]"), last("follower.omega [rad/s]"));
    assert!(leader > 100.0 && (leader / follower - 1.0).abs() < 0.01, "{leader} {follower}");

    put(here.path(), "pair.toml", system.replace("leader.omega", "leader.omego"));
    let message = refused(here.path(), &["cosim", "pair.toml", "-o", "other.csv"]);
    assert!(message.contains("pair.toml:10") && message.contains("omego"), "{message}");
    let message = refused(here.path(), &["cosim", "none.toml", "-o", "other.csv"]);
    assert!(message.contains("none.toml"), "{message}");
}
