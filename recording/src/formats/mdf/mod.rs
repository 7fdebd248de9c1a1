//! MDF of version 4 (ASAM), as measuring and calibration systems of the car industry write it.
//!
//! Channels stand in groups, each with a time channel of its own. Raw values become physical
//! ones by the channel's conversion.

mod blocks;
mod channel;
mod conversion;
mod data;

use std::fs::File;

use super::Format;
use super::rates::{self, Group, Series};
use super::tree::{header, short};
use crate::budget::Budget;
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::table::Table;
use blocks::Blocks;
use channel::{Channel, ChannelGroup};

pub(super) static FORMAT: Format = Format {
    name: "MDF",
    extensions: &["mf4", "mdf"],
    starts: |head| head.starts_with(b"MDF     ") || head.starts_with(b"UnFinMF "),
    read,
    write: None,
};

/// Channel groups of a file.
const MOST_GROUPS: usize = 10_000;

fn read(opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let mut budget = Budget::new(file);
    let mut blocks = Blocks::new(opened, file)?;
    let mut found = Vec::new();
    let mut next = blocks.first()?;
    while next != 0 {
        let block = blocks.block(next, b"##DG")?;
        let (record_id, data) = (block.byte(0), block.link(2));
        let mut groups = channel::groups(&mut blocks, block.link(1))?;
        data::read(&mut blocks, data, record_id, &mut groups, &mut budget)?;
        found.extend(groups);
        budget.take(MOST_GROUPS / 10)?;
        if found.len() > MOST_GROUPS {
            return Err(budget.too_large());
        }
        next = block.link(0);
    }
    into_table(found, file, options, &mut budget)
}

fn into_table(
    found: Vec<ChannelGroup>,
    file: &str,
    options: &ReadOptions,
    budget: &mut Budget,
) -> Result<Table, Error> {
    let mut table = Table::new(Lines::rows(file));
    let paths: Vec<Vec<String>> = found
        .iter()
        .flat_map(|group| group.channels.iter().map(|it| vec![group.name.clone(), it.name.clone()]))
        .collect();
    let mut names = short(&paths.iter().collect::<Vec<_>>(), options).into_iter();
    let mut groups = Vec::new();
    for ChannelGroup { name: group, channels, left_out, .. } in found {
        table.left_out.extend(left_out);
        let (mut time, mut series) = (None, Vec::new());
        for (Channel { name, unit, is_time, values, .. }, short) in
            channels.into_iter().zip(&mut names)
        {
            if is_time && time.is_none() {
                time = Some(Series { header: header("time".to_owned(), Some(&unit)), values });
            } else if values.iter().all(|value| value.is_nan()) && !values.is_empty() {
                table.left_out.push(format!("channel `{name}` of `{group}` has no valid value"));
            } else {
                series.push(Series { header: header(short, Some(&unit)), values });
            }
        }
        match time {
            _ if series.is_empty() => {}
            Some(time) => groups.push(Group { name: group, time, series }),
            None => table.left_out.push(format!("channel group `{group}` has no time channel")),
        }
    }
    groups.retain(|group| !group.time.values.is_empty());
    if groups.is_empty() {
        let found = match table.left_out.len() {
            0 => "no channel with samples".to_owned(),
            _ => table.left_out.join(", "),
        };
        return Err(Error::NoSeries { file: file.to_owned(), found });
    }
    rates::fill(table, groups, options, budget)
}
