//! Which column is meant.

use crate::canonical;
use crate::error::Error;
use crate::given::Given;
use crate::guess;
use crate::mapping::Mapping;

/// Whether a column of that text will be the signal.
pub(crate) fn is_signal(text: &str, signal: &str, maps: &[Mapping]) -> bool {
    let given = [Given::of(text)];
    match maps.iter().find(|map| map.canonical == signal) {
        Some(map) => find(&given, &map.foreign).is_some(),
        None => {
            let Given { name, unit, .. } = &given[0];
            let guess = || Some(guess::guess(name, unit.as_deref(), None)?.canonical);
            canonical::exact(name).or_else(guess).is_some_and(|known| known.name == signal)
        }
    }
}

/// Whether a column of that text will be the time.
pub(crate) fn is_time(text: &str, maps: &[Mapping]) -> bool {
    is_signal(text, "time", maps)
}

/// Whether a column of that text will be a signal that the program knows or the user names.
pub(crate) fn is_known(text: &str, maps: &[Mapping]) -> bool {
    let given = [Given::of(text)];
    let Given { name, unit, .. } = &given[0];
    let guess = || Some(guess::guess(name, unit.as_deref(), None)?.canonical);
    maps.iter().any(|map| find(&given, &map.foreign).is_some())
        || canonical::exact(name).or_else(guess).is_some()
}

/// The error of a file in which no column is the time.
pub(crate) fn missing_time(file: &str, texts: &[String]) -> Error {
    let given: Vec<Given> = texts.iter().map(|text| Given::of(text)).collect();
    Error::MissingTime { file: file.to_owned(), columns: listed(&given) }
}

/// By its name, by the header's whole text, then without regard to case; `u#2` is the second of
/// several columns called `u`.
pub(super) fn find(given: &[Given], wanted: &str) -> Option<usize> {
    given
        .iter()
        .position(|column| column.name == wanted || column.text == wanted)
        .or_else(|| given.iter().position(|column| column.name == Given::of(wanted).name))
        .or_else(|| given.iter().position(|column| column.name.eq_ignore_ascii_case(wanted)))
        .or_else(|| {
            let (name, number) = wanted.rsplit_once('#')?;
            let skipped = number.parse::<usize>().ok()?.checked_sub(1)?;
            let mut same = given.iter().enumerate().filter(|(_, column)| column.name == name);
            same.nth(skipped).map(|(position, _)| position)
        })
}

pub(super) fn listed(given: &[Given]) -> String {
    given.iter().map(|column| format!("`{}`", column.name)).collect::<Vec<_>>().join(", ")
}
