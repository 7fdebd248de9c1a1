//! What can be wrong with a recording, where, and what to do about it.

use std::io;

use crate::place::Place;
use crate::rounded::rounded;

/// Why a recording could not be read, used or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Read { file: String, source: io::Error },
    /// The path is a folder.
    #[error("{file}: is a folder; name the recording inside it")]
    IsFolder {
        /// The path as the user named it.
        file: String,
    },
    /// Neither first bytes nor extension tell a format.
    #[error(
        "{file}: is a recording in no known format; read are {known}, so export it as one of them"
    )]
    Format {
        file: String,
        /// The formats that are read.
        known: String,
    },
    /// A file of another kind, whatever its name says.
    #[error("{file}: is {what}, no recording; read are {known}, so export it as one of them")]
    Other {
        file: String,
        what: &'static str,
        /// The formats that are read.
        known: String,
    },
    /// The file cannot be written.
    #[error("{file}: cannot be written: {source}")]
    Write { file: String, source: io::Error },
    /// Reading is all that is offered for the format.
    #[error("{file}: such files are not written; name it {known}")]
    WriteFormat {
        file: String,
        /// The extensions that are written.
        known: String,
    },
    /// Nothing in the file.
    #[error("{file}: is empty; a recording starts with a header such as `time [s],u [V],i [A]`")]
    Empty { file: String },
    /// Names, or any other text, but no samples.
    #[error(
        "{file}: holds no rows of numbers; a recording is a table with a header such as \
         `time [s],u [V],i [A]` and numbers below it"
    )]
    HeaderOnly { file: String },
    /// A single sample tells no sampling time.
    #[error("{file}: holds one sample; at least two are needed to know the sampling time")]
    OneRow { file: String },
    /// The first line holds values.
    #[error(
        "{place}: the first line holds numbers, not names; put a header such as \
         `time [s],u [V],i [A]` above it"
    )]
    NoHeader {
        /// The first line.
        place: Place,
    },
    /// A single value a line, without a name.
    #[error(
        "{place}: one number a line and no names; a recording has a column for every signal: put \
         them beside each other, a row for each sample, or put a name such as `omega [rad/s]` above \
         these numbers and say how far apart they lie with --rows-every SECONDS"
    )]
    OneValue {
        /// The first line.
        place: Place,
    },
    /// A row with another number of values than the header has names.
    #[error(
        "{place}: {found} values, but the header names {expected} columns; name every column once, \
         and quote a name or a number that holds what parts them"
    )]
    Ragged {
        place: Place,
        /// Values in the row.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// Text where a number should be.
    #[error(
        "{place}: column {position} `{column}`: `{text}` is not a number; map another column, or \
         write numbers there"
    )]
    NotANumber {
        place: Place,
        /// Which column, the first is 1.
        position: usize,
        /// The column's name.
        column: String,
        /// What stands there.
        text: String,
    },
    /// Bytes that are no text.
    #[error(
        "{place}: column {position} is no text (byte 0x{byte:02x}); save the recording as CSV text"
    )]
    NotUtf8 {
        place: Place,
        /// Which column, the first is 1.
        position: usize,
        /// The first byte that is none.
        byte: u8,
    },
    /// A line is longer than any header.
    #[error(
        "{place}: no line end within {limit} bytes; this is not a CSV file: export the recording as \
         one"
    )]
    EndlessLine {
        /// Where the line starts.
        place: Place,
        /// Bytes looked at.
        limit: usize,
    },
    /// No column is the time.
    #[error(
        "{file}: no time column among {columns}; name it with --columns time=NAME:UNIT, or, where \
         rows lie evenly, say how far apart with --rows-every SECONDS"
    )]
    MissingTime {
        file: String,
        /// The names that are there.
        columns: String,
    },
    /// Nothing but time.
    #[error("{file}: holds time but no signal; a column of numbers beside it is needed")]
    NoSignals { file: String },
    /// Two columns of one name.
    #[error(
        "{file}: columns {first} and {second} are both called `{name}`; rename one, or leave \
         what is not meant out, as with --columns {unused}"
    )]
    DuplicateColumn {
        file: String,
        name: String,
        /// The earlier column, the first is 1.
        first: usize,
        /// The later one.
        second: usize,
        /// What leaves all but the first out.
        unused: String,
    },
    /// Two columns mapped to one signal.
    #[error(
        "{file}: `{name}` is both column `{first}` and column `{second}`; give one another name, \
         as in --columns {name}_2={second}"
    )]
    DuplicateSignal {
        file: String,
        name: String,
        /// The earlier column.
        first: String,
        /// The later one.
        second: String,
    },
    /// A unit that the signal cannot have.
    #[error(
        "{file}: column `{column}`: `{unit}` is no unit of {signal}; known are {known}. Say which \
         with --columns {signal}={column}:UNIT"
    )]
    UnknownUnit {
        file: String,
        column: String,
        /// The signal it stands for.
        signal: String,
        /// The unit that it carries.
        unit: String,
        /// Units that would do.
        known: String,
    },
    /// An item of `--columns` that is none.
    #[error("`{text}` is not a column mapping; write signal=COLUMN or signal=COLUMN:UNIT")]
    Mapping { text: String },
    /// A file of kept mappings that is none.
    #[error("{file}: {reason}; mend it, or remove it to have the columns guessed again")]
    Kept {
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A mapping to a column that is not there.
    #[error("{file}: has no column `{column}` to take as {signal}; it has {columns}")]
    MappedColumn {
        file: String,
        /// The column asked for.
        column: String,
        /// The signal it was to be.
        signal: String,
        /// The names that are there.
        columns: String,
    },
    /// A time stamp that is no number.
    #[error(
        "{place}: time is missing or not finite; cut the rows without one, or name the column of \
         time with --columns time=NAME:UNIT"
    )]
    TimeNotFinite { place: Place },
    /// Time runs backwards.
    #[error(
        "{place}: time goes back from {from_s} s to {to_s} s, and so on from row to row; sort the \
         rows by time"
    )]
    TimeBackwards {
        /// The row after the step.
        place: Place,
        /// Time before it, s.
        from_s: f64,
        /// Time after it, s.
        to_s: f64,
    },
    /// A column that is no time.
    #[error(
        "{file}: time jumps {jumps} times in {rows} rows; if another column is the time, name it \
         with --columns time=NAME:UNIT"
    )]
    NoClock {
        file: String,
        /// How often time jumps.
        jumps: usize,
        /// Rows of the file.
        rows: usize,
    },
    /// A sampling time that cannot be.
    #[error(
        "{file}: cannot be sampled every {} s: {}",
        rounded(*period_s),
        impossible_period(*period_s, *duration_s)
    )]
    Period {
        /// The file or the recording.
        file: String,
        /// The sampling time asked for, s.
        period_s: f64,
        /// Length of the recording, s.
        duration_s: f64,
    },
    /// A signal that is needed is not there.
    #[error(
        "{file}: has no signal `{signal}`; it has {signals}. Name its column with --columns \
         {signal}=COLUMN:UNIT"
    )]
    MissingSignal {
        file: String,
        /// The signal needed.
        signal: String,
        /// The signals that are there.
        signals: String,
    },
    /// A signal that is needed has holes.
    #[error(
        "{place}: `{signal}` is missing or not finite there, {samples} samples in {stretches} \
         stretches; cut the recording to a part without holes"
    )]
    NotFinite {
        /// The first hole.
        place: Place,
        /// The signal needed.
        signal: String,
        /// Samples without a value.
        samples: usize,
        /// Stretches that they form.
        stretches: usize,
    },
    /// Signals of different length cannot share a time axis.
    #[error("{name}: `{signal}` has {found} samples, others have {expected}")]
    UnequalLengths {
        name: String,
        signal: String,
        found: usize,
        /// Length of the first signal.
        expected: usize,
    },
    /// A file claims more numbers than are read.
    #[error(
        "{file}: holds more than {most} numbers in all its columns; cut it, keep every tenth row, \
         or keep fewer columns"
    )]
    TooLarge {
        file: String,
        /// Numbers that are read at most.
        most: usize,
    },
    /// Bytes that are not what the format says.
    #[error("{file}: is not a whole {format} file: {what}; copy or export it once more")]
    Damaged {
        file: String,
        /// The format's name.
        format: &'static str,
        /// What is wrong, and where.
        what: String,
    },
    /// A variety of a format that is not read.
    #[error(
        "{file}: is {what}, which is not read; {instead}, or convert it: python \
         tools/convert_recording.py {file} OUT.csv"
    )]
    Variety {
        file: String,
        what: String,
        /// What to do in the program that wrote it.
        instead: &'static str,
    },
    /// No numeric series in a file.
    #[error(
        "{file}: holds no series of numbers, but {found}; export the signals as plain columns \
         beside a time, or convert it: python tools/convert_recording.py {file} OUT.csv"
    )]
    NoSeries {
        file: String,
        /// What is there instead.
        found: String,
    },
}

impl Error {
    /// Whether one row of a stream is at fault, so that the next may be read.
    pub fn is_of_row(&self) -> bool {
        matches!(self, Self::Ragged { .. } | Self::NotANumber { .. } | Self::TimeNotFinite { .. })
    }
}

/// A number without the digits that differences of times leave behind: six of them.
pub(crate) fn digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Why a recording of that length cannot be sampled so.
fn impossible_period(period_s: f64, duration_s: f64) -> String {
    let length = rounded(duration_s);
    if period_s > 0.0 && period_s < duration_s {
        let samples = duration_s / period_s;
        return format!("{length} s would be {samples:.1e} samples, more than memory is given for");
    }
    format!("it must lie between 0 and {length} s")
}
