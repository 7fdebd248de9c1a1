//! One log in every format, as other programs write them (`tools/make_format_fixtures.py`).

mod binary;
mod damage;
mod tables;

use std::path::PathBuf;

use drivescope_recording::{Error, Mapping, ReadOptions, Recording, Report, read};

/// The fixtures' folder.
fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats")
}

fn read_with(name: &str, columns: &str) -> Result<(Recording, Report), Error> {
    let columns = Mapping::parse_list(columns).unwrap();
    read(folder().join(name), &ReadOptions { columns, ..ReadOptions::default() })
}

fn fixture(name: &str) -> (Recording, Report) {
    read_with(name, "").unwrap_or_else(|error| panic!("{error}"))
}

/// Reads bytes as a file of that name.
fn read_as(name: &str, content: &[u8]) -> Result<(Recording, Report), Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    read(&path, &ReadOptions::default())
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name)).unwrap()
}

fn values<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    &recording.needed(name).unwrap().values
}

/// Sees that the signals have the very values of the same log as CSV.
fn same_as_csv(read: &Recording, signals: &[&str]) {
    let (csv, _) = fixture("log.csv");
    let name = &read.name;
    assert_eq!((read.start_s, read.period_s), (csv.start_s, csv.period_s), "{name}");
    for signal in signals {
        assert_eq!(values(read, signal), values(&csv, signal), "{name}: {signal}");
    }
}
