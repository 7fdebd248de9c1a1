//! Groups of series, each with a time of its own, made into one table.
//!
//! Measuring systems keep a group for every rate. The table has the time of the longest group
//! that holds a known signal; known signals of other groups are interpolated linearly onto it,
//! which is said, and anything else is left out with a word.

use crate::budget::Budget;
use crate::error::Error;
use crate::header::is_known;
use crate::mapping::{Mapping, ReadOptions};
use crate::table::Table;

/// A series of numbers with its header text.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) header: String,
    pub(super) values: Vec<f64>,
}

/// Series that share a time.
#[derive(Debug)]
pub(super) struct Group {
    /// As the file calls it, for messages.
    pub(super) name: String,
    pub(super) time: Series,
    /// Each as long as the time.
    pub(super) series: Vec<Series>,
}

/// Fills the table's columns, time first.
pub(super) fn fill(
    mut table: Table,
    mut groups: Vec<Group>,
    options: &ReadOptions,
    budget: &mut Budget,
) -> Result<Table, Error> {
    let rank = |it: &Group| (known(it, &options.columns), it.time.values.len());
    // Of equals the first.
    let Some(main) = (0..groups.len()).rev().max_by_key(|k| rank(&groups[*k])) else {
        return Ok(table);
    };
    let main = groups.remove(main);
    let (columns, length) = (&mut table.columns, main.time.values.len());
    for series in std::iter::once(main.time).chain(main.series) {
        table.header.push(series.header);
        columns.push(series.values);
    }
    for Group { name, time, series } in groups {
        let same = time.values == columns[0];
        let joins = time.header == table.header[0] && rises(&time.values) && rises(&columns[0]);
        for Series { header, values } in series {
            if same {
                table.header.push(header);
                columns.push(values);
            } else if joins && is_known(&header, &options.columns) {
                budget.take(length)?;
                columns.push(interpolated(&columns[0], &time.values, &values));
                let found = values.len();
                table.joined.push(format!("`{header}` of `{name}` ({found} samples)"));
                table.header.push(header);
            } else {
                let found = values.len();
                table.left_out.push(format!(
                    "`{header}` of `{name}` has {found} samples at times of its own, others have \
                     {length}"
                ));
            }
        }
    }
    Ok(table)
}

fn known(group: &Group, maps: &[Mapping]) -> bool {
    group.time.values.len() > 1 && group.series.iter().any(|it| is_known(&it.header, maps))
}

fn rises(time: &[f64]) -> bool {
    time.len() > 1 && time.windows(2).all(|pair| pair[0] <= pair[1])
}

/// Values at other times. Before the first and after the last one they hold for a step of their
/// own, since groups start and end a step apart; further out nothing is known.
fn interpolated(at: &[f64], time: &[f64], values: &[f64]) -> Vec<f64> {
    let (first, last) = (time[0], time[time.len() - 1]);
    let step = (last - first) / (time.len() - 1) as f64;
    let mut k = 0;
    let value = |t: &f64| {
        if !(*t >= first - step && *t <= last + step) {
            return f64::NAN;
        }
        while k + 2 < time.len() && time[k + 1] <= *t {
            k += 1;
        }
        let (from, to) = (time[k], time[k + 1]);
        let share = if to > from { ((t - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        match share {
            // Without arithmetic, so that a hole beside the sample does not spoil it.
            0.0 => values[k],
            1.0 => values[k + 1],
            _ => values[k] + share * (values[k + 1] - values[k]),
        }
    };
    at.iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::Lines;

    fn group(name: &str, time: &[f64], series: &[(&str, &[f64])]) -> Group {
        let made = |header: &str, values: &[f64]| Series {
            header: header.to_owned(),
            values: values.to_vec(),
        };
        let series = series.iter().map(|(header, values)| made(header, values)).collect();
        Group { name: name.to_owned(), time: made("time [s]", time), series }
    }

    fn filled(groups: Vec<Group>) -> Table {
        let table = Table::new(Lines::rows("a.mf4"));
        fill(table, groups, &ReadOptions::default(), &mut Budget::new("a.mf4")).unwrap()
    }

    #[test]
    fn the_longest_group_with_known_signals_leads() {
        let ticks: Vec<f64> = (0..9).map(f64::from).collect();
        let table = filled(vec![
            group("noise", &ticks, &[("mic", &ticks)]),
            group("slow", &[1.0, 3.0], &[("temperature", &[20.0, 24.0]), ("mode", &[1.0, 2.0])]),
            group("fast", &[0.0, 1.0, 2.0, 3.0, 4.0, 7.0], &[("u", &[1.0; 6])]),
        ]);
        assert_eq!(table.header, ["time [s]", "u", "temperature"]);
        assert_eq!(table.columns[2][..5], [20.0, 20.0, 22.0, 24.0, 24.0]);
        assert!(table.columns[2][5].is_nan());
        assert_eq!(table.joined, ["`temperature` of `slow` (2 samples)"]);
        assert_eq!(table.left_out.len(), 2);
        assert!(table.left_out[1].contains("`mode` of `slow` has 2 samples"));
    }

    #[test]
    fn equal_times_are_one_group() {
        let table = filled(vec![
            group("a", &[0.0, 1.0], &[("u", &[1.0, 2.0])]),
            group("b", &[0.0, 1.0], &[("x7", &[3.0, 4.0])]),
        ]);
        assert_eq!(table.header, ["time [s]", "u", "x7"]);
        assert!(table.joined.is_empty() && table.left_out.is_empty());
        assert!(filled(Vec::new()).columns.is_empty());
    }
}
