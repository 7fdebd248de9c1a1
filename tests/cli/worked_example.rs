//! The worked example of the docs: every command in it runs, and says what the text says.

use crate::{done, folder, put};

const TEXT: &str = include_str!("../../docs/worked-example/README.md");

/// The words of a command line, with quotes as a shell takes them.
fn words(line: &str) -> Vec<&str> {
    let pieces = line.split('"').enumerate();
    pieces
        .flat_map(
            |(number, piece)| {
                if number % 2 == 1 { vec![piece] } else { piece.split_whitespace().collect() }
            },
        )
        .collect()
}

/// The words of a text, whatever stands between them.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn every_command_of_the_worked_example_runs_and_says_what_the_text_says() {
    let folder = folder();
    let folder = folder.path();
    put(folder, "machine.toml", include_str!("../../docs/worked-example/machine.toml"));
    put(folder, "model.toml", include_str!("../../docs/worked-example/model.toml"));
    let lines = TEXT.lines().filter_map(|line| line.strip_prefix("drivescope "));
    let said: Vec<(String, String)> =
        lines.map(|line| (line.to_owned(), plain(&done(folder, &words(line)).out))).collect();
    let of = |command: &str| -> &str {
        let found = said.iter().find(|(line, _)| line.starts_with(command));
        &found.unwrap_or_else(|| panic!("the text has no {command}")).1
    };
    assert!(of("compare fitted.toml").contains("fails over theta"));
    assert!(of("discover model.toml").contains("missing: cogging"));
    assert!(of("discover found.toml").contains("nothing"), "{}", of("discover found.toml"));
    // What the text quotes of the answers, but for the last digits of its numbers.
    let quoted = TEXT.split("```text").skip(1).filter_map(|rest| rest.split("```").next());
    let all: String = said.iter().map(|(_, out)| out.as_str()).collect();
    for line in quoted.flat_map(str::lines).map(plain).filter(|line| !line.is_empty()) {
        let first = line.split(|c: char| c.is_ascii_digit()).next().unwrap_or_default();
        assert!(all.contains(first.trim()), "no command says: {line}");
    }
    for file in ["before.html", "after.html", "wrong.toml", "found.fmu", "rerun.csv"] {
        assert!(folder.join(file).is_file(), "{file}");
    }
}
