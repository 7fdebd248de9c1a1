//! What is written is read back to the same bits.

use drivescope_recording::{CsvStream, ReadOptions, Recording, Signal, read, write};
use proptest::prelude::*;

/// Any number, with the awkward ones often enough; NaN has one bit pattern in text.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => any::<f64>(),
        2 => -1e3..1e3,
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, 5e-324, f64::MAX]),
    ]
    .prop_map(|value| if value.is_nan() { f64::NAN } else { value })
}

/// Sampling times and starts as people choose them: decimals of up to six digits.
fn decimal() -> impl Strategy<Value = f64> {
    (1_u32..1_000_000, 3_i32..9).prop_map(|(digits, down)| {
        format!("{digits}e-{down}").parse().expect("digits and an exponent")
    })
}

fn recording() -> impl Strategy<Value = Recording> {
    let signals =
        [("u", "N m"), ("omega", "rad/s"), ("T", "rpm"), ("odd, \"name\"", "µg"), ("x_9", "1")];
    (2_usize..60, 0_usize..5, decimal(), prop_oneof![Just(0.0), decimal()]).prop_flat_map(
        move |(samples, more, period_s, start_s)| {
            let columns = prop::collection::vec(prop::collection::vec(value(), samples), more + 1);
            columns.prop_map(move |columns| {
                let named = columns.into_iter().zip(signals);
                let signal = |(mut values, (name, unit)): (Vec<f64>, (&str, &str))| {
                    // What lacks at either end is left out by the reader.
                    for end in [0, values.len() - 1] {
                        if values[end].is_nan() {
                            values[end] = 0.0;
                        }
                    }
                    Signal { name: name.into(), unit: unit.into(), values }
                };
                Recording::new("", start_s, period_s, named.map(signal).collect())
            })
        },
    )
}

fn same_bits(written: &Recording, read: &Recording) {
    assert_eq!(written.period_s.to_bits(), read.period_s.to_bits(), "period");
    assert_eq!(written.start_s.to_bits(), read.start_s.to_bits(), "start");
    assert_eq!(written.signals.len(), read.signals.len());
    for (a, b) in written.signals.iter().zip(&read.signals) {
        assert_eq!((&a.name, &a.unit), (&b.name, &b.unit));
        let bits =
            |signal: &Signal| signal.values.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(a), bits(b), "{}", a.name);
    }
}

proptest! {
    #[test]
    fn csv_keeps_every_bit(written in recording()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, &written).unwrap();
        let (read, report) = read(&path, &ReadOptions::default()).unwrap();
        same_bits(&written, &read);
        prop_assert_eq!(report.samples, written.len());

        let file = std::fs::File::open(&path).unwrap();
        let mut stream = CsvStream::new(file, "a", &ReadOptions::default()).unwrap();
        let mut k = 0;
        while let Some(row) = stream.next_row().unwrap() {
            prop_assert_eq!(row.time_s.to_bits(), written.time(k).to_bits());
            for (signal, value) in written.signals.iter().zip(row.values) {
                prop_assert_eq!(signal.values[k].to_bits(), value.to_bits());
            }
            k += 1;
        }
        prop_assert_eq!(k, written.len());
    }

    #[test]
    fn no_text_whatever_makes_the_reader_panic(text in "([a-z,;\\t\"#\r\n.0-9 \\[\\]/-]|\\PC){0,200}") {
        if let Ok((recording, report)) =
            drivescope_recording::read_csv(text.as_bytes(), "a", &ReadOptions::default())
        {
            prop_assert_eq!(report.signals.len(), recording.signals.len());
        }
    }
}
