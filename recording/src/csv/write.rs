//! CSV as every tool reads it: comma, point, UTF-8, `name [unit]`, shortest exact numbers.

use std::io::{self, Write};

use crate::signal::{Recording, TextSignal};

/// Writes header and rows. Numbers have as many digits as it takes to read the same bits again.
pub(crate) fn write(out: impl Write, recording: &Recording) -> io::Result<()> {
    write_with_texts(out, recording, &[])
}

/// The same with columns of text behind the numbers, their headers bare names.
pub(crate) fn write_with_texts(
    out: impl Write,
    recording: &Recording,
    texts: &[TextSignal],
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let segment = recording.segment_column();
    let signals = || recording.signals.iter().chain(&segment);
    csv.write_field("time [s]")?;
    for signal in signals() {
        csv.write_field(signal.header())?;
    }
    for signal in texts {
        csv.write_field(&signal.name)?;
    }
    csv.write_record(None::<&[u8]>)?;
    let mut text = Vec::new();
    let clock = recording.clock();
    let rows = texts.first().map_or(0, |signal| signal.values.len()).max(recording.len());
    for k in 0..rows {
        let values = signals().map(|signal| signal.values[k]);
        for value in std::iter::once(clock.time(k)).chain(values) {
            text.clear();
            // `{:?}` is the shortest text that parses to the same bits, with an exponent where
            // it is shorter than zeros.
            write!(text, "{value:?}")?;
            csv.write_field(&text)?;
        }
        for signal in texts {
            csv.write_field(&signal.values[k])?;
        }
        csv.write_record(None::<&[u8]>)?;
    }
    csv.flush()
}
