//! Columns as a file gave them, made into a recording: the one way for every format.

use crate::error::Error;
use crate::header::{self, Header};
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::quality::inspect;
use crate::report::{Report, Sampling, Stretches};
use crate::signal::{Recording, Signal};
use crate::suspicion::suspicions;
use crate::time_axis;

/// What a format's reader delivers.
pub(crate) struct Table {
    /// Header texts, one a column.
    pub(crate) header: Vec<String>,
    /// Values of equal length, one list a column.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Where every row stands.
    pub(crate) lines: Lines,
    /// What the reader could not take, and why.
    pub(crate) left_out: Vec<String>,
    /// Sampling time, s, where the file gives it in place of a time column.
    pub(crate) period_s: Option<f64>,
}

impl Table {
    /// Names, converts, checks and reports; values are converted where they lie.
    pub(crate) fn into_recording(
        self,
        options: &ReadOptions,
    ) -> Result<(Recording, Report), Error> {
        let Table { header, mut columns, lines, left_out, period_s } = self;
        let file = lines.file().to_owned();
        let resolved = header::resolve(&file, &header, &options.columns)?;
        let samples = columns.first().map_or(0, Vec::len);
        let time = match (resolved.time, period_s) {
            (Some(position), _) => {
                enough(&file, samples)?;
                let mut time = columns.remove(position);
                resolved.columns[position].convert_all(&mut time);
                Some(time)
            }
            (None, Some(_)) => {
                enough(&file, samples)?;
                None
            }
            (None, None) => return Err(header::missing_time(&file, &header)),
        };
        if columns.is_empty() {
            return Err(Error::NoSignals { file });
        }
        let mut signals = named(&resolved, columns);
        let looks = |it: &Signal| inspect(&it.name, &it.unit, &it.values, &lines);
        let qualities = signals.iter().map(looks).collect();
        let (mut gaps, mut repeated) = (Stretches::default(), Stretches::default());
        let sampling = match (&time, options.resample) {
            (Some(time), Some(period_s)) => {
                let repairs = time_axis::mendable(time, &lines)?;
                let samples = time_axis::samples(&file, time, period_s)?;
                for signal in &mut signals {
                    signal.values = time_axis::interpolate(time, &signal.values, period_s, samples);
                }
                (gaps, repeated) = (repairs.gaps, repairs.repeated);
                let resampled_from_s = Some(repairs.median_s);
                Sampling { start_s: time[0], period_s, jitter: 0.0, resampled_from_s }
            }
            (Some(time), None) => time_axis::uniform(time, &lines)?,
            (None, _) => {
                let period_s = period_s.unwrap_or_default();
                Sampling { start_s: 0.0, period_s, jitter: 0.0, resampled_from_s: None }
            }
        };
        drop(time);
        let Sampling { start_s, period_s, .. } = sampling;
        let mut recording = Recording { name: file.clone(), start_s, period_s, signals };
        let mut sampling = sampling;
        if let (None, Some(period_s)) = (resolved.time, options.resample) {
            sampling.resampled_from_s = Some(recording.period_s);
            sampling.period_s = period_s;
            recording = recording.resample(period_s)?;
        }
        let report = Report {
            file,
            counted: lines.counted(),
            samples: recording.len(),
            sampling,
            columns: resolved.columns.into_iter().map(|column| column.note).collect(),
            left_out,
            gaps,
            repeated,
            signals: qualities,
            suspicions: suspicions(&recording),
        };
        Ok((recording, report))
    }
}

fn enough(file: &str, samples: usize) -> Result<(), Error> {
    match samples {
        0 => Err(Error::HeaderOnly { file: file.to_owned() }),
        1 => Err(Error::OneRow { file: file.to_owned() }),
        _ => Ok(()),
    }
}

fn named(header: &Header, columns: Vec<Vec<f64>>) -> Vec<Signal> {
    let signals = header.columns.iter().enumerate().filter(|(k, _)| Some(*k) != header.time);
    let pairs = signals.zip(columns);
    pairs
        .map(|((_, column), mut values)| {
            column.convert_all(&mut values);
            let (name, unit) = (column.note.signal.clone(), column.note.unit.clone());
            Signal { name, unit, values }
        })
        .collect()
}
