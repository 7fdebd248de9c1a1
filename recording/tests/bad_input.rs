//! Every kind of bad CSV: what is said, and where.

use std::fmt::Write as _;

use drivescope_recording::{
    Error, Mapping, ReadOptions, Recording, Report, read, read_csv, write, write_csv,
};

fn read_bytes(text: &[u8]) -> Result<(Recording, Report), Error> {
    read_csv(text, "rec.csv", &ReadOptions::default())
}

fn fails(text: &str) -> String {
    read_bytes(text.as_bytes()).expect_err(text).to_string()
}

fn says(text: &str, words: &[&str]) {
    let error = fails(text);
    for word in words {
        assert!(error.contains(word), "`{error}` does not say `{word}`");
    }
}

#[test]
fn too_little() {
    says("", &["rec.csv", "empty"]);
    says("\n \n", &["empty"]);
    says("time [s],u [V]\n", &["no rows of numbers", "header such as"]);
    says("time [s],u [V]\n0,1\n", &["one sample"]);
    says("time [s]\n0\n1\n", &["no signal"]);
}

#[test]
fn rows_that_are_not_rows() {
    says("time,u\n0,1\n1,2,3\n", &["rec.csv:3", "3 values", "2 columns"]);
    says("time,u\n0,1\n1\n", &["one sample"]);
    says("time,u\n0,a\n1,b\n", &["no signal"]);
    says("Log of May\n0,1\n1,2\n", &["rec.csv:2", "numbers, not names"]);
    // A decimal comma that parts fields, too.
    says("time,u\n0,0,1,5\n0,1,2,5\n0,2,3,5\n", &["rec.csv:2", "4 values", "2 columns"]);
    let columns = Mapping::parse_list("u=mode").unwrap();
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let error = read_csv(&b"time,i,mode\n0,1,H\n0.1,2,N\n"[..], "rec.csv", &options).unwrap_err();
    assert!(error.to_string().contains("rec.csv:2: column 3 `mode`: `H`"), "{error}");
    says("0,1\n1,2\n", &["rec.csv:1", "numbers, not names"]);
    // The joints of a robot one after the other, perhaps.
    let single: String = (0..40).map(|k| format!("{}.5\n", k % 7)).collect();
    says(&single, &["rec.csv:1", "one number a line", "beside each other", "--rows-every SECONDS"]);
    // Any of the blanks may part names.
    says("time Rotor angle u\n0 1 2\n1 2 3\n", &["rec.csv:2", "3 values", "4 columns", "quote"]);
}

#[test]
fn columns_that_cannot_be_told() {
    let untimed = ["no time column", "`u`, `i`", "--columns time=", "--rows-every SECONDS"];
    says("u [V],i [A]\n0,1\n1,2\n", &untimed);
    says("time,u,u\n0,1,1\n1,2,2\n", &["columns 2 and 3", "`u`"]);
    says("time,omega [parsec]\n0,1\n1,2\n", &["`omega`", "`parsec`", "rpm", "--columns omega="]);
    let columns = Mapping::parse_list("omega=Sped:rpm").unwrap();
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let error = read_csv(&b"time,Speed\n0,1\n1,2\n"[..], "rec.csv", &options).unwrap_err();
    assert!(error.to_string().contains("no column `Sped`"), "{error}");
}

#[test]
fn a_sampling_time_that_cannot_be_is_refused() {
    let text = "time [s],u\n0,0\n1,1\n2,2\n3,9\n4,10\n";
    for period in [-1.0, 0.0, 9.0, 1e-12] {
        let options =
            ReadOptions { columns: vec![], resample: Some(period), ..ReadOptions::default() };
        let refused = read_csv(text.as_bytes(), "a", &options);
        assert!(matches!(refused, Err(Error::Period { .. })), "{period}");
    }
    let options = ReadOptions { columns: vec![], resample: Some(0.5), ..ReadOptions::default() };
    let (fine, report) = read_csv(text.as_bytes(), "a", &options).unwrap();
    assert_eq!((fine.len(), report.sampling.resampled_from_s), (9, Some(1.0)));
}

#[test]
fn holes_are_read_located_and_refused_only_where_needed() {
    let mut text = String::from("time [s],u [V],omega [rad/s]\n");
    for k in 0..100 {
        let omega = if (40..45).contains(&k) { "NaN".into() } else { format!("{}", k % 7) };
        let u = if k == 60 { String::new() } else { format!("{k}") };
        writeln!(text, "{},{u},{omega}", f64::from(k) * 0.5).unwrap();
    }
    let (recording, report) = read_bytes(text.as_bytes()).unwrap();
    assert!(recording.signal("omega").unwrap().values[42].is_nan());
    let stated = report.to_string();
    assert!(stated.contains("omega: 5 samples missing or not finite, lines 42 to 46"), "{stated}");
    assert!(stated.contains("u: 1 samples missing or not finite, line 62"), "{stated}");
    let error = report.require(&recording, &["omega"]).unwrap_err().to_string();
    assert!(error.contains("rec.csv:42") && error.contains("`omega`"), "{error}");
    let error = report.require(&recording, &["i"]).unwrap_err().to_string();
    assert!(error.contains("no signal `i`") && error.contains("u [V]"), "{error}");
}

#[test]
fn bytes_that_are_not_text() {
    let zeros = read_bytes(b"time,u\n0,1\n\0\0\0\0\n").unwrap_err().to_string();
    assert!(zeros.contains("rec.csv:3") && zeros.contains("0x00"), "{zeros}");
    let (recording, report) = read_bytes(b"time [s],Winkel [\xb0]\n0,180\n1,\xff\n2,0\n").unwrap();
    assert_eq!(recording.signals[0].values[0], std::f64::consts::PI);
    assert!(recording.signals[0].values[1].is_nan());
    let stated = report.to_string();
    assert!(
        stated.contains("Windows-1252")
            && stated.contains("such as `\u{ff}`, and counts as missing, line 3"),
        "{stated}"
    );
}

#[test]
fn the_dialects_of_the_world_mean_the_same() {
    let plain = "time [s],u [V],omega [rad/s]\n0,1.5,-2\n0.5,2.5,-3e1\n1,3.5,4\n";
    let expected = read_bytes(plain.as_bytes()).unwrap().0;
    for text in [
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain.replace(',', ";").replace('.', ","),
        plain.replace(',', "\t"),
        plain.replace(',', " , "),
        plain.trim_end().to_owned(),
        plain.replace('\n', ",\n"),
        format!("# made by a logger\n\n{plain}"),
        plain.replace("time", "# time"),
        "time;u;omega\ns;V;rad/s\n0;1,5;-2\n0,5;2,5;-3e1\n1;3,5;4".into(),
        "time [s],u,omega\n\"0\",\"1,5\",\"-2\"\n\"0,5\",\"2,5\",\"-30\"\n1,\"3,5\",4".into(),
        plain.replace("0,1.5", "\n0,1.5"),
    ] {
        assert_eq!(read_bytes(text.as_bytes()).expect(&text).0, expected, "{text}");
    }
    let plain = "time [s],u [V],omega [rad/s]\n0,1.5,-2\n0.5,2.5,-3e1\n1,3.5,4\n";
    let units = plain.replace("[s]", "[ms]").replace("0.5,", "500,").replace("\n1,", "\n1000,");
    assert_eq!(read_bytes(units.as_bytes()).unwrap().0, expected);
}

#[test]
fn every_guess_is_said() {
    let text = "Timestamp (ms),Voltage,Speed [rpm],vibration\n0,1,30,1\n5,2,60,2\n10,3,90,3\n";
    let (recording, report) = read_bytes(text.as_bytes()).unwrap();
    assert_eq!(recording.period_s, 0.005);
    assert_eq!(recording.signal("omega").unwrap().unit, "rad/s");
    let stated = report.guesses();
    for sentence in [
        "column `Timestamp` [ms] taken as time, converted to s",
        "column `Voltage` taken as u, its unit as V",
        "column `Speed` [rpm] taken as omega, converted to rad/s",
        "column `vibration` is not known and kept as it is",
    ] {
        assert!(stated.iter().any(|it| it == sentence), "{sentence}: {stated:?}");
    }
}

#[test]
fn files_of_another_kind_are_known_whatever_their_name() {
    let folder = tempfile::tempdir().unwrap();
    for (content, what) in [
        (&b"\x89PNG\r\n\x1a\n\0\0"[..], "a picture (PNG)"),
        (b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n", "a document (PDF)"),
        (b"\x1f\x8b\x08\0", "packed by gzip"),
        (b"{\"time\": [0, 1], \"u\": [1, 2]}\n", "structured text (JSON)"),
        (b"<html><table><tr><td>0</td></tr></table></html>\n", "structured text (HTML"),
        (b"Dear reader,\nthis has 2 lines, and no table.\n", "no rows of numbers"),
    ] {
        let path = folder.path().join("log.csv");
        std::fs::write(&path, content).unwrap();
        let error = read(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("log.csv: ") && error.contains(what), "{error}");
    }
}

#[test]
fn paths_that_are_no_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let options = ReadOptions::default();
    let error = |path: &std::path::Path| read(path, &options).unwrap_err();
    assert!(matches!(error(folder.path()), Error::IsFolder { .. }));
    let missing = error(&folder.path().join("none.csv")).to_string();
    assert!(missing.contains("none.csv") && missing.contains("cannot be read"), "{missing}");
    std::fs::write(folder.path().join("a.xyz"), [0, 1, 2, 3, 255]).unwrap();
    assert!(matches!(error(&folder.path().join("a.xyz")), Error::Format { .. }));

    let recording = read_bytes(b"time,u\n0,1\n1,2\n").unwrap().0;
    let nowhere = write_csv(folder.path().join("no/such/a.csv"), &recording).unwrap_err();
    assert!(nowhere.to_string().contains("cannot be written"), "{nowhere}");
    std::fs::create_dir(folder.path().join("taken.csv")).unwrap();
    assert!(write(folder.path().join("taken.csv"), &recording).is_err());
    assert!(matches!(write("a.mat", &recording), Err(Error::WriteFormat { .. })));
    let mut uneven = recording.clone();
    uneven.signals.push(drivescope_recording::Signal {
        name: "i".into(),
        unit: "A".into(),
        values: vec![],
    });
    let kept = folder.path().join("kept.csv");
    write(&kept, &recording).unwrap();
    assert!(matches!(write(&kept, &uneven), Err(Error::UnequalLengths { .. })));
    assert_eq!(read(&kept, &options).unwrap().0.signals, recording.signals);
    let remaining: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|it| it.unwrap()).collect();
    assert_eq!(remaining.len(), 3, "a temporary file stayed behind: {remaining:?}");
}
