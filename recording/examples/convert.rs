//! Reads recordings of any format and writes each as CSV or Parquet, with an account of what was
//! read beside it.
//!
//! ```text
//! cargo run --release -p drivescope-recording --example convert -- \
//!     [--to csv|parquet] [--columns u=Voltage,omega=Speed:rpm] [--resample S] FOLDER FILE...
//! ```
//!
//! `FOLDER` gets `NAME.csv` (or `NAME.parquet`) and `NAME.json` for every `FILE` of that name. The
//! JSON holds `read_s`, how long reading took, and one of: `report` with `told`, its sentences, and
//! `noise_gain`, what interpolation did to white noise; `error`, why the file was refused; `panic`,
//! a defect of the reader. The exit status is 1 if a file was not converted.

use std::any::Any;
use std::error::Error;
use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use drivescope_recording::{Mapping, ReadOptions, read, write};
use serde_json::{Value, json};

const USAGE: &str =
    "usage: convert [--to csv|parquet] [--columns MAPPING] [--resample S] FOLDER FILE...";

/// What is asked for on the command line.
struct Request {
    extension: String,
    options: ReadOptions,
    folder: PathBuf,
    files: Vec<PathBuf>,
}

fn main() -> ExitCode {
    let request = match Request::parse(std::env::args().skip(1)) {
        Ok(request) => request,
        Err(error) => {
            eprintln!("{error}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    let mut failed = false;
    for file in &request.files {
        if let Err(error) = request.convert(file) {
            eprintln!("{error}");
            failed = true;
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

impl Request {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut extension = "csv".to_owned();
        let mut options = ReadOptions::default();
        let mut paths: Vec<PathBuf> = Vec::new();
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            match argument.as_str() {
                "--to" => extension = value()?,
                "--columns" => options.columns = Mapping::parse_list(&value()?)?,
                "--resample" => options.resample = Some(value()?.parse()?),
                _ => paths.push(argument.into()),
            }
        }
        if paths.len() < 2 {
            return Err("a folder and a file are needed".into());
        }
        let files = paths.split_off(1);
        Ok(Self { extension, options, folder: paths.remove(0), files })
    }

    /// Converts one file and writes the account of it, also where it cannot be read.
    fn convert(&self, file: &Path) -> Result<(), Box<dyn Error>> {
        let name = file.file_name().ok_or(format!("{}: is no file", file.display()))?;
        let beside = |extension: &str| {
            let mut name = name.to_owned();
            name.push(format!(".{extension}"));
            self.folder.join(name)
        };
        let start = Instant::now();
        let outcome = catch_unwind(|| read(file, &self.options));
        let read_s = start.elapsed().as_secs_f64();
        let (mut account, converted) = match outcome {
            Ok(Ok((recording, report))) => {
                write(beside(&self.extension), &recording)?;
                let stated = [report.guesses(), report.warnings()].concat();
                let noise_gain = recording.noise_gain;
                (json!({ "report": report, "told": stated, "noise_gain": noise_gain }), Ok(()))
            }
            Ok(Err(error)) => (json!({ "error": error.to_string() }), Err(error.into())),
            Err(payload) => {
                let said = message(payload.as_ref());
                let error = format!("{}: the reader panicked: {said}", file.display());
                (json!({ "panic": said }), Err(error.into()))
            }
        };
        account["read_s"] = Value::from(read_s);
        fs::write(beside("json"), format!("{account:#}\n"))?;
        converted
    }
}

/// The words of a panic.
fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref().cloned()).unwrap_or_default()
}
