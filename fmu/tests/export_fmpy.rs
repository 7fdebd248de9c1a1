//! The example FMU through fmpy, the independent importer: `tools/check_export.py` for FMI 2.0
//! and 3.0.
//!
//! Needs a Python with fmpy: `DRIVESCOPE_PYTHON`, or `.venv/bin/python` of the repository.
#![cfg(feature = "export")]

use std::path::{Path, PathBuf};
use std::process::Command;

use drivescope_fmu::archive::{Archive, Platform};
use drivescope_fmu::description::Version;
use drivescope_fmu::export::Model;

mod oscillator;

fn python() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    std::env::var_os("DRIVESCOPE_PYTHON").map_or(root.join(".venv/bin/python"), PathBuf::from)
}

#[test]
fn fmpy_finds_nothing_wrong_with_the_example() {
    let python = python();
    assert!(python.exists(), "NOT RUN: no Python at {python:?}; set DRIVESCOPE_PYTHON");
    let library = oscillator::library();
    let description = oscillator::model::Oscillator::instantiate(None).unwrap().description();
    let platform = Platform::host().expect("a platform of FMI");
    let folder = tempfile::tempdir().unwrap();
    let archive = Archive {
        description: &description,
        libraries: vec![(platform, &library)],
        resources: vec![("readme.txt".into(), b"The oscillator reads nothing.")],
        documentation: vec![("index.html".into(), b"<p>A mass on a spring with dry friction.</p>")],
    };
    let mut command = Command::new(python);
    command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools/check_export.py"));
    for (version, name) in [(Version::Two, "oscillator2.fmu"), (Version::Three, "oscillator3.fmu")]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, archive.to_bytes(version).unwrap()).unwrap();
        command.arg(path);
    }
    let output = command.output().expect("Python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    println!("{text}");
    assert!(output.status.success(), "{text}\n{errors}");
    // Each FMU was looked at: the script itself cannot pass by skipping.
    assert_eq!(text.matches("fmpy validates without a message").count(), 2, "{text}");
    assert_eq!(text.matches("roll back and replay, bit-equal").count(), 2, "{text}");
}
