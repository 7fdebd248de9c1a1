//! Makes FMUs for the tests, and benchmarks, of the import side.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use drivescope_fmu::import::Fmu;
use zip::write::SimpleFileOptions;

/// The folder of the FMUs that tests make, below cargo's own folder for such things. Files are named
/// by their content, so a later run finds them again and nothing piles up.
fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("import");
    fs::create_dir_all(&folder).expect("a folder for tests");
    folder
}

/// The file of this name and content key, made if it is not there. It appears at once and whole: other
/// test processes may look for it at the same time.
fn made(key: &[&[u8]], name: &str, make: impl FnOnce(&Path) -> bool) -> Option<PathBuf> {
    let mut hasher = DefaultHasher::new();
    key.hash(&mut hasher);
    let home = folder().join(format!("{:016x}", hasher.finish()));
    let path = home.join(name);
    if path.exists() {
        return Some(path);
    }
    let work = tempfile::tempdir_in(folder()).expect("a temporary folder");
    if !make(&work.path().join(name)) {
        return None;
    }
    // Where another process was faster, its folder is as good.
    if fs::rename(work.path(), &home).is_ok() {
        let _moved_away = work.keep();
    }
    assert!(path.exists(), "{}", path.display());
    Some(path)
}

/// The probe's compiled binary for FMI "2" or "3"; `None` without a C compiler.
fn library(fmi: &str) -> Option<PathBuf> {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/data/probe.c");
    let text = fs::read(source).expect("the source");
    let name = format!("probe{}", std::env::consts::DLL_SUFFIX);
    made(&[&text, fmi.as_bytes()], &name, |to| {
        let version = format!("-DFMI={fmi}");
        let arguments =
            ["-O2", "-shared", "-fPIC", "-fvisibility=hidden", &version, source, "-lm", "-o"];
        match Command::new("cc").args(arguments).arg(to).output() {
            Ok(output) if output.status.success() => true,
            Ok(output) => panic!("probe.c: {}", String::from_utf8_lossy(&output.stderr)),
            Err(_) => false,
        }
    })
}

/// The folder of the binaries for this platform, as FMI 2.0 and 3.0 call it.
pub(crate) fn platform(fmi: &str) -> &'static str {
    match (fmi, cfg!(target_arch = "aarch64"), cfg!(target_os = "macos")) {
        ("2", false, false) => "linux64",
        ("2", false, true) => "darwin64",
        (_, true, false) => "aarch64-linux",
        (_, true, true) => "aarch64-darwin",
        (_, false, true) => "x86_64-darwin",
        _ => "x86_64-linux",
    }
}

/// The probe FMU (`data/probe.c`) of FMI "2" or "3"; `None` (and NOT RUN) without a C compiler.
pub(crate) fn probe(fmi: &str) -> Option<Fmu> {
    probe_with(fmi, |text| text)
}

/// The probe with a changed model description.
pub(crate) fn probe_with(fmi: &str, change: impl Fn(String) -> String) -> Option<Fmu> {
    Some(Fmu::open(probe_file(fmi, change)?).expect("the probe opens"))
}

/// The probe's file.
pub(crate) fn probe_file(fmi: &str, change: impl Fn(String) -> String) -> Option<PathBuf> {
    let Some(library) = library(fmi) else {
        println!("NOT RUN: no C compiler `cc` for the probe FMU");
        return None;
    };
    let binary = fs::read(library).expect("compiled");
    let name = format!("binaries/{}/probe{}", platform(fmi), std::env::consts::DLL_SUFFIX);
    let xml = match fmi {
        "2" => include_str!("data/probe2.xml"),
        _ => include_str!("data/probe3.xml"),
    };
    let description = change(xml.to_owned());
    Some(archive(&[("modelDescription.xml", description.as_bytes()), (&name, &binary)]))
}

/// An FMU file with these entries.
pub(crate) fn archive(entries: &[(&str, &[u8])]) -> PathBuf {
    let key: Vec<&[u8]> =
        entries.iter().flat_map(|(name, bytes)| [name.as_bytes(), *bytes]).collect();
    let file = made(&key, "probe.fmu", |to| {
        let mut zip = zip::ZipWriter::new(fs::File::create(to).expect("a file"));
        for (name, bytes) in entries {
            zip.start_file(*name, SimpleFileOptions::default()).expect("an entry");
            zip.write_all(bytes).expect("an entry");
        }
        zip.finish().is_ok()
    });
    file.expect("an archive")
}

/// Builds an FMU from a Python class with `pythonfmu` or `pythonfmu3`; `None` (and NOT RUN) where
/// they are not installed. The interpreter is `DRIVESCOPE_PYTHON`, or the workspace's `.venv`.
pub(crate) fn python_fmu(package: &str, class: &str, source: &str) -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../.venv/bin/python");
    let python = std::env::var_os("DRIVESCOPE_PYTHON").unwrap_or_else(|| beside.into());
    let there = Command::new(&python).args(["-c", &format!("import {package}")]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        println!("NOT RUN: no Python with {package}; set DRIVESCOPE_PYTHON to one");
        return None;
    }
    made(&[package.as_bytes(), source.as_bytes()], &format!("{class}.fmu"), |to| {
        let folder = to.parent().expect("a folder");
        let script = folder.join(format!("{}.py", class.to_lowercase()));
        fs::write(&script, source).expect("a script");
        let mut build = Command::new(&python);
        build.args(["-m", package, "build", "-f"]).arg(&script).arg("-d").arg(folder);
        let output = build.output().expect("it ran before");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        true
    })
}
