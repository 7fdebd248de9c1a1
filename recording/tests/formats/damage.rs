//! Files that are cut, changed, or claim more than they hold: an error, never a panic, and no
//! memory that the file does not need.

use std::io::Write;

use drivescope_recording::{Error, ReadOptions, read};
use proptest::prelude::*;

use crate::{bytes, read_as};

const FIXTURES: [&str; 12] = [
    "plain.mat",
    "packed.mat",
    "simulink.mat",
    "log.parquet",
    "log.h5",
    "matlab73.mat",
    "segments.tdms",
    "interleaved.tdms",
    "log.mf4",
    "packed.mf4",
    "log.xlsx",
    "dates.ods",
];

#[test]
fn what_is_cut_is_refused_or_shorter() {
    for fixture in FIXTURES {
        let whole = bytes(fixture);
        for share in [1, 10, 50, 90, 99] {
            let cut = &whole[..whole.len() * share / 100];
            if let Ok((recording, _)) = read_as(fixture, cut) {
                assert!(recording.check().is_ok() && recording.len() <= 40, "{fixture}");
            }
        }
    }
}

#[test]
fn a_cut_file_is_said_to_be_damaged() {
    for fixture in ["plain.mat", "log.parquet", "log.h5", "log.mf4", "log.xlsx", "dates.ods"] {
        let whole = bytes(fixture);
        let error = read_as(fixture, &whole[..whole.len() / 2]).unwrap_err();
        assert!(matches!(error, Error::Damaged { .. }), "{fixture}: {error}");
    }
}

/// A MAT file of 10^9 zeros is 1 MB when packed.
#[test]
fn a_small_file_cannot_ask_for_much_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.mat");
    let mut file = std::fs::File::create(&path).unwrap();
    let mut header = [b' '; 128];
    header[..10].copy_from_slice(b"MATLAB 5.0");
    header[124..].copy_from_slice(&[0, 1, b'I', b'M']);
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let count: u32 = 500_000_000;
    let word = |value: u32| value.to_le_bytes();
    let element = [14, 8 * count - 1, 6, 8, 6, 0, 5, 8, count, 1, 1 << 16 | 1, 120, 9, count * 8];
    for value in element {
        packer.write_all(&word(value)).unwrap();
    }
    packer.write_all(&[0; 1 << 20]).unwrap();
    let packed = packer.finish().unwrap();
    file.write_all(&header).unwrap();
    file.write_all(&word(15)).unwrap();
    file.write_all(&word(packed.len() as u32)).unwrap();
    file.write_all(&packed).unwrap();
    drop(file);
    let error = read(&path, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
}

/// A CSV file that says it is a terabyte, but holds nothing beyond its first rows.
#[cfg(unix)]
#[test]
fn a_sparse_file_is_refused_without_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sparse.csv");
    let mut file = std::fs::File::create(&path).unwrap();
    file.write_all(b"time,u\n").unwrap();
    (0..2000).for_each(|k| writeln!(file, "{k},1").unwrap());
    if file.set_len(1 << 40).is_ok() {
        drop(file);
        assert!(read(&path, &ReadOptions::default()).is_err());
    }
}

proptest! {
    /// Whatever one changes in a file, it is read or refused, never a panic.
    #[test]
    fn changed_files_are_read_or_refused(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        for fixture in FIXTURES {
            let mut content = bytes(fixture);
            for (at, byte) in &changes {
                let at = at.index(content.len());
                content[at] = *byte;
            }
            if let Ok((recording, _)) = read_as(fixture, &content) {
                prop_assert!(recording.check().is_ok());
            }
        }
    }
}
