//! What is wrong with the signals of recordings, without fitting anything: `signals DRIVE REC...`
//! prints one line of JSON a recording. What tools/check_signals.py counts.

use std::path::Path;
use std::process::ExitCode;

use drivescope_discovery::signals::{SignalFinding, findings, repaired};
use drivescope_discovery::{Evidence, Measured, doubts, noise};
use drivescope_plant::drive::Drive;
use drivescope_recording::{ReadOptions, Suspicion, read};

fn main() -> ExitCode {
    let all: Vec<String> = std::env::args().skip(1).collect();
    let [drive, recordings @ ..] = &all[..] else {
        eprintln!("usage: signals DRIVE REC...");
        return ExitCode::from(2);
    };
    let text = std::fs::read_to_string(drive).unwrap_or_default();
    let drive = match Drive::parse(&text, drive) {
        Ok(drive) => drive,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    for recording in recordings {
        let line = match found(&drive, recording) {
            Ok(found) => serde_json::json!({ "file": recording, "signals": found }),
            Err(refused) => serde_json::json!({ "file": recording, "refused": refused }),
        };
        println!("{line}");
    }
    ExitCode::SUCCESS
}

/// What is found in one recording; what it is refused for.
fn found(drive: &Drive, file: &str) -> Result<Vec<SignalFinding>, String> {
    let path = Path::new(file);
    let kept = ReadOptions::kept(path).map_err(|it| it.to_string())?.unwrap_or_default();
    let (recording, report) = read(path, &kept).map_err(|it| it.to_string())?;
    if let Some(it) = report.suspicions.iter().find(|it| Suspicion::is_contradiction(it)) {
        return Err(it.to_string());
    }
    let (recording, mut all) = repaired(recording);
    let measured = Measured::new(drive, &recording).map_err(|it| it.to_string())?;
    doubts(drive, &measured).map_err(|it| it.to_string())?;
    let sds = noise(drive, &measured, &[]).iter().map(|it| it.sd).collect();
    let evidence = Evidence { recordings: vec![measured], noise: vec![sds] };
    all.extend(findings(drive, &evidence));
    Ok(all)
}
