//! Variables in structs and groups, made into one table.
//!
//! MAT and HDF5 files hold variables under paths (`s.u`, `daq/u`). Every vector is a column; a
//! matrix gives the columns `name_1`, `name_2`, ... along its longer side. A series belongs to
//! the time of its length that stands nearest to it. Without a time, a scalar `Ts`, `dt` or `fs`
//! gives the sampling time; any other scalar is a constant.

use super::rates::{self, Group, Series};
use crate::budget::Budget;
use crate::error::Error;
use crate::header::is_time;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::report::Constant;
use crate::table::Table;

/// What only MATLAB itself reads, and what to do there.
pub(super) const OBJECT: &str = "MATLAB object (of a timeseries x save x.Time and squeeze(x.Data), of a Dataset those of its elements)";
/// A matrix with more columns than this is a picture or a map, not signals.
const MOST_COLUMNS: usize = 100;
/// Last parts of a path that say nothing; the part before them is the name.
const EMPTY_WORDS: [&str; 5] = ["values", "value", "data", "samples", "signal"];

/// Names from the outermost to the variable's own.
pub(super) type KeyPath = Vec<String>;

/// A real matrix, column after column.
#[derive(Debug)]
pub(super) struct Matrix {
    pub(super) path: KeyPath,
    pub(super) unit: Option<String>,
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) values: Vec<f64>,
}

/// What a file holds.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) matrices: Vec<Matrix>,
    pub(super) texts: Vec<(KeyPath, String)>,
    /// Variables that are no real numbers, by what they are.
    pub(super) others: Vec<(KeyPath, &'static str)>,
}

/// A vector of the file.
struct Branch {
    path: KeyPath,
    unit: Option<String>,
    values: Vec<f64>,
}

impl Tree {
    /// Adds a single number.
    pub(super) fn number(&mut self, path: KeyPath, value: f64) {
        let values = vec![value];
        self.matrices.push(Matrix { path, unit: None, rows: 1, columns: 1, values });
    }

    /// The table of the series, and what stands beside them.
    pub(super) fn into_table(
        mut self,
        file: &str,
        options: &ReadOptions,
        budget: &mut Budget,
    ) -> Result<Table, Error> {
        self.take_labels();
        let mut table = Table::new(Lines::rows(file));
        let texts = self.texts.into_iter().map(|(path, _)| (path, "text"));
        // Texts inside a struct describe it; only one beside the signals might have been a signal.
        let texts = texts.filter(|(path, _)| path.len() == 1);
        for (path, kind) in self.others.into_iter().chain(texts) {
            table.left_out.push(format!("variable `{}` is a {kind}", path.join(".")));
        }
        let (mut branches, mut scalars) = (Vec::new(), Vec::new());
        for matrix in self.matrices {
            let Matrix { rows, columns, .. } = matrix;
            match (rows, columns) {
                (0, _) | (_, 0) => {}
                (1, 1) => scalars.push((matrix.path, matrix.values[0])),
                _ if rows.min(columns) > MOST_COLUMNS => {
                    let name = matrix.path.join(".");
                    table
                        .left_out
                        .push(format!("variable `{name}` is a {rows} x {columns} matrix"));
                }
                _ => branches.extend(columns_of(matrix)),
            }
        }
        if branches.is_empty() {
            let found = match table.left_out.len() {
                0 => "single numbers".to_owned(),
                _ => table.left_out.join(", "),
            };
            return Err(Error::NoSeries { file: file.to_owned(), found });
        }
        let sampling = |(path, value): &(KeyPath, f64)| sampling_time(path.last()?, *value);
        let period_s = scalars.iter().find_map(sampling);
        scalars.retain(|it| sampling(it).is_none());
        let names = short(&scalars.iter().map(|(path, _)| path).collect::<Vec<_>>(), options);
        let constants = names.into_iter().zip(&scalars);
        table.constants =
            constants.map(|(name, (_, value))| Constant { name, value: *value }).collect();
        let headers = headers(&branches, options);
        let times: Vec<bool> = headers.iter().map(|it| is_time(it, &options.columns)).collect();
        if times.contains(&true) {
            let groups = grouped(branches, headers, &times, &mut table.left_out);
            rates::fill(table, groups, options, budget)
        } else {
            let length = branches.iter().map(|it| it.values.len()).max().unwrap_or(0);
            for (Branch { path, values, .. }, header) in branches.into_iter().zip(headers) {
                if values.len() == length {
                    table.header.push(header);
                    table.columns.push(values);
                } else {
                    table.left_out.push(of_another_length(&path, values.len(), length));
                }
            }
            table.period_s = period_s;
            Ok(table)
        }
    }

    /// Simulink writes the values of a signal beside its name: `out.signals(2).values` and
    /// `out.signals(2).label` are the signal `out.omega`.
    fn take_labels(&mut self) {
        for matrix in &mut self.matrices {
            let [above @ .., holder, last] = &matrix.path[..] else { continue };
            if last != "values" || !holder.starts_with("signals") {
                continue;
            }
            let label = self.texts.iter().find(|(path, text)| {
                matches!(&path[..], [same @ .., its, word]
                    if same == above && its == holder && word == "label" && !text.is_empty())
            });
            if let Some((_, label)) = label {
                matrix.path = above.iter().chain([label]).cloned().collect();
            }
        }
    }
}

/// Every series in the group of its time.
fn grouped(
    branches: Vec<Branch>,
    headers: Vec<String>,
    times: &[bool],
    left_out: &mut Vec<String>,
) -> Vec<Group> {
    let with_time = |k: &usize| times[*k];
    let (of_time, of_series): (Vec<usize>, Vec<usize>) = (0..branches.len()).partition(with_time);
    let nearest = |k: usize| {
        let fits = |t: &&usize| branches[**t].values.len() == branches[k].values.len();
        let shared = |t: usize| {
            let pairs = branches[t].path.iter().zip(&branches[k].path);
            pairs.take_while(|(a, b)| a == b).count()
        };
        // Of equally near ones the first.
        of_time.iter().filter(fits).rev().max_by_key(|t| shared(**t)).copied()
    };
    let chosen: Vec<(usize, Option<usize>)> = of_series.iter().map(|k| (*k, nearest(*k))).collect();
    let length = of_time.iter().map(|t| branches[*t].values.len()).max().unwrap_or(0);
    let mut series: Vec<Option<(Branch, String)>> =
        branches.into_iter().zip(headers).map(Some).collect();
    let mut groups = Vec::new();
    for t in of_time {
        let Some((Branch { path, values, .. }, header)) = series[t].take() else { continue };
        let name = path.join(".");
        let own = chosen.iter().filter(|(_, time)| *time == Some(t));
        let own = own.filter_map(|(k, _)| series[*k].take());
        let own: Vec<Series> =
            own.map(|(branch, header)| Series { header, values: branch.values }).collect();
        if own.is_empty() {
            left_out.push(format!("variable `{name}` is a time that no other one has"));
        } else {
            groups.push(Group { name, time: Series { header, values }, series: own });
        }
    }
    let rest = series.into_iter().flatten();
    left_out.extend(rest.map(|(it, _)| of_another_length(&it.path, it.values.len(), length)));
    groups
}

fn of_another_length(path: &KeyPath, found: usize, length: usize) -> String {
    format!("variable `{}` has {found} values, others have {length}", path.join("."))
}

/// The sampling time, s, that a scalar of that name gives.
fn sampling_time(name: &str, value: f64) -> Option<f64> {
    let value = Some(value).filter(|value| value.is_finite() && *value > 0.0)?;
    match name {
        "Ts" | "T_s" | "ts" | "dt" | "Ta" => Some(value),
        "fs" | "Fs" | "f_s" => Some(1.0 / value),
        _ => None,
    }
}

/// Series along the longer side.
fn columns_of(matrix: Matrix) -> Vec<Branch> {
    let Matrix { path, unit, rows, columns, values } = matrix;
    if rows.min(columns) == 1 {
        return vec![Branch { path, unit, values }];
    }
    let made = |k: usize, values: Vec<f64>| {
        let mut path = path.clone();
        if let Some(last) = path.last_mut() {
            *last = format!("{last}_{}", k + 1);
        }
        Branch { path, unit: unit.clone(), values }
    };
    if rows >= columns {
        values.chunks(rows).enumerate().map(|(k, part)| made(k, part.to_vec())).collect()
    } else {
        let row = |k: usize| values.iter().skip(k).step_by(rows).copied().collect();
        (0..rows).map(|k| made(k, row(k))).collect()
    }
}

fn headers(branches: &[Branch], options: &ReadOptions) -> Vec<String> {
    let names = short(&branches.iter().map(|it| &it.path).collect::<Vec<_>>(), options);
    let units = branches.iter().map(|it| it.unit.as_deref());
    names.into_iter().zip(units).map(|(name, unit)| header(name, unit)).collect()
}

/// `name [unit]`, or the name alone.
pub(super) fn header(name: String, unit: Option<&str>) -> String {
    match unit.map(str::trim).filter(|unit| !unit.is_empty()) {
        Some(unit) => format!("{name} [{unit}]"),
        None => name,
    }
}

/// The last part of each path where it is no other's, else all parts: `u` for `daq.u`. The time
/// of a group is just its time, because only one of them stays.
pub(super) fn short(paths: &[&KeyPath], options: &ReadOptions) -> Vec<String> {
    let last = |path: &KeyPath| match &path[..] {
        [.., above, word] if EMPTY_WORDS.contains(&word.as_str()) => above.clone(),
        [.., last] => last.clone(),
        [] => String::new(),
    };
    let words: Vec<String> = paths.iter().map(|path| last(path)).collect();
    let name = |(path, word): (&&KeyPath, &String)| {
        let full = path.join(".");
        let asked = options.columns.iter().any(|it| it.foreign == full);
        let alone = words.iter().filter(|other| *other == word).count() == 1;
        if !asked && (alone || is_time(word, &options.columns)) { word.clone() } else { full }
    };
    paths.iter().zip(&words).map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::Mapping;

    fn table(variables: &[(&str, &[f64])], maps: &str) -> Result<Table, Error> {
        let matrix = |(path, values): &(&str, &[f64])| Matrix {
            path: path.split('.').map(str::to_owned).collect(),
            unit: None,
            rows: values.len(),
            columns: 1,
            values: values.to_vec(),
        };
        let tree = Tree { matrices: variables.iter().map(matrix).collect(), ..Tree::default() };
        let options =
            ReadOptions { columns: Mapping::parse_list(maps).unwrap(), ..ReadOptions::default() };
        tree.into_table("a.mat", &options, &mut Budget::new("a.mat"))
    }

    #[test]
    fn a_series_has_the_time_that_stands_nearest() {
        let (three, late) = ([0.0, 1.0, 2.0], [5.0, 6.0, 7.0]);
        let read = table(
            &[
                ("a.time", &three),
                ("b.time", &late),
                ("a.u", &[1.0; 3]),
                ("b.temp", &[2.0; 3]),
                ("a.speed.values", &[3.0; 3]),
                ("J", &[0.5]),
                ("b.J", &[0.25]),
                ("K", &[2.0]),
            ],
            "",
        )
        .unwrap();
        assert_eq!(read.header[..3], ["time", "u", "speed"]);
        assert_eq!(read.columns[0], three);
        let named: Vec<_> = read.constants.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(named, ["J", "b.J", "K"]);
    }

    #[test]
    fn full_names_where_the_short_one_is_doubtful_or_asked_for() {
        let both: [(&str, &[f64]); 3] =
            [("t", &[0.0, 1.0]), ("a.u", &[1.0; 2]), ("b.u", &[1.0; 2])];
        assert_eq!(table(&both, "").unwrap().header, ["t", "a.u", "b.u"]);
        assert_eq!(table(&both[..2], "").unwrap().header, ["t", "u"]);
        assert_eq!(table(&both[..2], "u=a.u").unwrap().header, ["t", "a.u"]);
    }

    #[test]
    fn a_scalar_gives_the_sampling_time_or_is_a_constant() {
        let read = table(&[("u", &[1.0, 2.0]), ("fs", &[200.0]), ("R", &[3.0])], "").unwrap();
        assert_eq!((read.period_s, read.constants.len()), (Some(0.005), 1));
        assert!(matches!(table(&[("R", &[3.0])], ""), Err(Error::NoSeries { .. })));
    }
}
