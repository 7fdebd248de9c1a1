//! Measured or simulated signals: names, units, uniform sampling.
//!
//! A [`Recording`] is what every other part exchanges: the program reads it from a file,
//! the plant's runs and the co-simulation fill one, the diagnoser and the discovery read one.
//!
//! [`read`] takes a file through these steps: its format's reader delivers columns of numbers and
//! their lines; `header` gives every column its canonical name and SI unit, by the user's
//! [`Mapping`]s, by its own name, or by a guess that is reported; `time_axis` sees that sampling
//! is uniform or resamples it; `quality` and [`suspicions`] look for what is wrong without being
//! an error. The [`Report`] says all of that in words and numbers.
//!
//! [`CsvStream`] does the same row by row, for live data; [`write()`] writes a recording so that
//! reading it again gives the same bits.

mod canonical;
mod csv;
mod error;
mod file;
mod header;
mod mapping;
mod mat;
mod parquet;
mod place;
mod quality;
mod quantum;
mod report;
mod signal;
mod suspicion;
mod table;
mod time_axis;
mod unit;

pub use csv::{CsvStream, Row, read_csv};
pub use error::Error;
pub use file::{read, write, write_csv};
pub use header::{ColumnNote, Taken};
pub use mapping::{Mapping, ReadOptions};
pub use place::{Counted, Place};
pub use quality::{Limit, SignalQuality};
pub use quantum::Quantum;
pub use report::{Report, Sampling, Stretch, Stretches};
pub use signal::{Recording, Signal};
pub use suspicion::{Suspicion, suspicions};
pub use unit::{Quantity, Unit};
