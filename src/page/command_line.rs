//! The command lines that do the same as the steps of a session: run one after the other in a folder
//! with the files that were dropped, they write the drive files of these steps.

use std::path::Path;

use drivescope_recording::ReadOptions;

use super::recordings::Taken;
use crate::next::Next;
use crate::session::USUAL_SEED;

/// What ends a text that is typed into a file.
const END: &str = "DRIVESCOPE";

/// The file that holds the drive of a step.
pub(super) fn file_of(step: usize) -> String {
    format!("step-{step}.toml")
}

/// The recordings of a session, as command lines name them.
#[derive(Debug, Clone)]
pub(super) struct Files {
    /// Lines to run first: how recordings that are read differently are read.
    first: String,
    names: Vec<String>,
    /// How all of them are read.
    said: Vec<String>,
    seed: Option<u64>,
}

impl Files {
    /// Of these recordings, in a session of that seed.
    pub(super) fn of(recordings: &[Taken], seed: u64) -> Self {
        let mut first = String::new();
        let made: Vec<&str> =
            recordings.iter().filter(|it| it.is_made()).map(|it| it.name.as_str()).collect();
        if !made.is_empty() {
            first += &format!("# {} simulated by the page\n", made.join(" and "));
        }
        let mut each = recordings.iter().map(Taken::said);
        let alike = each.next().unwrap_or_default();
        let is_alike = each.all(|other| other == alike);
        if !is_alike {
            // Options count for every recording of a command: what is said of one lies beside it.
            let named = recordings.iter().filter(|it| it.options != ReadOptions::default());
            for taken in named {
                let name = taken.on_a_command_line();
                let text = taken.options.kept_text(Path::new(&name)).unwrap_or_default();
                first +=
                    &typed("", &ReadOptions::kept_at(Path::new(&name)).to_string_lossy(), &text);
            }
        }
        let said = if is_alike { alike } else { Vec::new() };
        let names = recordings.iter().map(Taken::on_a_command_line).collect();
        Self { first, names, said, seed: (seed != USUAL_SEED).then_some(seed) }
    }

    fn on(&self, command: Next, names: &[String], output: Option<&str>) -> String {
        let command = names.iter().chain(&self.said).fold(command, |line, word| line.with(word));
        let seed = self.seed.iter();
        let command = seed.fold(command, |line, seed| line.options(" --seed").with(seed));
        let output = output.iter();
        output.fold(command, |line, file| line.options(" -o").with(file)).command().to_owned()
    }

    /// The base of a session, fitted; `made` if it is the first drive of the first recording.
    pub(super) fn begun(&self, drive: &str, made: bool) -> String {
        let first = &self.names[..self.names.len().min(1)];
        let init = made.then(|| self.on(Next::new("init"), first, Some(drive)) + "\n");
        let fit = self.fit(drive, &file_of(0));
        format!("{}{}{fit}", self.first, init.unwrap_or_default())
    }

    fn fit(&self, drive: &str, output: &str) -> String {
        self.on(Next::new("fit").with(drive), &self.names, Some(output))
    }

    /// The drive of a step with an effect more, as the next one.
    pub(super) fn add(&self, step: usize, effect: &str, next: usize) -> String {
        let add = Next::new("add").with(file_of(step)).with(effect);
        self.on(add, &self.names, Some(&file_of(next)))
    }

    /// A drive file that begins as that of a step, fitted, as the next one.
    pub(super) fn refit(&self, (step, before): (usize, &str), text: &str, next: usize) -> String {
        let from = file_of(step);
        let added = match text.strip_prefix(before) {
            Some("") => return self.fit(&from, &file_of(next)),
            Some(added) => typed(&format!("{from} - "), &begin_of(next), added),
            None => typed("", &begin_of(next), text),
        };
        added + &self.fit(&begin_of(next), &file_of(next))
    }

    /// A drive file with a value that people set, as the next step.
    pub(super) fn compare(&self, text: &str, next: usize) -> String {
        let compare = Next::new("compare").with(file_of(next));
        typed("", &file_of(next), text) + &self.on(compare, &self.names, None)
    }
}

/// The drive file that a fit of the next step begins with.
fn begin_of(step: usize) -> String {
    format!("step-{step}-before.toml")
}

/// Types a text into a file, after what `from` gives.
fn typed(from: &str, file: &str, text: &str) -> String {
    let end = if text.ends_with('\n') { "" } else { "\n" };
    format!("cat {from}> {} << '{END}'\n{text}{end}{END}\n", Next::word(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(seed: u64) -> Files {
        Files::of(&[], seed)
    }

    #[test]
    fn a_law_is_typed_behind_the_drive_that_it_is_added_to() {
        let named = Files { names: vec!["my log.csv".to_owned()], ..files(7) };
        let before = "schema = 1\n";
        assert_eq!(
            named.refit((0, before), "schema = 1\n\n[[effect]]\n", 2),
            "cat step-0.toml - > step-2-before.toml << 'DRIVESCOPE'\n\n[[effect]]\nDRIVESCOPE\n\
             drivescope fit step-2-before.toml 'my log.csv' --seed 7 -o step-2.toml"
        );
        assert_eq!(
            named.refit((3, before), before, 4),
            "drivescope fit step-3.toml 'my log.csv' --seed 7 -o step-4.toml"
        );
    }

    #[test]
    fn a_first_drive_is_made_before_it_is_fitted() {
        let said = vec!["--columns".to_owned(), "u=V in".to_owned()];
        let named = Files { names: vec!["a.csv".to_owned()], said, ..files(1) };
        assert_eq!(
            named.begun("first.toml", true),
            "drivescope init a.csv --columns 'u=V in' -o first.toml\n\
             drivescope fit first.toml a.csv --columns 'u=V in' -o step-0.toml"
        );
    }
}
