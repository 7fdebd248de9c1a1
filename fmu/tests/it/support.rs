//! Makes FMUs for the tests, and benchmarks, of the import side.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use drivescope_fmu::import::Fmu;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;

/// A folder for the test run's FMUs, and the compiled binaries of the probe.
struct Shop {
    folder: TempDir,
    compiler: bool,
}

fn shop() -> &'static Shop {
    static SHOP: OnceLock<Shop> = OnceLock::new();
    SHOP.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let compiler = ["2", "3"].iter().all(|fmi| compile(fmi, &library(folder.path(), fmi)));
        Shop { folder, compiler }
    })
}

fn library(folder: &Path, fmi: &str) -> PathBuf {
    folder.join(format!("probe{fmi}{}", std::env::consts::DLL_SUFFIX))
}

fn compile(fmi: &str, to: &Path) -> bool {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/data/probe.c");
    let arguments = [
        "-O2",
        "-shared",
        "-fPIC",
        "-fvisibility=hidden",
        &format!("-DFMI={fmi}"),
        source,
        "-lm",
        "-o",
    ];
    let run = Command::new("cc").args(arguments).arg(to).output();
    match run {
        Ok(output) if output.status.success() => true,
        Ok(output) => panic!("probe.c: {}", String::from_utf8_lossy(&output.stderr)),
        Err(_) => false,
    }
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
    if !shop().compiler {
        println!("NOT RUN: no C compiler `cc` for the probe FMU");
        return None;
    }
    let binary = fs::read(library(shop().folder.path(), fmi)).expect("compiled");
    let name = format!("binaries/{}/probe{}", platform(fmi), std::env::consts::DLL_SUFFIX);
    let xml = match fmi {
        "2" => include_str!("data/probe2.xml"),
        _ => include_str!("data/probe3.xml"),
    };
    let description = change(xml.to_owned());
    Some(archive(&[("modelDescription.xml", description.as_bytes()), (&name, &binary)]))
}

/// A new FMU file with these entries.
pub(crate) fn archive(entries: &[(&str, &[u8])]) -> PathBuf {
    let (file, path) = tempfile::Builder::new()
        .prefix("probe")
        .suffix(".fmu")
        .tempfile_in(shop().folder.path())
        .and_then(|file| file.keep().map_err(|error| error.error))
        .expect("a temporary file");
    let mut zip = zip::ZipWriter::new(file);
    for (name, bytes) in entries {
        zip.start_file(*name, SimpleFileOptions::default()).expect("an entry");
        zip.write_all(bytes).expect("an entry");
    }
    zip.finish().expect("an archive");
    path
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
    let folder = tempfile::tempdir_in(shop().folder.path()).expect("a temporary folder").keep();
    let script = folder.join(format!("{}.py", class.to_lowercase()));
    fs::write(&script, source).expect("a script");
    let output = Command::new(&python)
        .args(["-m", package, "build", "-f"])
        .arg(&script)
        .arg("-d")
        .arg(&folder)
        .output()
        .expect("it ran before");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(folder.join(format!("{class}.fmu")))
}
