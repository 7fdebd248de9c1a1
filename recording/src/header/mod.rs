//! From column headers to signals: names, units, guesses.

mod capital_t;
mod column;
mod motion;
mod which;

pub(crate) use column::Column;
pub use column::{ColumnNote, Taken};
pub(crate) use which::{is_known, is_signal, is_time, missing_time};

use capital_t::capital_t;
use column::place;
use motion::rotary;
use which::{find, listed};

use crate::canonical::{self, Canonical};
use crate::counts::is_counts;
use crate::error::Error;
use crate::given::Given;
use crate::guess;
use crate::look::Look;
use crate::mapping::Mapping;
use crate::unit::{Quantity, Unit};

/// The columns of a table, and which of them is the time.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) columns: Vec<Column>,
    /// Position of the time column; none only where a file gives a sampling time instead.
    pub(crate) time: Option<usize>,
    /// What could not be told, a sentence each.
    pub(crate) notes: Vec<String>,
}

/// Gives every column its name and unit. `looks` says what the values of the columns show, where
/// they are known already.
pub(crate) fn resolve(
    file: &str,
    texts: &[String],
    maps: &[Mapping],
    looks: &[Look],
) -> Result<Header, Error> {
    let given: Vec<Given> = texts.iter().map(|text| Given::of(text)).collect();
    let mut columns: Vec<Option<Column>> = vec![None; given.len()];
    for map in maps {
        let position = find(&given, &map.foreign).ok_or_else(|| Error::MappedColumn {
            file: file.to_owned(),
            column: map.foreign.clone(),
            signal: map.canonical.clone(),
            columns: listed(&given),
        })?;
        let unit = map.unit.as_ref().or(given[position].unit.as_ref());
        let known = canonical::exact(&map.canonical);
        let column = place(file, &given[position], &map.canonical, known, unit, Taken::Mapped)?;
        columns[position] = Some(column);
    }
    for (second, column) in given.iter().enumerate().filter(|(k, _)| columns[*k].is_none()) {
        let same = |(k, other): (usize, &Given)| columns[k].is_none() && other.name == column.name;
        if let Some(first) = given[..second].iter().enumerate().position(same) {
            let name = column.name.clone();
            let (first, second) = (first + 1, second + 1);
            return Err(Error::DuplicateColumn { file: file.to_owned(), name, first, second });
        }
    }
    let mut notes = Vec::new();
    let mut used: Vec<&str> = maps.iter().map(|map| map.canonical.as_str()).collect();
    // Exact names first, so that no guess takes a name that a later column carries itself.
    for (k, column) in given.iter().enumerate() {
        let unit = column.unit.as_deref();
        let Some(known) = canonical::exact(&column.name).filter(|_| columns[k].is_none()) else {
            continue;
        };
        if column.name == "T" && unit.is_none() {
            let (capital, note) = capital_t(file, &given, k, looks.get(k), &used)?;
            // Whatever it is, another column must not get its name.
            used.push(if capital.note.signal == "temperature" { "temperature" } else { "T" });
            columns[k] = Some(capital);
            notes.extend(note);
        } else if unit.is_some_and(is_counts) {
            let name = format!("{}_counts", known.name);
            columns[k] = Some(place(file, column, &name, None, column.unit.as_ref(), Taken::Kept)?);
            notes.push(uncounted(column, known.name));
        } else if unit.is_some_and(|unit| is_share(unit) && !known.accepts(unit)) {
            let (name, share) = (format!("{}_share", known.name), unit.unwrap_or_default());
            columns[k] = Some(place(file, column, &name, None, column.unit.as_ref(), Taken::Kept)?);
            notes.push(format!(
                "column `{}` [{share}] is kept as `{name}`: a share is no {1}; say its unit with \
                 --columns {1}={0}:UNIT where it has one",
                column.name, known.name
            ));
        } else if unit.is_none_or(|unit| known.accepts(unit))
            || guess::guess(&column.name, unit, None).is_none()
        {
            let unit = column.unit.as_ref();
            columns[k] = Some(place(file, column, known.name, Some(known), unit, Taken::Named)?);
            used.push(known.name);
        }
    }
    let rotary = rotary(&given);
    // Of several columns for one signal one that moves wins, then the one nearest to a measurement.
    let mut guesses: Vec<(bool, guess::Rank, usize, &Canonical)> = Vec::new();
    for (k, column) in given.iter().enumerate().filter(|(k, _)| columns[*k].is_none()) {
        let constant = looks.get(k).is_some_and(|look| look.constant);
        if let Some(guess) = guess::guess(&column.name, column.unit.as_deref(), rotary) {
            guesses.push((constant, guess.rank, k, guess.canonical));
        } else if column.unit.as_deref().is_some_and(is_counts)
            && let Some(guess) = guess::guess(&column.name, None, rotary)
        {
            notes.push(uncounted(column, guess.canonical.name));
        }
    }
    guesses.sort_by_key(|(constant, rank, k, _)| (*constant, *rank, *k));
    for (_, _, k, known) in guesses {
        if used.contains(&known.name) {
            continue;
        }
        used.push(known.name);
        let column = &given[k];
        let own = guess::unit_in_name(&column.name).filter(|unit| known.accepts(unit));
        let unit = column.unit.clone().or(own.map(str::to_owned));
        columns[k] =
            Some(place(file, column, known.name, Some(known), unit.as_ref(), Taken::Guessed)?);
    }
    // What nothing else says is the time: the first column that runs like a clock.
    let clock = |k: usize| columns[k].is_none() && looks.get(k).is_some_and(|look| look.like_clock);
    if !used.contains(&"time")
        && let Some(k) =
            (0..given.len()).find(|k| clock(*k)).filter(|k| *k == 0 || nameless(&given))
    {
        let (known, unit) = (canonical::exact("time"), given[k].unit.as_ref());
        let unit = unit.filter(|unit| known.is_some_and(|known| known.accepts(unit)));
        columns[k] = Some(place(file, &given[k], "time", known, unit, Taken::Guessed)?);
        notes.push(format!("column `{}` runs like a clock: taken as the time", given[k].name));
    }
    for (slot, column) in columns.iter_mut().zip(&given).filter(|(slot, _)| slot.is_none()) {
        let unit = column.unit.as_ref();
        *slot = Some(place(file, column, &column.name, None, unit, Taken::Kept)?);
    }
    let columns: Vec<Column> = columns.into_iter().flatten().collect();
    no_name_twice(file, &columns)?;
    let time = columns.iter().position(|column| column.note.signal == "time");
    Ok(Header { columns, time, notes })
}

/// Whether a unit is a share of something rated, as drives give torques in.
fn is_share(unit: &str) -> bool {
    Unit::parse(unit).is_some_and(|unit| unit.quantity == Quantity::Dimensionless)
}

/// What to say of a column of counts.
fn uncounted(column: &Given, signal: &str) -> String {
    let name = &column.name;
    let unit = if matches!(signal, "x" | "x_load") { "counts*0.05um" } else { "counts/4096" };
    format!(
        "column `{name}` is kept in counts: say how many make a revolution (or how long one is) \
         with --columns {signal}={name}:{unit}"
    )
}

/// Whether the columns have numbers for names, because the file has none.
fn nameless(given: &[Given]) -> bool {
    given.iter().all(|column| column.name.starts_with(NAMELESS))
}

/// What a column without a name is called, with its number.
pub(crate) const NAMELESS: &str = "column ";

fn no_name_twice(file: &str, columns: &[Column]) -> Result<(), Error> {
    for (k, column) in columns.iter().enumerate() {
        let name = &column.note.signal;
        if let Some(other) = columns[..k].iter().find(|other| other.note.signal == *name) {
            return Err(Error::DuplicateSignal {
                file: file.to_owned(),
                name: name.clone(),
                first: other.note.column.clone(),
                second: column.note.column.clone(),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(texts: &[&str], maps: &str) -> Result<Header, Error> {
        let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
        resolve("a.csv", &texts, &Mapping::parse_list(maps).unwrap(), &[])
    }

    /// `column -> signal [unit]` of every column.
    fn told(texts: &[&str], maps: &str) -> Vec<String> {
        let told = |it: &Column| format!("{} [{}]", it.note.signal, it.note.unit);
        header(texts, maps).unwrap().columns.iter().map(told).collect()
    }

    #[test]
    fn four_header_forms_and_the_bare_name() {
        let texts = ["time [ms]", "u (mV)", "omega/rpm", "pos_mm", "i"];
        let read = header(&texts, "").unwrap();
        assert_eq!(told(&texts, ""), ["time [s]", "u [V]", "omega [rad/s]", "x [m]", "i [A]"]);
        assert_eq!(read.time, Some(0));
        assert_eq!(read.columns[0].convert(1.0), 0.001);
        assert_eq!(read.columns[3].note.taken, Taken::Guessed);
        assert_eq!(read.columns[4].convert(2.5), 2.5);
    }

    #[test]
    fn sensors_and_inputs_keep_what_they_are_in() {
        assert_eq!(told(&["time", "T [rpm]"], "")[1], "T [rpm]");
        assert_eq!(told(&["time", "C_m", "T", "I_m"], "")[2], "T [rpm]");
        assert_eq!(told(&["time", "T [degC]"], "")[1], "temperature [K]");
        for (unit, si) in [("mA", "A"), ("kN", "N"), ("mN m", "N m"), ("V", "V")] {
            assert_eq!(told(&["time", &format!("u [{unit}]")], "")[1], format!("u [{si}]"));
        }
        assert_eq!(told(&["time", "I_m", "C_m"], "")[1..], ["I_m [A]", "C_m [V]"]);
    }

    #[test]
    fn of_several_columns_for_a_signal_the_measured_one_that_moves_is_taken() {
        let taken = |texts: &[&str]| told(texts, "");
        let both = taken(&["t", "speed_filt [rpm]", "speed_meas [rpm]"]);
        assert_eq!(both[1..], ["speed_filt [rpm]", "omega [rad/s]"]);
        let exact = taken(&["t", "speed_meas [rpm]", "omega"]);
        assert_eq!(exact[1..], ["speed_meas [rpm]", "omega [rad/s]"]);
        let wanted = taken(&["t", "i_cmd [A]", "i_meas [A]", "theta_ref [rad]", "theta [rad]"]);
        assert_eq!(wanted[1..], ["i_cmd [A]", "i [A]", "reference [rad]", "theta [rad]"]);
        let load = taken(&["t", "theta [rad]", "theta_load [deg]", "torque_sensor [Nm]", "Nm_x"]);
        assert_eq!(load[2..4], ["theta_load [rad]", "T_l [N m]"]);
        let texts = ["t", "current [A]", "Strom [A]"].map(str::to_owned);
        let still = Look { constant: true, ..Look::default() };
        let looks = [Look::default(), still, Look::default()];
        let header = resolve("a.csv", &texts, &[], &looks).unwrap();
        assert_eq!(header.columns[2].note.signal, "i");
        assert_eq!(taken(&["t", "velocity", "angle [deg]"])[1], "omega [rad/s]");
    }

    #[test]
    fn counts_need_to_be_told_how_many() {
        let header = |texts: &[&str], maps: &str| header(texts, maps).unwrap();
        let kept = header(&["time", "theta [counts]", "encoder_cnt"], "");
        assert_eq!(kept.columns[1].note.signal, "theta_counts");
        assert_eq!(kept.columns[2].note.unit, "cnt");
        assert!(kept.notes[0].contains("--columns theta=theta:counts/4096"), "{:?}", kept.notes);
        let told = header(&["time", "enc"], "theta=enc:counts/4096");
        assert_eq!(told.columns[1].note.unit, "rad");
        assert_eq!(told.columns[1].convert(4096.0), std::f64::consts::TAU);
        let share = header(&["time", "torque [%]"], "");
        assert_eq!(share.columns[1].note.signal, "torque_share");
        assert!(share.notes[0].contains("--columns torque=torque:UNIT"), "{:?}", share.notes);
        assert_eq!(header(&["time", "pos [counts*0.05um]"], "").columns[1].note.signal, "x");
        assert_eq!(header(&["time", "pos [counts(4096)]"], "").columns[1].note.signal, "theta");
    }

    #[test]
    fn foreign_names_give_way_to_exact_ones_and_to_mappings() {
        assert_eq!(told(&["t", "Speed [rpm]", "omega"], "")[1..], ["Speed [rpm]", "omega [rad/s]"]);
        let mapped = told(&["t", "Speed", "omega"], "omega=Speed:rpm,omega_2=omega");
        assert_eq!(mapped[1..], ["omega [rad/s]", "omega_2 [1]"]);
        assert_eq!(told(&["t", "vibration (g)"], "")[1], "vibration [g]");
        assert_eq!(told(&["Timestamp", "V [m/s]", "V_ref"], "")[1..], ["v [m/s]", "V_ref [1]"]);
        assert_eq!(told(&["t", "n"], "")[1], "omega [rad/s]");
        assert!(header(&["t", "n"], "").unwrap().columns[1].note.converted);
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_next_step() {
        let error = |texts: &[&str], maps: &str| header(texts, maps).unwrap_err().to_string();
        let unit = error(&["time", "omega [furlong]"], "");
        assert!(unit.contains("`furlong`") && unit.contains("rpm"), "{unit}");
        assert!(error(&["time", "theta [V]"], "").contains("no unit of theta"));
        assert!(error(&["time", "u", "u"], "").contains("columns 2 and 3"));
        // One of them said to be something else, the other is no duplicate.
        assert_eq!(told(&["time", "u", "u"], "u_unused=u#2")[1..], ["u [V]", "u_unused [1]"]);
        assert!(error(&["time", "u [V]", "u [mV]"], "").contains("columns 2 and 3"));
        assert!(error(&["time", "a", "u"], "u=a").contains("both column `a` and column `u`"));
        assert!(error(&["time", "a"], "u=b").contains("it has `time`, `a`"));
    }
}
