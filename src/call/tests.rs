//! Calls: what is handed over and back, refused, stopped.

use super::*;

fn called(scratch: &Path, arguments: &[&str]) -> Call {
    Call::new(arguments.iter().map(OsString::from), [], scratch)
}

#[test]
fn what_nobody_names_a_file_for_is_handed_back() {
    let scratch = tempfile::tempdir().expect("a folder");
    let path = scratch.path().join("run.csv");
    let file = path.display().to_string();
    let simulate = ["simulate", "dr300", "--duration", "0.1", "--seed", "7", "-o", &file];
    let answered = called(scratch.path(), &simulate).run().expect("it runs");
    let recording = &answered.recordings[&path];
    assert_eq!((recording.len(), recording.period_s), (21, 0.005));
    assert!(!path.exists() && !answered.json.contains("run.csv"), "{}", answered.json);
    assert!(answered.json.contains("\"samples\": 21") && !answered.text.contains("run.csv"));
    assert_eq!(answered.remarks, [""; 0], "no command is to be typed");

    // A recording in memory is read where an argument names it.
    let (recording, report) = reread(recording.clone(), "mine").expect("it can be read");
    let compare = ["compare", "dr300", "mine"].map(OsString::from);
    let given = [(PathBuf::from("mine"), recording, report)];
    let answered = Call::new(compare, given, scratch.path()).run().expect("it runs");
    assert!(answered.json.contains("\"name\": \"mine\""), "{}", answered.json);
}

#[test]
fn what_is_wrong_is_said_in_the_words_of_the_command_line() {
    let nowhere = Path::new("/nowhere");
    let refused = |arguments: &[&str]| match called(nowhere, arguments).run() {
        Err(Refused::BadInput(said)) => said,
        other => panic!("{other:?}"),
    };
    let said = refused(&["simulate", "dr3000", "-o", "a.csv"]);
    assert_eq!(
        said,
        "`dr3000` is neither a file nor a built-in drive\nbuilt-in drives: dr300, emps"
    );
    let said = refused(&["simulate", "dr300", "-o", "a.csv", "--noise", "maybe"]);
    assert!(said.starts_with("invalid value 'maybe'") && !said.contains("Usage"), "{said}");
    let Err(Refused::BadInput(said)) = drive_name("schema = 2", "a.toml") else {
        panic!("there is no such schema")
    };
    assert!(said.contains("a.toml:1:"), "{said}");
}

#[test]
fn a_call_that_is_stopped_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.csv").display().to_string();
    let call = called(Path::new("/nowhere"), &["simulate", "dr300", "-o", &file]);
    call.watched().stop();
    assert_eq!(call.run(), Err(Refused::Stopped));
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);
}

#[test]
fn a_panic_is_an_internal_error() {
    let failed = guarded::<()>(|| panic!("on purpose"));
    assert!(matches!(failed, Err(Refused::Internal(_))), "{failed:?}");
}
