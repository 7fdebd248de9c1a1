//! The command to type next.

use std::fmt;

/// A command as it is typed into a shell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Next(String);

impl Next {
    /// `drivescope COMMAND`.
    pub(crate) fn new(command: &str) -> Self {
        Self(format!("drivescope {command}"))
    }

    /// With a word more: a file or another argument.
    pub(crate) fn with(mut self, word: impl fmt::Display) -> Self {
        self.0.push(' ');
        self.0.push_str(&quoted(&word.to_string()));
        self
    }

    /// The word as a shell takes it for one.
    pub(crate) fn word(word: &str) -> String {
        quoted(word)
    }

    /// With files more.
    pub(crate) fn files<'a>(self, files: impl IntoIterator<Item = &'a std::path::PathBuf>) -> Self {
        files.into_iter().fold(self, |next, file| next.with(file.display()))
    }

    /// With recordings to judge by, and noise that was given, where there are any.
    pub(crate) fn judged(self, validate: &[std::path::PathBuf], noise: Option<&str>) -> Self {
        let next = match validate {
            [] => self,
            some => self.options(" --validate").files(some),
        };
        noise.into_iter().fold(next, |next, noise| next.options(" --noise").with(noise))
    }

    /// With options more, as they are typed: empty, or with a blank before each.
    pub(crate) fn options(mut self, typed: &str) -> Self {
        self.0.push_str(typed);
        self
    }

    /// The command.
    pub(crate) fn command(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Next {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "next: {}", self.0)
    }
}

/// The word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_can_be_typed_as_it_stands() {
        let next = Next::new("compare").with("my drive.toml").with("it's.csv").options(" --check");
        assert_eq!(next.command(), r"drivescope compare 'my drive.toml' 'it'\''s.csv' --check");
        assert_eq!(Next::new("fit").with("a.toml").to_string(), "next: drivescope fit a.toml");
        let judged = Next::new("compare a.toml").judged(&["v 1.csv".into()], Some("i=0.01"));
        assert_eq!(
            judged.command(),
            "drivescope compare a.toml --validate 'v 1.csv' --noise i=0.01"
        );
    }
}
