//! A clean file spoiled in the ways of the world's loggers comes back with exactly its values.

use drivescope_recording::{CsvStream, Mapping, ReadOptions, Recording, Report, read_csv};
use proptest::prelude::*;

fn read_as(text: &[u8], columns: &str) -> (Recording, Report) {
    let columns = Mapping::parse_list(columns).unwrap();
    let options = ReadOptions { columns, ..ReadOptions::default() };
    read_csv(text, "log.csv", &options)
        .unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(text)))
}

fn read(text: &str) -> (Recording, Report) {
    read_as(text.as_bytes(), "")
}

fn values<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    &recording.needed(name).unwrap_or_else(|error| panic!("{error}")).values
}

const U: [f64; 4] = [1.5, -2.25, 3.125, 4.0];

/// Every one of these is the same recording: u in V at 0, 0.5, 1 and 1.5 s.
#[test]
fn layouts_of_every_kind_hold_the_same_values() {
    for text in [
        // Declared delimiters and preambles.
        "sep=;\ntime [s];u [V]\n0;1,5\n0,5;-2,25\n1;3,125\n1,5;4\n",
        "sep=|\ntime [s]|u [V]\n0|1.5\n0.5|-2.25\n1|3.125\n1.5|4\n",
        "Messung 7\nDatum: 03.05.2024 12:00\nOperator;Test\n\ntime [s];u [V]\n0;1.5\n0.5;-2.25\n1;3.125\n1.5;4\n",
        "Channel 1;time\nChannel 2;u\nKanal;Einheit;Faktor\ntime;u\ns;V\n0;1,5\n0,5;-2,25\n1;3,125\n1,5;4\n",
        "% made by a tool\n// in May, 2024\n; old\n# more, here\ntime [s],u [V]\n0,1.5\n0.5,-2.25\n1,3.125\n1.5,4\n",
        "Gain=5\nOffset: 3\ntime [s]\tu [V]\n0\t1,5\n0,5\t-2,25\n1\t3,125\n1,5\t4\n",
        // Blanks, units below, a rule, quotes, bars.
        "  time [s]   u [V]\n   0.0       1.5\n   0.5      -2.25\n   1.0       3.125\n   1.5       4.0\n",
        "time[s] u[V]\n0.0 1.5\n0.5 -2.25\n1.0 3.125\n1.5 4.0\n",
        // A blank in a name, told by what the words mean together.
        "time[s] Vitesse mesurée[rad_s] aux3 u[V]\n0.0 7 3 1.5\n0.5 8 2 -2.25\n1.0 9 1 3.125\n1.5 9 4 4.0\n",
        "time;u\n[s];[V]\n0;1,5\n0,5;-2,25\n1;3,125\n1,5;4\n",
        "time [s] | u\n-----|-----\n0 | 1.5\n0.5 | -2.25\n1 | 3.125\n1.5 | 4\n",
        "\"time [s]\",\"u [V]\"\n\"0\",\"1.5\"\n\"0.5\",\"-2.25\"\n\"1\",\"3.125\"\n\"1.5\",\"4\"\n",
        // Line ends, trailing delimiters, footers, an incomplete row, a long one among many.
        "time [s],u [V]\r0,1.5\r0.5,-2.25\r1,3.125\r1.5,4\r",
        "time [s];u [V];\n0;1.5;\n0.5;-2.25;\n1;3.125;\n1.5;4;\n",
        "time [s],u [V]\n0,1.5,\n0.5,-2.25,\n1,3.125,\n1.5,4,\n",
        "time [s],u [V]\n0,1.5\n0.5,-2.25\n1,3.125\n1.5,4\nEnd of file\n",
        "time [s],u [V]\n0,1.5\n0.5,-2.25\n1,3.125\n1.5,4\nstopped,by hand\n,\n",
        "time [s],u [V]\n0,1.5\n0.5,-2.25\n1,3.125\n1.5,4\n2.0",
        "time [s],u [V]\n0,1.5\n0.5,-2.25\n1,3.125\n1.5,4\nMean,1.6\n",
        "X_Dimension\tTime\tTime\t\n***End***\t\t\t\nX_Value [s]\tu [V]\tComment\n0\t1.5\n0.5\t-2.25\n1\t3.125\n1.5\t4\n",
        "time;u\n0 s;1,5 V\n0,5 s;-2,25 V\n1 s;3,125 V\n1,5 s;4 V\n",
        // Columns that say nothing.
        "time [s],note,u [V],empty,mode\n0,a,1.5,,H\n0.5,b,-2.25,,H\n1,c,3.125,,N\n1.5,d,4,,N\n",
        "time [s],u [V],load [rad],more\n0,1.5\n0.5,-2.25\n1,3.125\n1.5,4\n",
        "mode,time [s],u [V]\nH,0,1.5\nH,0.5,-2.25\nN,1,3.125\nN,1.5,4\n",
        // Numbered rows of R.
        "\"time [s]\" \"u [V]\"\n\"1\" 0 1.5\n\"2\" 0.5 -2.25\n\"3\" 1 3.125\n\"4\" 1.5 4\n",
        // Clocks.
        "time,u [V]\n12:00:01.000,1.5\n12:00:01.500,-2.25\n12:00:02.000,3.125\n12:00:02.500,4\n",
        "Uhrzeit;u [V]\n23:59:59,000;1,5\n23:59:59,500;-2,25\n00:00:00,000;3,125\n00:00:00,500;4\n",
        "Timestamp,u [V]\n2024-05-03T12:00:01.250Z,1.5\n2024-05-03T12:00:01.750Z,-2.25\n2024-05-03T12:00:02.250Z,3.125\n2024-05-03T12:00:02.750Z,4\n",
        "Stamp,u [V]\n2024-05-03 12:00:01.250+02:00,1.5\n2024-05-03 12:00:01.750+02:00,-2.25\n2024-05-03 12:00:02.250+02:00,3.125\n2024-05-03 12:00:02.750+02:00,4\n",
        "Datum;Uhrzeit;u [V]\n03.05.2024;23:59:59;1,5\n03.05.2024;23:59:59,5;-2,25\n04.05.2024;00:00:00;3,125\n04.05.2024;00:00:00,5;4\n",
        "when,u [V]\n05/03/2024 12:00:01.0 PM,1.5\n05/03/2024 12:00:01.5 PM,-2.25\n05/03/2024 12:00:02 PM,3.125\n05/03/2024 12:00:02.5 PM,4\n",
        "t,u [V]\n59:59.0,1.5\n59:59.5,-2.25\n00:00.0,3.125\n00:00.5,4\n",
        "date time u\n2024-05-03 12:00:01.0 1.5\n2024-05-03 12:00:01.5 -2.25\n2024-05-03 12:00:02.0 3.125\n2024-05-03 12:00:02.5 4\n",
        "Time (HH:mm:ss.fff),u [V]\n00:00:01.000,1.5\n00:00:01.500,-2.25\n00:00:02.000,3.125\n00:00:02.500,4\n",
        // Stamps since 1970, and time without a unit.
        "time,u [V]\n1714730401.123456,1.5\n1714730401.623456,-2.25\n1714730402.123456,3.125\n1714730402.623456,4\n",
        "time,u [V]\n1714730401123,1.5\n1714730401623,-2.25\n1714730402123,3.125\n1714730402623,4\n",
        "time,u [V]\n1714730401123456789,1.5\n1714730401623456789,-2.25\n1714730402123456789,3.125\n1714730402623456789,4\n",
        "timestamp [us],u [V]\n1714730401123456,1.5\n1714730401623456,-2.25\n1714730402123456,3.125\n1714730402623456,4\n",
        "time,u [V]\n0,1.5\n500000000,-2.25\n1000000000,3.125\n1500000000,4\n",
        "# Sampling rate: 2 Hz\nu [V],i [A]\n1.5,0\n-2.25,0\n3.125,0\n4,0\n",
    ] {
        let (recording, report) = read(text);
        assert_eq!(values(&recording, "u"), U, "{text}\n{report}");
        assert_eq!(recording.start_s, 0.0, "{text}");
        assert_eq!(recording.period_s, 0.5, "{text}\n{report}");
    }
}

#[test]
fn time_without_a_unit_is_guessed_by_its_steps() {
    for (step, unit, period_s) in
        [("0.01", "s", 0.01), ("2", "ms", 2e-3), ("1000", "us", 1e-3), ("1000000", "ns", 1e-3)]
    {
        let step: f64 = step.parse().unwrap();
        let rows: String = (0..5).map(|k| format!("{},{k}\n", f64::from(k) * step)).collect();
        let (recording, report) = read(&format!("time,u\n{rows}"));
        assert_eq!(recording.period_s, period_s, "{unit}");
        let stated = report.to_string();
        assert!(unit == "s" || stated.contains(&format!("{step} {unit}, a guess")), "{stated}");
    }
    assert!(read("time,u\n0,1\n1,2\n2,4\n").1.to_string().contains("counts rows"));
}

#[test]
fn what_is_left_out_is_said() {
    for (text, words) in [
        ("time [s],u,mode\n0,1,H\n0.1,2,N\n", "column `mode` holds text, such as `H`"),
        ("time [s],u,b\n0,1,\n0.1,2,\n", "column `b` is empty"),
        ("time [s],u\n0,1\n0.1,2\nDone\n", "text without numbers, line 4"),
        ("time [s],u\n0,1\n0.1,2\n0.2", "line 4, the last one"),
        ("time [s],u\n0,1\n0.1,2\n0.2,---\n", "1 cell holds no number, such as `---`"),
        ("time [s],u,on\n0,1,true\n0.1,2,false\n", "on and off, read as 1 and 0"),
        ("Title\ntime [s],u\n0,1\n0.1,2\n", "line 2 is the header; 1 lines above it"),
        ("time [s],u,i\n0,1,2\n0.1,2\n0.2,3,4\n", "1 rows lack values at their end"),
        ("time [s],u,id\n0,1,00A3\n0.1,2,1E05\n0.2,3,00B4\n", "column `id` holds text"),
    ] {
        let stated = read(text).1.to_string();
        assert!(stated.contains(words), "{words}: {stated}");
    }
    let many: String = (0..30).map(|k| format!("{},{k}\n", f64::from(k) * 0.25)).collect();
    let (recording, report) = read(&format!("time [s],u\n{many}7.5,1,2,3\n7.5,30\n"));
    assert_eq!(recording.len(), 31);
    assert!(report.to_string().contains("the first line 32 with 4"), "{report}");
}

#[test]
fn files_joined_end_to_end_are_runs_by_their_clock() {
    let one = "time [s],u\n0,1\n0.1,2\n0.2,3\n";
    assert_eq!(read(&format!("{one}{one}")).0.segments(), [0..3, 3..6]);
    // A header on every page of one run is no break.
    let on = read("time [s],u\n0,1\n0.1,2\ntime [s],u\n0.2,3\n0.3,4\n");
    assert!(on.0.breaks.is_empty() && values(&on.0, "u") == [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn thousands_and_decimals_are_told_apart_where_a_column_tells() {
    for (cells, expected) in [
        (["1.234,5", "999,5", "1.234", "2.000.000,25"], [1234.5, 999.5, 1234.0, 2_000_000.25]),
        (["1,234.5", "999.5", "1,234", "2,000,000.25"], [1234.5, 999.5, 1234.0, 2_000_000.25]),
        (["1 234,5", "999,5", "1 234", "2 000 000,25"], [1234.5, 999.5, 1234.0, 2_000_000.25]),
        (["1,234", "1,235", "1,236", "1,237"], [1.234, 1.235, 1.236, 1.237]),
    ] {
        let rows = cells.iter().enumerate();
        let rows: String = rows.map(|(k, cell)| format!("{};{cell}\n", k * 10)).collect();
        let (recording, report) = read(&format!("time [ms];u [V]\n{rows}"));
        assert_eq!(values(&recording, "u"), expected, "{report}");
    }
}

#[test]
fn counts_are_angles_once_their_number_is_told() {
    let rows = "0,0\n0.1,1024\n0.2,4096\n";
    let turn = [0.0, 0.25, 1.0].map(|turns| turns * std::f64::consts::TAU);
    for (text, columns) in [
        (format!("time [s],theta [counts/4096]\n{rows}"), ""),
        (format!("time [s],enc\n{rows}"), "theta=enc:counts/4096"),
        (format!("Counts per revolution: 4096\ntime [s],theta [counts]\n{rows}"), ""),
    ] {
        assert_eq!(values(&read_as(text.as_bytes(), columns).0, "theta"), turn, "{text}");
    }
    let (kept, report) = read(&format!("time [s],theta [counts]\n{rows}"));
    assert!(kept.signal("theta").is_none() && kept.signal("theta_counts").is_some());
    assert!(report.to_string().contains("--columns theta=theta:counts/4096"), "{report}");
}

#[test]
fn a_stream_finds_its_header_below_a_preamble_and_in_latin_1() {
    let mut text = b"Log 7\nsep=;\n# by hand\nZeit [s];Winkel [\xb0]\n".to_vec();
    text.extend_from_slice(b"0;180\n0,5;90\n");
    let mut stream = CsvStream::new(&text[..], "-", &ReadOptions::default()).unwrap();
    assert_eq!(stream.columns()[0].signal, "theta");
    let row = stream.next_row().unwrap().unwrap();
    assert_eq!((row.line, row.values[0]), (5, std::f64::consts::PI));
    assert_eq!(stream.next_row().unwrap().unwrap().time_s, 0.5);
    assert_eq!(stream.next_row().unwrap(), None);
}

/// How a clean file is spoiled.
#[derive(Debug, Clone)]
struct Spoiling {
    encoding: u8,
    delimiter: char,
    decimal_comma: bool,
    line_end: &'static str,
    preamble: &'static str,
    text_column: Option<usize>,
    footer: &'static str,
    trailing: bool,
}

fn spoiling() -> impl Strategy<Value = Spoiling> {
    let preamble = prop::sample::select(vec![
        "",
        "Prüfstand 3\n",
        "# log; by hand, 2024\n",
        "Title\nDate: 2024-05-03 12:00:00\nOperator: N. N.\n\n",
        "Gerät;A7\nKanäle;3\nStart;12:00:01\n",
        "% a comment\n% another, with 3 words\n",
    ]);
    let footer = prop::sample::select(vec!["", "Ende der Messung\n", "# end\n", "\n\n"]);
    let delimiter = prop::sample::select(vec![',', ';', '\t', '|']);
    let line_end = prop::sample::select(vec!["\n", "\r\n", "\r"]);
    let text_column = prop::option::of(0_usize..4);
    (0_u8..6, delimiter, any::<bool>(), line_end, preamble, text_column, footer, any::<bool>())
        .prop_map(
            |(encoding, delimiter, comma, line_end, preamble, text_column, footer, trailing)| {
                let decimal_comma = comma && delimiter != ',';
                Spoiling {
                    encoding,
                    delimiter,
                    decimal_comma,
                    line_end,
                    preamble,
                    text_column,
                    footer,
                    trailing,
                }
            },
        )
}

impl Spoiling {
    fn line(&self, mut fields: Vec<String>, word: &str) -> String {
        if let Some(at) = self.text_column {
            fields.insert(at.min(fields.len()), word.to_owned());
        }
        let mark = self.delimiter.to_string();
        let end = if self.trailing { mark.as_str() } else { "" };
        format!("{}{end}\n", fields.join(&mark))
    }

    fn file(&self, rows: &[[f64; 2]]) -> Vec<u8> {
        let number = |value: f64| {
            let text = format!("{value:?}");
            if self.decimal_comma { text.replace('.', ",") } else { text }
        };
        let header = ["Zeit [s]", "Spannung [V]", "Temperatur [°C]"].map(str::to_owned).to_vec();
        let mut text = self.preamble.to_owned() + &self.line(header, "Bemerkung");
        for (k, [u, warm]) in rows.iter().enumerate() {
            let fields = [k as f64 * 0.01, *u, *warm].map(number).to_vec();
            text += &self.line(fields, if k % 3 == 0 { "gut" } else { "schön" });
        }
        let text = (text + self.footer).replace('\n', self.line_end);
        let utf_16 = || text.encode_utf16();
        match self.encoding {
            0 => text.into_bytes(),
            1 => format!("\u{feff}{text}").into_bytes(),
            2 => [0xfeff].into_iter().chain(utf_16()).flat_map(u16::to_le_bytes).collect(),
            3 => [0xfeff].into_iter().chain(utf_16()).flat_map(u16::to_be_bytes).collect(),
            4 => utf_16().flat_map(u16::to_le_bytes).collect(),
            _ => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect(),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// No spoiled file is refused, and none is read wrongly.
    #[test]
    fn spoiled_files_give_back_exactly_their_values(
        spoiling in spoiling(),
        rows in prop::collection::vec([-1e4..1e4_f64, 0.0..100.0_f64], 3..40),
    ) {
        let file = spoiling.file(&rows);
        let read = read_csv(&file[..], "log.csv", &ReadOptions::default());
        let (recording, _) = match read {
            Ok(read) => read,
            Err(error) => return Err(TestCaseError::fail(format!(
                "{error}\n{}", String::from_utf8_lossy(&file)
            ))),
        };
        prop_assert_eq!(recording.signals.len(), 2);
        prop_assert_eq!(recording.period_s, 0.01);
        for (k, [u, warm]) in rows.iter().enumerate() {
            prop_assert_eq!(values(&recording, "u")[k].to_bits(), u.to_bits());
            prop_assert_eq!(values(&recording, "temperature")[k], warm + 273.15);
        }
    }
}

#[test]
fn a_file_without_names_is_read_by_number() {
    let rows: String =
        (0..200).map(|k| format!("1297.{:02};{};{}\n", k % 100, k % 7, k % 5)).collect();
    let rows = rows.replacen("1297.", "1296.", 100);
    let (recording, report) = read(&rows);
    assert_eq!((recording.len(), recording.period_s), (200, 0.01));
    assert_eq!(values(&recording, "column 2")[..3], [0.0, 1.0, 2.0]);
    assert!(report.to_string().contains("`column 1` runs like a clock"), "{report}");
    let columns = Mapping::parse_list("i=column 2,omega=column 3:rpm").unwrap();
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let (recording, _) = read_csv(rows.as_bytes(), "log.txt", &options).unwrap();
    assert_eq!(values(&recording, "i")[..3], [0.0, 1.0, 2.0]);
}
