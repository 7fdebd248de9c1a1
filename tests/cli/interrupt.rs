//! Ctrl-C ends a run at once and leaves nothing behind.
#![cfg(unix)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::{folder, program};

/// Long enough for the run to be under way, far shorter than the run.
const UNDER_WAY: Duration = Duration::from_millis(500);
/// A busy machine may take its time; the run itself would take far longer.
const AT_ONCE: Duration = Duration::from_secs(20);

/// Stops that run while it is under way; the folder of temporary files that it had.
fn stopped(here: &std::path::Path, arguments: &[&str], under_way: Duration) -> tempfile::TempDir {
    let temporary = folder();
    let mut child = program(here)
        .args(arguments)
        .env("TMPDIR", temporary.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(under_way);
    let asked = Instant::now();
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill starts").success());
    let ended = child.wait().expect("it ends");
    assert!(asked.elapsed() < AT_ONCE, "it went on for {:?}", asked.elapsed());
    assert_eq!(ended.code(), Some(130));
    temporary
}

#[test]
fn a_run_that_is_stopped_writes_nothing() {
    let here = folder();
    // 19 million samples, nearly as many as can be recorded.
    let simulate = ["simulate", "dr300", "--duration", "95000", "-o", "a.csv"];
    stopped(here.path(), &simulate, UNDER_WAY);
    assert_eq!(here.path().read_dir().expect("a folder").count(), 0);
}

/// Neither half a study nor the folders that its FMUs are unpacked in.
#[test]
fn a_study_that_is_stopped_leaves_nothing() {
    let here = folder();
    let temporary = stopped(here.path(), &["study", "--out", "deep/study"], 3 * UNDER_WAY);
    let remaining = |folder: &std::path::Path| -> Vec<_> {
        let entries = folder.read_dir().expect("a folder");
        entries.map(|entry| entry.expect("an entry").file_name()).collect()
    };
    assert!(remaining(here.path()).is_empty(), "{:?}", remaining(here.path()));
    assert!(remaining(temporary.path()).is_empty(), "{:?}", remaining(temporary.path()));
}
