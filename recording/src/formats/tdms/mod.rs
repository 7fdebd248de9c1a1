//! TDMS, as LabVIEW writes it: groups of channels, each a waveform or beside a time channel.
//!
//! A waveform gives its own sampling time (`wf_increment`) and the time of its first sample
//! (`wf_start_offset`). Numbers that the file or a group has as properties are constants.

mod fields;
mod object;
mod scales;
mod segments;
mod values;

use std::fs::File;

use super::Format;
use super::rates::{self, Group, Series};
use super::tree::{header, short};
use crate::budget::Budget;
use crate::error::Error;
use crate::header::is_time;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::report::Constant;
use crate::table::Table;
use object::{Object, Property};
use segments::Segments;

pub(super) static FORMAT: Format = Format {
    name: "TDMS",
    extensions: &["tdms"],
    starts: |head| head.starts_with(segments::MARK),
    read,
    write: None,
};

fn read(opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let mut budget = Budget::new(file);
    let objects = Segments::new(opened, file)?.read(&mut budget)?;
    let mut table = Table::new(Lines::rows(file));
    table.constants = constants(&objects, options);
    let mut channels = channels(objects, &mut table.left_out, options);
    if channels.is_empty() {
        let found = match table.left_out.len() {
            0 => "no channel".to_owned(),
            _ => table.left_out.join(", "),
        };
        return Err(Error::NoSeries { file: file.to_owned(), found });
    }
    let mut groups = Vec::new();
    while let Some(first) = channels.first() {
        let clock = first.clock();
        let (own, rest): (Vec<_>, Vec<_>) =
            channels.into_iter().partition(|it| it.clock() == clock);
        channels = rest;
        let length = own[0].values.len();
        let name = own[0].group.clone();
        let mut series: Vec<Series> =
            own.into_iter().map(|it| Series { header: it.header, values: it.values }).collect();
        let time = match (
            clock.waveform,
            series.iter().position(|it| is_time(&it.header, &options.columns)),
        ) {
            (Some((start_s, period_s)), None) => {
                budget.take(length)?;
                let values = (0..length).map(|k| start_s + k as f64 * period_s).collect();
                Series { header: "time [s]".to_owned(), values }
            }
            (_, Some(time)) => series.remove(time),
            (None, None) => {
                // Without any time the columns are shown, so that one can be named as the time.
                let named = series.into_iter().map(|it| it.header).collect::<Vec<_>>().join("`, `");
                table.left_out.push(format!("`{named}` of group `{name}` without a time"));
                continue;
            }
        };
        groups.push(Group { name, time, series });
    }
    if groups.is_empty() {
        let found = table.left_out.join(", ");
        return Err(Error::NoSeries { file: file.to_owned(), found });
    }
    rates::fill(table, groups, options, &mut budget)
}

/// A channel of numbers.
struct Channel {
    group: String,
    header: String,
    /// Time of the first sample and sampling time, s.
    waveform: Option<(f64, f64)>,
    values: Vec<f64>,
}

/// What channels share that are sampled together.
#[derive(PartialEq)]
struct Clock {
    /// Channels of a waveform may stand in several groups.
    group: Option<String>,
    waveform: Option<(f64, f64)>,
    samples: usize,
}

impl Channel {
    fn clock(&self) -> Clock {
        let group = self.waveform.is_none().then(|| self.group.clone());
        Clock { group, waveform: self.waveform, samples: self.values.len() }
    }
}

fn channels(
    objects: Vec<Object>,
    left_out: &mut Vec<String>,
    options: &ReadOptions,
) -> Vec<Channel> {
    let channels: Vec<Object> = objects.into_iter().filter(|it| it.path.len() == 2).collect();
    let names = short(&channels.iter().map(|it| &it.path).collect::<Vec<_>>(), options);
    let mut read = Vec::new();
    for (mut channel, name) in channels.into_iter().zip(names) {
        let full = channel.path.join(".");
        if let Some(why) = channel.no_numbers() {
            left_out.push(format!("channel `{full}` holds {why}"));
            continue;
        }
        if channel.values.is_empty() {
            continue;
        }
        if !scales::scale(&mut channel) {
            left_out.push(format!("channel `{full}` is scaled in a way that is not read"));
            continue;
        }
        let number = |name: &str| match channel.property(name) {
            Some(Property::Number(value)) if value.is_finite() => Some(*value),
            _ => None,
        };
        let period_s = number("wf_increment").filter(|it| *it > 0.0);
        let waveform = period_s.map(|it| (number("wf_start_offset").unwrap_or(0.0), it));
        let unit = match channel.property("unit_string") {
            Some(Property::Text(unit)) => Some(unit.as_str()),
            _ => channel.in_seconds().then_some("s"),
        };
        let (header, group) = (header(name, unit), channel.path[0].clone());
        read.push(Channel { group, header, waveform, values: channel.values });
    }
    read
}

/// Numbers among the properties of the file and its groups.
fn constants(objects: &[Object], options: &ReadOptions) -> Vec<Constant> {
    let of = objects.iter().filter(|it| it.path.len() < 2).flat_map(|it| {
        it.properties.iter().filter_map(|(name, value)| match value {
            Property::Number(value) => {
                Some((it.path.iter().cloned().chain([name.clone()]).collect(), *value))
            }
            _ => None,
        })
    });
    let found: Vec<(Vec<String>, f64)> = of.collect();
    let names = short(&found.iter().map(|(path, _)| path).collect::<Vec<_>>(), options);
    let pairs = names.into_iter().zip(&found);
    pairs.map(|(name, (_, value))| Constant { name, value: *value }).collect()
}
