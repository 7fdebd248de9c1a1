//! Ctrl-C ends a run at once and leaves nothing behind.
#![cfg(unix)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::{folder, program};

/// Long enough for the run to be under way, far shorter than the run.
const UNDER_WAY: Duration = Duration::from_millis(500);
/// A busy machine may take its time; the run itself would take far longer.
const AT_ONCE: Duration = Duration::from_secs(20);

#[test]
fn a_run_that_is_stopped_writes_nothing() {
    let here = folder();
    let mut child = program(here.path())
        // 50 million samples.
        .args(["simulate", "dr300", "--duration", "250000", "-o", "a.csv"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(UNDER_WAY);
    let asked = Instant::now();
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill starts").success());
    let ended = child.wait().expect("it ends");
    assert!(asked.elapsed() < AT_ONCE, "it went on for {:?}", asked.elapsed());
    assert_eq!(ended.code(), Some(130));
    assert_eq!(here.path().read_dir().expect("a folder").count(), 0);
}
