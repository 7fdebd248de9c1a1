//! Workbooks, and how a file's format is told.

use drivescope_recording::{Error, formats};

use crate::{bytes, fixture, read_as, same_as_csv, values};

#[test]
fn workbooks_of_every_kind() {
    for name in ["log.xlsx", "log.ods"] {
        same_as_csv(&fixture(name).0, &["u", "i", "omega"]);
    }
    let (_, report) = fixture("log.xlsx");
    assert_eq!(report.left_out, ["column `state` holds text"]);
}

#[test]
fn dates_are_seconds_and_texts_mean_what_they_mean_in_csv() {
    for name in ["dates.xlsx", "dates.ods"] {
        let (recording, report) = fixture(name);
        assert_eq!((recording.start_s, recording.period_s), (0.0, 0.5), "{name}");
        let (csv, _) = fixture("log.csv");
        let (read, expected) = (values(&recording, "u"), values(&csv, "u"));
        assert!(read[3].is_nan());
        assert_eq!((read[4], &read[5..]), (expected[4], &expected[5..]), "{name}");
        let error = report.require(&recording, &["u"]).unwrap_err().to_string();
        assert!(error.contains(&format!("{name}:6")), "{error}");
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
        assert!(values(&recording, "i").iter().zip(values(&csv, "i")).all(near));
    }
}

#[test]
fn a_file_is_known_by_its_first_bytes_whatever_it_is_called() {
    let fixtures = [
        "log.parquet",
        "plain.mat",
        "matlab73.mat",
        "log.h5",
        "waveform.tdms",
        "log.mf4",
        "log.xlsx",
        "log.ods",
        "log.csv",
    ];
    for fixture in fixtures {
        for name in ["log", "log.bin", "log.csv", "log.mat", "log.xls"] {
            let (recording, _) = read_as(name, &bytes(fixture)).unwrap();
            same_as_csv(&recording, &["u", "omega"]);
        }
    }
}

#[test]
fn every_extension_is_refused_in_words_where_the_bytes_are_not_its_own() {
    let noise: Vec<u8> =
        (0..5000u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    for format in formats() {
        for extension in format.extensions {
            let stated = read_as(&format!("log.{extension}"), &noise).unwrap_err().to_string();
            assert!(stated.contains(&format!("log.{extension}")), "{stated}");
        }
    }
    let unknown = read_as("log.xyz", &noise).unwrap_err();
    assert!(matches!(unknown, Error::Format { .. }), "{unknown}");
    let stated = unknown.to_string();
    assert!(formats().iter().all(|it| stated.contains(it.name)), "{stated}");
}
