//! What every command owes: `--quiet` is quiet, the end names the next command, the exit code says
//! what it says, and an output is written where the user points.

use std::path::Path;
use std::process::Stdio;

use crate::{done, folder, program, put, refused, run};

/// A short run of the DR300 as a recording, and an FMU of it.
fn recorded(here: &Path) {
    let simulate = ["simulate", "dr300", "--duration", "2", "-o", "log.csv", "--quiet"];
    done(here, &simulate);
    done(here, &["export", "dr300", "-o", "a.fmu", "--quiet"]);
}

const SYSTEM: &str =
    "[experiment]\nstop = 0.1\nstep = 0.005\n[[component]]\nname = \"a\"\nfmu = \"a.fmu\"\n";

#[test]
fn quiet_commands_are_quiet() {
    let here = folder();
    recorded(here.path());
    put(here.path(), "system.toml", SYSTEM);
    for command in [
        &["simulate", "dr300", "--duration", "0.1", "-o", "b.csv"][..],
        &["simulate", "dr300", "--measured", "log.csv", "-o", "b.csv"],
        &["export", "dr300", "-o", "b.fmu"],
        &["fmu", "run", "a.fmu", "--stop", "0.1", "-o", "b.csv"],
        &["cosim", "system.toml", "-o", "b.csv"],
    ] {
        let loud = done(here.path(), command);
        assert!(!loud.out.is_empty(), "{command:?}");
        let quiet = done(here.path(), &[command, &["--quiet"]].concat());
        assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""), "{command:?}");
        // JSON that was asked for is no chatter.
        done(here.path(), &[command, &["--quiet", "--json", "-"]].concat()).json();
    }
    // Where the text is the answer, it is said, and nothing else.
    let quiet = done(here.path(), &["effects", "cogging", "--quiet"]);
    assert!(quiet.out.contains("cogging") && quiet.err.is_empty(), "{}", quiet.err);
}

#[test]
fn every_command_names_the_next_useful_one() {
    let here = folder();
    recorded(here.path());
    put(here.path(), "system.toml", SYSTEM);
    for (command, next) in [
        (&["simulate", "dr300", "--duration", "0.1", "-o", "b.csv"][..], "compare dr300 b.csv"),
        (&["export", "dr300", "-o", "my drive.fmu"], "fmu validate 'my drive.fmu'"),
        (&["fmu", "info", "a.fmu"], "fmu run a.fmu -o run.csv"),
        (&["fmu", "validate", "a.fmu"], "fmu run a.fmu -o run.csv"),
        (&["fmu", "run", "a.fmu", "--stop", "0.1", "-o", "b.csv"], "serve b.csv"),
        (&["cosim", "system.toml", "-o", "b.csv"], "serve b.csv"),
        (&["effects"], "effects cogging"),
        (&["effects", "cogging"], "add DRIVE cogging REC -o with_it.toml"),
        (&["schema"], "init REC -o drive.toml"),
        (&["compare", "dr300", "log.csv"], "drive"),
    ] {
        let said = done(here.path(), command).err;
        let last = said.lines().last().unwrap_or_default();
        let wanted = format!("next: drivescope {next}");
        match next {
            // Depends on what was found.
            "drive" => assert!(last.starts_with("next: drivescope "), "{command:?}: {said}"),
            _ => assert_eq!(last, wanted, "{command:?}"),
        }
    }
}

/// What was said of the recordings is said again.
#[test]
fn the_next_command_judges_by_the_same() {
    let here = folder();
    recorded(here.path());
    let simulate =
        ["simulate", "dr300", "--duration", "2", "--seed", "2", "-o", "b.csv", "--quiet"];
    done(here.path(), &simulate);
    let fit =
        ["fit", "dr300", "log.csv", "--validate", "b.csv", "--noise", "i=0.01", "-o", "f.toml"];
    let said = done(here.path(), &fit).err;
    let next = "next: drivescope compare f.toml log.csv --validate b.csv --noise i=0.01";
    assert_eq!(said.lines().last(), Some(next));
    // Where nothing is missing there is nothing to be added.
    let said = done(here.path(), &["discover", "f.toml", "log.csv", "b.csv"]).err;
    assert_eq!(said.lines().last(), Some("next: drivescope export f.toml -o drive.fmu"));
}

/// Whether anybody reads the answer changes neither the verdict nor the exit code.
#[test]
fn a_closed_pipe_changes_nothing() {
    let here = folder();
    recorded(here.path());
    // An FMU that cannot be tried here is a finding, which `--check` forbids.
    let fmu = std::fs::read(here.path().join("a.fmu")).expect("it was written");
    let foreign = |name: &str| Some(name.replace("binaries/", "binaries/vax-"));
    put(here.path(), "b.fmu", crate::fmu::repacked(&fmu, foreign));
    let check = ["fmu", "validate", "b.fmu", "--check"];
    assert_eq!(run(here.path(), &check).code, Some(1));
    let mut child = program(here.path())
        .args(check)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("it ends").code(), Some(1));
}

#[test]
fn an_error_far_along_a_line_is_bad_input_and_no_panic() {
    let here = folder();
    put(here.path(), "wide.toml", format!("name = \"{}\" motion = 3\n", "x".repeat(70_000)));
    let message = refused(here.path(), &["compare", "wide.toml", "log.csv"]);
    assert!(message.contains("wide.toml:1:70011"), "{:.300}", message);
    assert!(message.len() < 2000, "{} bytes", message.len());
}

#[cfg(unix)]
#[test]
fn outputs_go_through_links_and_pipes() {
    use std::os::unix::fs::FileTypeExt;

    let here = folder();
    std::fs::create_dir(here.path().join("deep")).expect("a folder");
    for (link, file) in [("log.csv", "deep/log.csv"), ("null.csv", "/dev/null")] {
        std::os::unix::fs::symlink(file, here.path().join(link)).expect("a link");
        let simulate = ["simulate", "dr300", "--duration", "0.1", "--json"];
        done(here.path(), &[&simulate[..], &["answer.json", "-o", link]].concat());
        let there = here.path().join(link).symlink_metadata().expect("it is there");
        assert!(there.is_symlink(), "{link} stays a link");
    }
    assert!(here.path().join("deep/log.csv").is_file());
    // A device takes a recording whatever its name, and stays one.
    done(here.path(), &["simulate", "dr300", "--duration", "0.1", "-o", "/dev/null"]);
    let there = Path::new("/dev/null").metadata().expect("every Unix has it");
    assert!(there.file_type().is_char_device());
}

/// What cannot be read is refused in a moment, whatever its size.
#[cfg(target_os = "linux")]
#[test]
fn an_endless_drive_file_and_an_absurd_sampling_time_are_refused() {
    let here = folder();
    recorded(here.path());
    let message = refused(here.path(), &["compare", "/dev/zero", "log.csv"]);
    assert!(message.contains("longer than 10000000 bytes"), "{message}");
    for (period, said) in [("1e-9", "2.0e9 samples"), ("5e-8", "4.0e7 samples"), ("10", "between")]
    {
        let message = refused(here.path(), &["compare", "dr300", "log.csv", "--resample", period]);
        assert!(message.contains(said), "{period}: {message}");
    }
}

/// A log in milliseconds that is read as seconds is no overflow of the model.
#[test]
fn a_recording_too_slow_for_the_drive_is_refused_with_its_sampling_time() {
    let here = folder();
    let mut text = "time [s],u [V],i [A],omega [rad/s]\n".to_owned();
    for k in 0..300 {
        let t = f64::from(k);
        let (u, i) = (10.0 * (0.1 * t).sin().signum(), (0.3 * t).cos());
        text += &format!("{},{u},{i},{}\n", 5000.0 * t, 100.0 * (0.1 * t).sin());
    }
    put(here.path(), "slow.csv", text);
    let message = refused(here.path(), &["compare", "dr300", "slow.csv"]);
    assert!(message.contains("a sample of 5000 s would take the model"), "{message}");
    assert!(message.contains("--columns time=COLUMN:ms"), "{message}");
}

/// What is recorded has the memory of what is read, and is refused before any is taken.
#[test]
fn runs_that_no_memory_holds_are_refused() {
    let here = folder();
    recorded(here.path());
    put(here.path(), "system.toml", SYSTEM.replace("stop = 0.1", "stop = 1e6"));
    for command in [
        &["simulate", "dr300", "--duration", "1e6", "-o", "b.csv"][..],
        &["fmu", "run", "a.fmu", "--stop", "1e6", "-o", "b.csv"],
        &["cosim", "system.toml", "-o", "b.csv"],
    ] {
        let message = refused(here.path(), command);
        assert!(message.contains("can be recorded"), "{command:?}: {message}");
    }
}

#[test]
fn an_fmu_is_named_so() {
    let here = folder();
    let message = refused(here.path(), &["export", "dr300", "-o", "drive.txt"]);
    assert!(message.contains("drive.txt") && message.contains(".fmu"), "{message}");
}

/// Fewer sub-steps than a drive needs would give an answer that looks like one.
#[test]
fn a_drive_that_is_too_stiff_for_its_steps_is_an_error() {
    let here = folder();
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenarios/drives/dr300.toml"
    ))
    .expect("the shipped drive");
    let coupling = "\n[[effect]]\nkind = \"flexible_coupling\"\nk = 1e12\nd = 1e-3\nratio = 0.5\n";
    put(here.path(), "stiff.toml", text + coupling);
    let message =
        refused(here.path(), &["simulate", "stiff.toml", "--duration", "1", "-o", "a.csv"]);
    assert!(message.contains("sub-steps") && message.contains("shorten the step"), "{message}");
}
