//! Builds the shared libraries of exported FMUs and hands their paths to the program, which embeds
//! them.
//!
//! The libraries are crates of their own (`fmu/drive` of 2 MB, `fmu/diagnoser` of 5
//! MB), built here by a nested cargo: a dependency that is both a Rust library and a shared one
//! does not survive a clean `cargo check`. What the outer cargo set for its own crates (lint driver,
//! flags) must not reach the nested one.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, exit};

/// The crates of the shared libraries, the stems of their files, and the variable with the path.
const LIBRARIES: [[&str; 3]; 2] = [
    ["drivescope-fmu-drive", "drivescope_fmu_drive", "DRIVESCOPE_FMU_LIBRARY"],
    ["drivescope-fmu-diagnoser", "drivescope_fmu_diagnoser", "DRIVESCOPE_FMU_DIAGNOSER_LIBRARY"],
];
/// What the libraries are made from.
const SOURCES: [&str; 21] = [
    "Cargo.toml",
    "Cargo.lock",
    "numerics/Cargo.toml",
    "numerics/src",
    "units/Cargo.toml",
    "units/src",
    "plant/Cargo.toml",
    "plant/src",
    "recording/Cargo.toml",
    "recording/src",
    "fmu/Cargo.toml",
    "fmu/build.rs",
    "fmu/c",
    "fmu/src",
    "fmu/blocks",
    "fmu/diagnoser",
    "fmu/drive",
    "diagnoser/Cargo.toml",
    "diagnoser/src",
    "monitor/Cargo.toml",
    "monitor/src",
];
/// Variables of the outer cargo and of clippy that would change the nested build.
const NOT_FOR_NESTED: [&str; 7] = [
    "RUSTC_WORKSPACE_WRAPPER",
    "CLIPPY_ARGS",
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_BUILD_TARGET",
    "CARGO_TARGET_DIR",
    "CARGO_BUILD_TARGET_DIR",
];

fn main() {
    let root = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
    }
    let target = variable("TARGET").to_string_lossy().into_owned();
    let own = PathBuf::from(variable("OUT_DIR"));
    let folder = shared(&own).join("nested");
    build(&root, &target, &folder);
    for [package, stem, name] in LIBRARIES {
        let file = file_name(stem);
        let built = folder.join(&target).join("release").join(&file);
        // A copy of its own: another checkout may build into the same folder later.
        let library = own.join(&file);
        if let Err(error) = fs::copy(&built, &library) {
            fail(&format!(
                "cargo built {package} for {target}, but {} cannot be copied: {error}; does this target have shared libraries?",
                built.display()
            ));
        }
        println!("cargo::rustc-env={name}={}", library.display());
    }
}

/// The folder that checks, tests and releases share (`target` of `target/PROFILE/build/NAME/out`):
/// the libraries are the same for all of them, and are built once.
fn shared(own: &Path) -> &Path {
    let in_build = own.ancestors().nth(2).is_some_and(|it| it.ends_with("build"));
    own.ancestors().nth(4).filter(|_| in_build).unwrap_or(own)
}

/// Builds the libraries for that target into that folder.
fn build(root: &Path, target: &str, folder: &Path) {
    let mut cargo = Command::new(variable("CARGO"));
    cargo.current_dir(root);
    cargo.args(["build", "--release", "--locked", "--target", target]);
    cargo.args(LIBRARIES.iter().flat_map(|[package, ..]| ["--package", package]));
    cargo.arg("--target-dir").arg(folder);
    // A panic must be caught at the C boundary, whatever the outer profile says.
    cargo.env("CARGO_PROFILE_RELEASE_PANIC", "unwind");
    cargo.env("CARGO_PROFILE_RELEASE_STRIP", "symbols");
    for name in NOT_FOR_NESTED {
        cargo.env_remove(name);
    }
    match cargo.output() {
        Err(error) => {
            fail(&format!("cargo could not be started to build the FMU libraries: {error}"))
        }
        Ok(output) if !output.status.success() => {
            let host = variable("HOST").to_string_lossy().into_owned();
            let hint = if host == target {
                String::new()
            } else {
                format!(" (cross-compiling from {host}: a linker for {target} is needed)")
            };
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            fail(&format!("the FMU libraries could not be built for {target}{hint}\n{said}"));
        }
        Ok(_) => {}
    }
}

/// The file name of a library of that stem on the target system.
fn file_name(stem: &str) -> String {
    let system = variable("CARGO_CFG_TARGET_OS").to_string_lossy().into_owned();
    match system.as_str() {
        "windows" => format!("{stem}.dll"),
        "macos" | "ios" => format!("lib{stem}.dylib"),
        _ => format!("lib{stem}.so"),
    }
}

fn variable(name: &str) -> OsString {
    env::var_os(name).unwrap_or_else(|| fail(&format!("cargo did not set {name}")))
}

fn fail(why: &str) -> ! {
    // Every line as an error of its own, or cargo would show the first one only.
    for line in why.lines() {
        println!("cargo::error={line}");
    }
    exit(1)
}
