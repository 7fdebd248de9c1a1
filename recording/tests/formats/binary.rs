//! MAT, HDF5, TDMS, MDF and Parquet.

use drivescope_recording::{Constant, Error, ReadOptions, Recording, read, write};

use crate::{bytes, fixture, read_as, read_with, same_as_csv, values};

fn constants(report: &drivescope_recording::Report) -> Vec<(&str, f64)> {
    report.constants.iter().map(|Constant { name, value }| (name.as_str(), *value)).collect()
}

#[test]
fn scipy_s_vectors_are_read_packed_and_plain() {
    for name in ["plain.mat", "packed.mat"] {
        let (recording, report) = fixture(name);
        same_as_csv(&recording, &["u", "i", "omega"]);
        assert_eq!(recording.signals.len(), 3);
        assert_eq!(constants(&report), [("J", 2.5e-4), ("K_m", 0.05)]);
        for left_out in [
            "`note` is a text",
            "`late` has 2 values, others have 40",
            "`spectrum` is a complex matrix",
        ] {
            assert!(report.to_string().contains(left_out), "{left_out}: {report}");
        }
    }
}

#[test]
fn a_matrix_gives_columns_and_a_scalar_the_sampling_time() {
    let (recording, report) = read_with("period.mat", "u=data_1,omega=data_2:rpm").unwrap();
    same_as_csv(&recording, &["u", "omega"]);
    assert!(report.constants.is_empty());
}

#[test]
fn structs_and_cells_are_opened() {
    let (recording, report) = fixture("struct.mat");
    same_as_csv(&recording, &["u", "i", "omega"]);
    assert_eq!(constants(&report), [("J", 2.5e-4), ("K_m", 0.05)]);
    let (recording, _) = read_with("simulink.mat", "i=motor_1,omega=motor_2:rpm").unwrap();
    same_as_csv(&recording, &["u", "i", "omega"]);
    let (recording, _) = read_with("cell.mat", "time=log{1},u=log{2}").unwrap();
    same_as_csv(&recording, &["u"]);
}

#[test]
fn objects_of_matlab_are_named_with_what_to_save_in_their_place() {
    let element = |kind: u32, data: &[u8]| {
        let mut made = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        made.extend(data);
        made.resize(made.len().next_multiple_of(8), 0);
        made
    };
    let workspace = element(9, &[0; 800]);
    let dimensions: Vec<u8> = [1_u32, 100].iter().flat_map(|it| it.to_le_bytes()).collect();
    let object = [
        element(6, &[17, 0, 0, 0, 0, 0, 0, 0]),
        element(1, b"speed"),
        element(1, b"MCOS"),
        element(1, b"timeseries"),
    ];
    // MATLAB's own workspace, without a name, in which what an object holds lies as it pleases.
    let own = [
        element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
        element(5, &dimensions),
        element(1, b""),
        workspace,
    ];
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend([0, 1, b'I', b'M']);
    file.extend(element(14, &object.concat()));
    file.extend(element(14, &own.concat()));
    let stated = read_as("log.mat", &file).unwrap_err().to_string();
    assert!(stated.contains("variable `speed` is a MATLAB object"), "{stated}");
    assert!(stated.contains("squeeze(x.Data)"), "{stated}");
}

#[test]
fn varieties_that_are_not_read_are_named_with_the_way_out() {
    let fails = |name: &str, bytes: &[u8]| read_as(name, bytes).unwrap_err().to_string();
    let cases: [(&str, Vec<u8>, &str); 6] = [
        ("a.xls", bytes("log.xls"), "Excel 97"),
        ("a.mat", bytes("version4.mat"), "version 4"),
        ("a.mat", b"# Created by Octave 8.4\n# name: u\n".to_vec(), "text form"),
        ("a.mf4", [&b"MDF     3.30    "[..], &[0; 200]].concat(), "older than version 4"),
        ("a.parquet", bytes("zstd.parquet"), "ZSTD"),
        ("a.tdms", [&b"TDSm\x8e\0\0\0\x69\x12\0\0"[..], &[0xff; 40]].concat(), "DAQmx"),
    ];
    for (name, content, word) in cases {
        let stated = fails(name, &content);
        assert!(stated.contains(word) && stated.contains("tools/convert_recording.py"), "{stated}");
    }
}

#[test]
fn hdf5_in_every_layout() {
    for name in ["log.h5", "latest.hdf5"] {
        let (recording, report) = fixture(name);
        same_as_csv(&recording, &["u", "i", "omega"]);
        assert_eq!(constants(&report), [("J", 2.5e-4), ("K_m", 0.05)]);
        let stated = report.to_string();
        assert!(stated.contains("`late` has 2 values") && stated.contains("`comment` is a text"));
        let (recording, _) = read_with(name, "u=daq.u").unwrap();
        same_as_csv(&recording, &["u", "i", "omega"]);
    }
    same_as_csv(&fixture("table.h5").0, &["u", "i", "omega"]);
}

#[test]
fn matlab_7_3_is_hdf5() {
    let (recording, report) = fixture("matlab73.mat");
    same_as_csv(&recording, &["u", "i", "omega"]);
    let csv = fixture("log.csv").0;
    assert_eq!(values(&recording, "both_1"), values(&csv, "u"));
    assert_eq!(values(&recording, "both_2"), values(&csv, "i"));
    // A position beside a speed in rpm is an angle.
    assert_eq!(values(&recording, "theta"), values(&csv, "u"));
    assert_eq!(values(&recording, "x_b"), values(&csv, "i"));
    assert_eq!(constants(&report), [("J", 2.5e-4), ("K_m", 0.05)]);
    assert!(report.to_string().contains("`note` is a text"), "{report}");
}

#[test]
fn tdms_with_waveforms_and_with_a_time() {
    for name in ["waveform.tdms", "segments.tdms", "chunks.tdms", "interleaved.tdms", "big.tdms"] {
        let (recording, report) = fixture(name);
        same_as_csv(&recording, &["u", "i", "omega"]);
        if name == "waveform.tdms" {
            assert_eq!(constants(&report), [("J", 2.5e-4), ("K_m", 0.05)]);
        }
        if name == "segments.tdms" {
            assert!(report.to_string().contains("`bench.state` holds texts"), "{report}");
        }
    }
    let (recording, _) = fixture("scaled.tdms");
    let scaled = values(&recording, "u");
    let raw = values(&recording, "raw");
    assert!(scaled.iter().zip(raw).all(|(u, raw)| *u == raw * 0.001 + 0.5));
}

#[test]
fn mdf_plain_packed_and_of_several_groups() {
    for name in ["log.mf4", "packed.mf4", "unsorted.mf4"] {
        let (recording, report) = fixture(name);
        same_as_csv(&recording, &["u", "i", "omega"]);
        let temperature = values(&recording, "temperature");
        let expected = 20.25 + 273.15;
        assert!((temperature[10] - expected).abs() < 1e-9, "{name}: {}", temperature[10]);
        assert_eq!(report.joined.len(), 1);
        let stated = report.to_string();
        assert!(stated.contains("`temperature [degC]` of `slow` (3 samples)"), "{stated}");
        let raw = values(&recording, "u_raw");
        assert_eq!(
            raw,
            values(&fixture("log.csv").0, "u").iter().map(thousandths).collect::<Vec<_>>()
        );
    }
}

fn thousandths(u: &f64) -> f64 {
    0.001 * (u / 0.001).round_ties_even()
}

#[test]
fn pyarrow_s_types_are_read() {
    same_as_csv(&fixture("log.parquet").0, &["u", "i", "omega"]);
    let (recording, report) = fixture("types.parquet");
    assert_eq!((recording.start_s, recording.period_s), (0.0, 0.005));
    assert_eq!(values(&recording, "on"), [1.0, 0.0, 1.0, 1.0]);
    let milli = |i: &f64| f64::from((1000.0 * i) as f32) / 1e3;
    let expected: Vec<f64> = values(&fixture("log.csv").0, "i")[..4].iter().map(milli).collect();
    assert_eq!(values(&recording, "i"), expected);
    let omega = values(&recording, "omega");
    assert_eq!(omega[3], 120.0 * std::f64::consts::PI / 30.0);
    assert!(omega[2].is_nan());
    let stated = report.to_string();
    assert!(stated.contains("omega: 1 samples missing or not finite, row 3"), "{stated}");
    assert!(stated.contains("column `comment` is not a plain series"), "{stated}");
    let error = report.require(&recording, &["omega"]).unwrap_err().to_string();
    assert!(error.contains("types.parquet, row 3"), "{error}");
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
    let written = Recording::new("a", 2.0, 0.005, signals);
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

#[test]
fn nothing_but_numbers_is_no_recording() {
    for name in ["numbers.mat", "numbers.h5"] {
        let error = read_with(name, "").unwrap_err();
        assert!(matches!(error, Error::NoSeries { .. }), "{error}");
    }
}
