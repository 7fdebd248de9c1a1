//! The example FMU: its model, and its library.

use std::path::PathBuf;
use std::process::Command;

// Elsewhere it is the top of a library.
#[allow(unreachable_pub)]
#[path = "../../examples/oscillator/model.rs"]
pub mod model;

/// The example's library. Built here: cargo builds examples for a run of all tests, but leaves an
/// old one in place when a test is run alone. With the profile and the features of such a run there is
/// nothing to be built after it.
pub(crate) fn library() -> Vec<u8> {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--locked", "--workspace", "--all-features"]);
    build.args(["--example", "oscillator", "--message-format=json-render-diagnostics"]);
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    let built = build.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo starts");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let messages = String::from_utf8_lossy(&built.stdout).into_owned();
    let suffix = format!("oscillator{}", std::env::consts::DLL_SUFFIX);
    let path = messages.split('"').find(|text| text.ends_with(&suffix));
    let path = PathBuf::from(path.expect("cargo names the library that it built"));
    std::fs::read(path).expect("the library")
}
