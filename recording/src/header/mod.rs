//! From column headers to signals: names, units, guesses.

mod capital_t;
mod column;
mod exact;
mod guessed;
mod left_out;
mod motion;
mod naming;
mod twins;
mod which;

pub(crate) use column::Column;
pub use column::{ColumnNote, Taken};
pub(crate) use which::{is_known, is_signal, is_time, missing_time};

use left_out::LeftOut;
use naming::Naming;

use crate::error::Error;
use crate::given::Given;
use crate::look::Look;
use crate::mapping::ReadOptions;

/// The columns of a table, and which of them is the time.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) columns: Vec<Column>,
    /// Position of the time column; none only where a file gives a sampling time instead.
    pub(crate) time: Option<usize>,
    /// What could not be told, a sentence each.
    pub(crate) notes: Vec<String>,
    /// Columns of the table that are none of these.
    pub(crate) left_out: LeftOut,
}

/// Gives every column its name and unit. `looks` says what the values of the columns show, where
/// they are known already.
pub(crate) fn resolve(
    file: &str,
    texts: &[String],
    options: &ReadOptions,
    looks: &[Look],
) -> Result<Header, Error> {
    let given: Vec<Given> = texts.iter().map(|text| Given::of(text)).collect();
    let mut naming = Naming::mapped(file, given, &options.columns, looks)?;
    naming.leave_out_twins();
    naming.no_column_twice()?;
    // Exact names first, so that no guess takes a name that a later column carries itself.
    naming.take_exact(options.of_model)?;
    naming.take_guessed()?;
    naming.take_clock()?;
    naming.finish()
}

/// What a column without a name is called, with its number.
pub(crate) const NAMELESS: &str = "column ";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::Mapping;

    fn header(texts: &[&str], maps: &str) -> Result<Header, Error> {
        let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
        let columns = Mapping::parse_list(maps).unwrap();
        resolve("a.csv", &texts, &ReadOptions { columns, ..ReadOptions::default() }, &[])
    }

    /// `column -> signal [unit]` of every column.
    fn stated(texts: &[&str], maps: &str) -> Vec<String> {
        let stated = |it: &Column| format!("{} [{}]", it.note.signal, it.note.unit);
        header(texts, maps).unwrap().columns.iter().map(stated).collect()
    }

    #[test]
    fn four_header_forms_and_the_bare_name() {
        let texts = ["time [ms]", "u (mV)", "omega/rpm", "pos_mm", "i"];
        let read = header(&texts, "").unwrap();
        assert_eq!(stated(&texts, ""), ["time [s]", "u [V]", "omega [rad/s]", "x [m]", "i [A]"]);
        assert_eq!(read.time, Some(0));
        assert_eq!(read.columns[0].convert(1.0), 0.001);
        assert_eq!(read.columns[3].note.taken, Taken::Guessed);
        assert_eq!(read.columns[4].convert(2.5), 2.5);
    }

    #[test]
    fn sensors_and_inputs_keep_what_they_are_in() {
        assert_eq!(stated(&["time", "T [rpm]"], "")[1], "T [rpm]");
        assert_eq!(stated(&["time", "C_m", "T", "I_m"], "")[2], "T [rpm]");
        assert_eq!(stated(&["time", "T [degC]"], "")[1], "temperature [K]");
        for (unit, si) in [("mA", "A"), ("kN", "N"), ("mN m", "N m"), ("V", "V")] {
            assert_eq!(stated(&["time", &format!("u [{unit}]")], "")[1], format!("u [{si}]"));
        }
        assert_eq!(stated(&["time", "I_m", "C_m"], "")[1..], ["I_m [A]", "C_m [V]"]);
    }

    #[test]
    fn of_several_columns_for_a_signal_the_measured_one_that_moves_is_taken() {
        let taken = |texts: &[&str]| stated(texts, "");
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
        let header = resolve("a.csv", &texts, &ReadOptions::default(), &looks).unwrap();
        assert_eq!(header.columns[2].note.signal, "i");
        assert_eq!(taken(&["t", "velocity", "angle [deg]"])[1], "omega [rad/s]");
    }

    #[test]
    fn signals_of_a_model_are_what_they_say() {
        let texts = ["time", "u [rad/s]", "i", "x [mm]", "T"].map(str::to_owned);
        let options = ReadOptions { of_model: true, ..ReadOptions::default() };
        let of_model = resolve("a.csv", &texts, &options, &[]).unwrap();
        let stated: Vec<_> = of_model
            .columns
            .iter()
            .map(|it| format!("{} [{}]", it.note.signal, it.note.unit))
            .collect();
        assert_eq!(stated, ["time [s]", "u [rad/s]", "i [1]", "x [m]", "T [1]"]);
        assert!(resolve("a.csv", &texts, &ReadOptions::default(), &[]).is_err());
    }

    #[test]
    fn counts_need_to_be_told_how_many() {
        let header = |texts: &[&str], maps: &str| header(texts, maps).unwrap();
        let kept = header(&["time", "theta [counts]", "encoder_cnt"], "");
        assert_eq!(kept.columns[1].note.signal, "theta_counts");
        assert_eq!(kept.columns[2].note.unit, "cnt");
        assert!(kept.notes[0].contains("--columns theta=theta:counts/4096"), "{:?}", kept.notes);
        let stated = header(&["time", "enc"], "theta=enc:counts/4096");
        assert_eq!(stated.columns[1].note.unit, "rad");
        assert_eq!(stated.columns[1].convert(4096.0), std::f64::consts::TAU);
        let share = header(&["time", "torque [%]"], "");
        assert_eq!(share.columns[1].note.signal, "torque_share");
        assert!(share.notes[0].contains("--columns torque=torque:UNIT"), "{:?}", share.notes);
        assert_eq!(header(&["time", "pos [counts*0.05um]"], "").columns[1].note.signal, "x");
        assert_eq!(header(&["time", "pos [counts(4096)]"], "").columns[1].note.signal, "theta");
    }

    #[test]
    fn foreign_names_give_way_to_exact_ones_and_to_mappings() {
        assert_eq!(
            stated(&["t", "Speed [rpm]", "omega"], "")[1..],
            ["Speed [rpm]", "omega [rad/s]"]
        );
        let mapped = stated(&["t", "Speed", "omega"], "omega=Speed:rpm,omega_2=omega");
        assert_eq!(mapped[1..], ["omega [rad/s]", "omega_2 [1]"]);
        assert_eq!(stated(&["t", "vibration (g)"], "")[1], "vibration [g]");
        assert_eq!(stated(&["Timestamp", "V [m/s]", "V_ref"], "")[1..], ["v [m/s]", "V_ref [1]"]);
        assert_eq!(stated(&["t", "n"], "")[1], "omega [rad/s]");
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
        assert_eq!(stated(&["time", "u", "u"], "u_unused=u#2")[1..], ["u [V]", "u_unused [1]"]);
        assert!(error(&["time", "u [V]", "u [mV]"], "").contains("columns 2 and 3"));
        assert!(error(&["time", "a", "u"], "u=a").contains("both column `a` and column `u`"));
        assert!(error(&["time", "a"], "u=b").contains("it has `time`, `a`"));
    }
}
