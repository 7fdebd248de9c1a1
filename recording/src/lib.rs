//! Measured or simulated signals: names, units, uniform sampling.
//!
//! A [`Recording`] is what every other part exchanges: the program reads it from a file,
//! the plant's runs and the co-simulation fill one, the diagnoser and the discovery read one.
//!
//! [`read`] takes a file through these steps: its format's reader delivers columns of numbers and
//! their lines; `header` gives every column its canonical name and SI unit, by the user's
//! [`Mapping`]s, by its own name, or by a guess that is reported; `time` puts the rows on a uniform
//! grid, in segments where they are parted; `quality` and [`suspicions`] look for what is wrong without being
//! an error. The [`Report`] says all of that in words and numbers.
//!
//! [`CsvStream`] does the same row by row, for live data; [`write()`] writes a recording so that
//! reading it again gives the same bits.
//!
//! ```
//! use drivescope_recording::{ReadOptions, Recording, Signal, read, write};
//!
//! let values = (0..100).map(|k| f64::from(k).sin()).collect();
//! let speed = Signal { name: "omega".into(), unit: "rad/s".into(), values };
//! let recording = Recording::new("run", 0.0, 0.01, vec![speed]);
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("run.csv");
//! write(&file, &recording)?;
//! let (found, report) = read(&file, &ReadOptions::default())?;
//! assert_eq!(found.signals, recording.signals);
//! assert!(report.suspicions.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod budget;
mod canonical;
mod choices;
mod clock;
mod csv;
#[cfg(feature = "containers")]
pub mod dataset;
mod ends;
mod error;
mod file;
mod formats;
mod given;
mod guess;
mod header;
mod kept;
mod look;
mod mapping;
mod memory;
mod place;
mod preview;
mod quality;
mod quantum;
mod replace;
mod report;
mod rounded;
mod signal;
mod stretches;
mod suspicion;
mod table;
mod time;
mod time_unit;
mod words;

pub use drivescope_units::{Quantity, Unit};

pub use budget::MOST_NUMBERS;
pub use choices::{Choice, choices, in_words};
pub use clock::{Break, Clock};
pub use csv::{CsvStream, Row, read_csv};
pub use error::Error;
pub use file::{
    Outcome, is_reading, read, read_with_preview, write, write_csv, write_csv_with_texts,
};
pub use formats::{Format, formats, formats_listed};
pub use header::{ColumnNote, Taken};
pub use mapping::{Mapping, ReadOptions};
pub use memory::of_columns;
pub use place::{Counted, Place};
pub use preview::{ColumnPreview, Preview};
pub use quality::{Limit, SignalQuality, limits};
pub use quantum::Quantum;
pub use replace::{check_writable, write_whole};
pub use report::{Constant, Report, Sampling};
pub use rounded::{rounded, rounded_to};
pub use signal::{NoiseGain, Recording, Signal, TextSignal};
pub use stretches::{Stretch, Stretches};
pub use suspicion::{Suspicion, suspicions};
