//! Columns as a file gave them, made into a recording: the one way for every format.

use crate::ends;
use crate::error::Error;
use crate::header::{self, Header};
use crate::look::Look;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::quality::{SignalQuality, inspect};
use crate::report::{Constant, Report, Sampling};
use crate::signal::{Recording, SEGMENT, Signal};
use crate::stretches::Stretches;
use crate::suspicion::suspicions;
use crate::time;
use crate::time_unit;

/// What a format's reader delivers.
pub(crate) struct Table {
    /// Header texts, one a column.
    pub(crate) header: Vec<String>,
    /// Values of equal length, one list a column.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Where every row stands.
    pub(crate) lines: Lines,
    /// What the reader has to say of the file, a sentence each.
    pub(crate) notes: Vec<String>,
    /// What the reader could not take, and why.
    pub(crate) left_out: Vec<String>,
    /// Sampling time, s, where the file gives it in place of a time column.
    pub(crate) period_s: Option<f64>,
    /// Numbers that stand beside the signals.
    pub(crate) constants: Vec<Constant>,
    /// Columns that were interpolated onto the time of the others, and from where.
    pub(crate) joined: Vec<String>,
}

impl Table {
    /// A table without columns.
    pub(crate) fn new(lines: Lines) -> Table {
        Table {
            header: Vec::new(),
            columns: Vec::new(),
            lines,
            notes: Vec::new(),
            left_out: Vec::new(),
            period_s: None,
            constants: Vec::new(),
            joined: Vec::new(),
        }
    }

    /// Names, converts, checks and reports; values are converted where they lie.
    pub(crate) fn into_recording(
        self,
        options: &ReadOptions,
    ) -> Result<(Recording, Report), Error> {
        let Table { header, mut columns, lines, constants, joined, mut period_s, .. } = self;
        let (mut notes, mut left_out) = (self.notes, self.left_out);
        let file = lines.file().to_owned();
        let looks: Vec<Look> = columns.iter().map(|values| Look::at(values)).collect();
        let mut resolved = header::resolve(&file, &header, options, &looks)?;
        notes.append(&mut resolved.notes);
        left_out.append(&mut resolved.left_out.said);
        for position in resolved.left_out.columns.iter().rev() {
            columns.remove(*position);
        }
        let samples = columns.first().map_or(0, Vec::len);
        if let Some(every_s) = options.rows_every {
            if !(every_s.is_finite() && every_s > 0.0) {
                let duration_s = samples as f64 * every_s;
                return Err(Error::Period { file, period_s: every_s, duration_s });
            }
            period_s = Some(every_s);
            // A time that is not to be believed is no signal either.
            if let Some(position) = resolved.time.take() {
                columns.remove(position);
                let remaining = resolved.columns.remove(position).note.column;
                notes.push(format!("column `{remaining}` is not used: rows lie {every_s} s apart"));
            }
        }
        let time = match (resolved.time, period_s) {
            (Some(position), _) => {
                enough(&file, samples)?;
                let mut time = columns.remove(position);
                if !options.of_model {
                    notes.extend(time_unit::settle(&mut resolved.columns[position], &mut time));
                }
                resolved.columns[position].convert_all(&mut time);
                Some(time)
            }
            (None, Some(_)) => {
                enough(&file, samples)?;
                None
            }
            (None, None) => {
                enough(&file, samples)?;
                return Err(header::missing_time(&file, &header));
            }
        };
        if columns.is_empty() {
            return Err(Error::NoSignals { file });
        }
        let mut signals = named(&resolved, columns);
        let (rows, mut said) = ends::cut(&mut signals, &lines);
        left_out.append(&mut said);
        let lines = lines.from(rows.start);
        let looks = |it: &Signal| inspect(&it.name, &it.unit, &it.values, &lines);
        let qualities = signals.iter().map(looks).collect();
        let Some(mut time) = time else {
            let period_s = period_s.unwrap_or_default();
            let start_s = rows.start as f64 * period_s;
            let mut recording = Recording::new(file.clone(), start_s, period_s, signals);
            let mut sampling = Sampling::plain(start_s, period_s);
            if let Some(asked_s) = options.resample {
                recording = recording.resample(asked_s)?;
                sampling =
                    Sampling { period_s: asked_s, resampled_from_s: Some(period_s), ..sampling };
            }
            let mut report = Report {
                notes,
                constants,
                joined,
                ..Report::of(&recording, &lines, sampling, resolved, left_out, qualities)
            };
            report.suspicions.iter_mut().for_each(|it| it.suggest_rows(period_s));
            return Ok((recording, report));
        };
        time.truncate(rows.end);
        time.drain(..rows.start);
        let run = signals.iter().position(|it| it.name == SEGMENT);
        let run = run.map(|position| signals.remove(position).values);
        let arranged = {
            let columns: Vec<&[f64]> = signals.iter().map(|it| it.values.as_slice()).collect();
            let witnesses = time::Witnesses::among(&signals);
            time::arrange(time, &columns, &witnesses, run.as_deref(), options.resample, &lines)?
        };
        for signal in &mut signals {
            let held = signal.is_held();
            signal.values = arranged.apply(std::mem::take(&mut signal.values), held);
        }
        let Sampling { start_s, period_s, .. } = arranged.sampling;
        let recording = Recording {
            breaks: arranged.breaks(),
            noise_gain: arranged.noise_gain,
            ..Recording::new(file, start_s, period_s, signals)
        };
        let report = Report {
            gaps: arranged.gaps,
            repeated: arranged.repeated,
            unstamped: arranged.unstamped,
            notes,
            constants,
            joined,
            ..Report::of(&recording, &lines, arranged.sampling, resolved, left_out, qualities)
        };
        Ok((recording, report))
    }
}

impl Report {
    fn of(
        recording: &Recording,
        lines: &Lines,
        sampling: Sampling,
        header: Header,
        left_out: Vec<String>,
        signals: Vec<SignalQuality>,
    ) -> Report {
        Report {
            file: recording.name.clone(),
            counted: lines.counted(),
            samples: recording.len(),
            end_s: recording.time(recording.len().saturating_sub(1)),
            sampling,
            columns: header.columns.into_iter().map(|column| column.note).collect(),
            notes: Vec::new(),
            left_out,
            constants: Vec::new(),
            joined: Vec::new(),
            gaps: Stretches::default(),
            repeated: Stretches::default(),
            unstamped: Stretches::default(),
            signals,
            suspicions: suspicions(recording),
        }
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
