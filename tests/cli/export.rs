//! `export`: an FMU with everything in it.

use std::io::Read;

use crate::{done, folder, refused};

fn entries(path: &std::path::Path) -> Vec<(String, Vec<u8>)> {
    let file = std::fs::File::open(path).expect("the FMU is there");
    let mut archive = zip::ZipArchive::new(file).expect("it is an archive");
    (0..archive.len())
        .map(|k| {
            let mut entry = archive.by_index(k).expect("an entry");
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).expect("it can be read");
            (entry.name().expect("a name").into_owned(), bytes)
        })
        .collect()
}

#[test]
fn an_fmu_holds_description_library_and_drive() {
    let here = folder();
    for (fmi, open) in [("2", false), ("3", true)] {
        let more: &[&str] = if open { &["--open-loop"] } else { &[] };
        let export = ["export", "dr300", "-o", "a.fmu", "--fmi", fmi, "--json", "-"];
        let answer = done(here.path(), &[&export, more].concat()).json();
        assert_eq!(answer["open_loop"], open);
        let entries = entries(&here.path().join("a.fmu"));
        let of = |end: &str| {
            entries.iter().find(|(name, _)| name.ends_with(end)).map(|(_, bytes)| bytes)
        };
        let xml = String::from_utf8_lossy(of("modelDescription.xml").expect("a description"))
            .into_owned();
        assert!(xml.contains(&format!("fmiVersion=\"{fmi}.0")), "{xml:.300}");
        assert!(xml.contains(if open { "\"u\"" } else { "\"reference\"" }));
        let drive = of("resources/drive.toml").expect("the drive file");
        assert!(String::from_utf8_lossy(drive).contains("AMIRA DR300"));
        assert_eq!(of("resources/open_loop").is_some(), open);
        let library = entries.iter().find(|(name, _)| name.starts_with("binaries/"));
        assert!(library.is_some_and(|(_, bytes)| bytes.len() > 100_000));
    }
}

#[test]
fn the_same_drive_gives_the_same_bytes() {
    let here = folder();
    for file in ["a.fmu", "b.fmu"] {
        done(here.path(), &["export", "dr300", "-o", file, "--quiet"]);
    }
    let read = |file: &str| std::fs::read(here.path().join(file)).expect("it was written");
    assert!(read("a.fmu") == read("b.fmu"));
}

#[test]
fn an_fmu_that_cannot_be_written_is_named() {
    let here = folder();
    let message = refused(here.path(), &["export", "dr300", "-o", "none/a.fmu"]);
    assert!(message.contains("none/a.fmu"), "{message}");
}
