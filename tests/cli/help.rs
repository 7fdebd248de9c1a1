//! Help, usage errors, shell files, the library of effects.

use std::process::Stdio;

use crate::{done, folder, program, put, refused, run};

#[test]
fn help_lists_every_command_and_each_has_help() {
    let here = folder();
    let help = done(here.path(), &["--help"]).out;
    let listed: Vec<&str> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| {
            line.strip_prefix("  ")?.split(' ').next().filter(|name| !name.is_empty())
        })
        .collect();
    for expected in ["simulate", "init", "export", "effects", "schema", "completions", "man"] {
        assert!(listed.contains(&expected), "{expected} is not in {listed:?}");
    }
    for command in listed.iter().filter(|name| **name != "help") {
        let help = done(here.path(), &[command, "--help"]).out;
        for option in ["--json", "--seed", "--quiet"] {
            assert!(help.contains(option), "{command} does not mention {option}");
        }
    }
}

#[test]
fn wrong_usage_is_bad_input() {
    let here = folder();
    for arguments in [
        &["nonsense"][..],
        &[],
        &["simulate", "dr300"],
        &["simulate", "dr300", "-o", "a.csv", "--duration", "x"],
        &["simulate", "dr300", "-o", "a.csv", "--reference", "1", "--input", "1"],
        &["export", "dr300", "-o", "a.fmu", "--fmi", "1"],
        &["effects", "--seed", "-1"],
    ] {
        let message = refused(here.path(), arguments);
        assert!(
            message.contains("Usage") || message.contains("--help"),
            "{arguments:?}: {message}"
        );
    }
    assert_eq!(run(here.path(), &["--version"]).code, Some(0));
}

#[test]
fn shell_files_derive_from_the_commands() {
    let here = folder();
    let bash = done(here.path(), &["completions", "bash"]).out;
    let man = done(here.path(), &["man"]).out;
    for command in ["simulate", "export", "effects"] {
        assert!(bash.contains(command) && man.contains(command), "{command}");
    }
    assert!(man.starts_with(".ie") || man.starts_with(".TH"), "{man:.40}");
}

#[test]
fn effects_show_their_law_and_parameters() {
    let here = folder();
    let all = done(here.path(), &["effects", "--json", "-"]).json();
    let all = all.as_array().expect("a list");
    let ids: Vec<&str> = all.iter().filter_map(|effect| effect["id"].as_str()).collect();
    let table = done(here.path(), &["effects"]).out;
    for id in &ids {
        assert!(table.contains(id), "{id} is not in the table");
        let one = done(here.path(), &["effects", id, "--json", "-"]).json();
        assert_eq!(all.iter().find(|effect| effect["id"] == **id), Some(&one));
    }
    let stribeck = done(here.path(), &["effects", "stribeck"]).out;
    for part in ["T_b * exp(-(omega / omega_s)^2)", "rad/s", "omega near zero", "above 0"] {
        assert!(stribeck.contains(part), "{part} is not in {stribeck}");
    }
    let message = refused(here.path(), &["effects", "strybeck"]);
    assert!(message.contains("`strybeck`") && message.contains("stribeck"), "{message}");
}

#[test]
fn answers_go_to_a_file_as_json_beside_the_text() {
    let here = folder();
    put(here.path(), "a.json", "before");
    let ran = done(here.path(), &["effects", "cogging", "--json", "a.json"]);
    assert!(ran.out.contains("cogging"));
    let text = std::fs::read_to_string(here.path().join("a.json")).expect("it was written");
    let json: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
    assert_eq!(json["id"], "cogging");
    let message = refused(here.path(), &["effects", "--json", "no/such/a.json"]);
    assert!(message.contains("no/such/a.json"), "{message}");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let here = folder();
    let mut child = program(here.path())
        .args(["schema"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(0));
    // All of it may have been written before the reader went: then the next command is told.
    let stated = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(stated.lines().all(|line| line.starts_with("next: ")), "{stated}");
}
