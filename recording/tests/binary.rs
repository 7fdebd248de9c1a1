//! MAT files that scipy wrote and Parquet files that pyarrow wrote (`data/make.py`), good and bad.

use std::path::PathBuf;

use drivescope_recording::{Error, Mapping, ReadOptions, Recording, Report, read, write};
use proptest::prelude::*;

/// The bytes of a file that is kept as hexadecimal text.
fn bytes(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/{name}.hex"));
    let text: String = std::fs::read_to_string(path).unwrap().split_whitespace().collect();
    let byte = |k: usize| u8::from_str_radix(&text[k..k + 2], 16).unwrap();
    (0..text.len()).step_by(2).map(byte).collect()
}

fn read_as(
    extension: &str,
    content: &[u8],
    options: &ReadOptions,
) -> Result<(Recording, Report), Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("log.{extension}"));
    std::fs::write(&path, content).unwrap();
    read(&path, options)
}

fn mat(name: &str, columns: &str) -> Result<(Recording, Report), Error> {
    let columns = Mapping::parse_list(columns).unwrap();
    read_as("mat", &bytes(name), &ReadOptions { columns, resample: None })
}

fn values<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    &recording.needed(name).unwrap().values
}

const U: [f64; 4] = [1.5, -2.0, 2.5, 3.0];

fn rad_s(rpm: [f64; 4]) -> [f64; 4] {
    rpm.map(|value| value * std::f64::consts::PI / 30.0)
}

#[test]
fn scipy_s_vectors_are_read_packed_and_plain() {
    for name in ["mat_plain", "mat_packed"] {
        let (recording, report) = mat(name, "").unwrap();
        assert_eq!((recording.start_s, recording.period_s), (0.0, 0.5));
        assert_eq!(values(&recording, "u"), U);
        assert_eq!(values(&recording, "omega"), rad_s([30.0, 60.0, -90.0, 120.0]));
        assert_eq!(recording.signals.len(), 2);
        for left_out in [
            "`gtau` is a single number",
            "`note` is a text",
            "`setup` is a struct",
            "`late` has 2 values, others have 4",
            "`spectrum` is a complex matrix",
        ] {
            assert!(report.to_string().contains(left_out), "{left_out}: {report}");
        }
    }
}

#[test]
fn a_matrix_gives_columns_and_a_scalar_the_sampling_time() {
    let (recording, _) = mat("mat_sampling_time", "u=data_1,omega=data_2:rpm").unwrap();
    assert_eq!((recording.start_s, recording.period_s), (0.0, 0.5));
    assert_eq!(values(&recording, "u"), U);
    assert_eq!(values(&recording, "omega"), rad_s([30.0, 60.0, -90.0, 120.0]));
}

#[test]
fn what_is_not_read_is_named_with_the_way_out() {
    let structs = mat("mat_struct", "").unwrap_err().to_string();
    assert!(structs.contains("`log` is a struct") && structs.contains("scipy"), "{structs}");
    let old = mat("mat_version_4", "").unwrap_err().to_string();
    assert!(old.contains("version 4") && old.contains("scipy"), "{old}");
    let fails =
        |content: &[u8]| read_as("mat", content, &ReadOptions::default()).unwrap_err().to_string();
    let mut hdf5 = vec![0; 600];
    hdf5[..19].copy_from_slice(b"MATLAB 7.3 MAT-file");
    assert!(fails(&hdf5).contains("7.3") && fails(&hdf5).contains("scipy"));
    assert!(fails(b"").contains("empty"));
    assert!(fails(b"time,u\n0,1\n").contains("not a whole MAT file"));
    let whole = bytes("mat_plain");
    assert!(fails(&whole[..whole.len() / 2]).contains("the file ends"));
}

#[test]
fn pyarrow_s_types_are_read() {
    let options = ReadOptions::default();
    let (recording, report) = read_as("parquet", &bytes("parquet_pyarrow"), &options).unwrap();
    assert_eq!((recording.start_s, recording.period_s), (0.0, 0.5));
    assert_eq!(values(&recording, "u"), U);
    assert_eq!(values(&recording, "on"), [1.0, 0.0, 1.0, 1.0]);
    assert_eq!(values(&recording, "i"), U.map(|value| value / 1e3));
    let omega = values(&recording, "omega");
    assert_eq!(omega[3], rad_s([120.0; 4])[3]);
    assert!(omega[2].is_nan());
    let told = report.to_string();
    assert!(told.contains("omega: 1 samples missing or not finite, row 3"), "{told}");
    assert!(told.contains("column `comment` is not a plain series"), "{told}");
    let error = report.require(&recording, &["omega"]).unwrap_err().to_string();
    assert!(error.contains("log.parquet, row 3"), "{error}");
}

#[test]
fn a_packer_that_is_missing_and_a_damaged_file_are_named() {
    let options = ReadOptions::default();
    let zstd = read_as("parquet", &bytes("parquet_zstd"), &options).unwrap_err().to_string();
    assert!(zstd.contains("ZSTD") && zstd.contains("snappy"), "{zstd}");
    let whole = bytes("parquet_pyarrow");
    for content in [&whole[..whole.len() / 2], b"", b"time,u\n"] {
        let error = read_as("parquet", content, &options).unwrap_err();
        assert!(matches!(error, Error::Parquet { .. }), "{error}");
    }
}

#[test]
fn parquet_keeps_every_bit() {
    let awkward = [0.0, -0.0, f64::NAN, f64::INFINITY, 5e-324, f64::MAX, 0.1, -1.0 / 3.0];
    let signal = |name: &str, unit: &str| drivescope_recording::Signal {
        name: name.into(),
        unit: unit.into(),
        values: awkward.to_vec(),
    };
    let signals = vec![signal("u", "V"), signal("T", "rpm"), signal("odd, \"name\"", "µg")];
    let written = Recording { name: "a".into(), start_s: 2.0, period_s: 0.005, signals };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.parquet");
    write(&path, &written).unwrap();
    let (read, _) = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!((read.start_s, read.period_s), (2.0, 0.005));
    for (a, b) in written.signals.iter().zip(&read.signals) {
        assert_eq!((&a.name, &a.unit), (&b.name, &b.unit));
        assert!(a.values.iter().zip(&b.values).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}

/// The content with some bytes replaced.
fn changed(mut content: Vec<u8>, changes: &[(prop::sample::Index, u8)]) -> Vec<u8> {
    for (at, byte) in changes {
        let at = at.index(content.len());
        content[at] = *byte;
    }
    content
}

proptest! {
    /// Whatever one changes in a file, it is read or refused, never a panic.
    #[test]
    fn damaged_files_are_refused(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        for (name, extension) in
            [("mat_plain", "mat"), ("mat_packed", "mat"), ("parquet_pyarrow", "parquet")]
        {
            let content = changed(bytes(name), &changes);
            if let Ok((recording, _)) = read_as(extension, &content, &ReadOptions::default()) {
                prop_assert!(recording.check().is_ok());
            }
        }
    }
}
