//! Machines that were recorded by other people: what a discovery names on them, unaided.
//!
//! The data are not shipped: they are found through `DRIVESCOPE_DATA`, a folder a machine, and a
//! machine that is not there is said to be absent. What is right is what those who recorded them
//! published, or what a least-squares balance of their data shows.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use drivescope_discovery::{Discovery, LadderStep, Purpose, Rule, Unwatched, discover_by};
use drivescope_plant::drive::Drive;
use drivescope_recording::{ReadOptions, Recording, read};
use serde::Serialize;

use super::emps::Emps;
use crate::drive_source;
use crate::evidence::Gathered;
use crate::failure::into_report;
use crate::first_drive::{FirstDrive, Given};
use crate::interrupt;
use crate::read_evidence::{ReadEvidence, evidence_of};

/// The machine whose drive is shipped, and has figures of its own.
const EMPS: &str = "emps";

/// A machine, its recordings, and what it lacks.
struct Machine {
    /// Its folder in the data.
    folder: &'static str,
    /// Files to fit to; a first drive is made from the first of them where none is shipped.
    fit: &'static [&'static str],
    /// Files to judge by; without them the last third of the first is held out.
    judged: &'static [&'static str],
    /// Names of which one at least is right.
    right: &'static [&'static str],
    /// Names that are no mistake beside them.
    beside: &'static [&'static str],
}

const MACHINES: [Machine; 4] = [
    Machine {
        folder: EMPS,
        fit: &["emps_estimation.csv"],
        judged: &["emps_validation.csv"],
        right: &["asymmetric_friction"],
        // Of 0.3 to 0.85 ms, by the published analyses.
        beside: &["delay"],
    },
    Machine {
        folder: "hsm150",
        fit: &["pos_0.06_1.csv", "neg_0.045_1.csv"],
        judged: &["pos_0.065_3.csv", "neg_0.04_3.csv"],
        right: &["constant_load", "asymmetric_friction"],
        beside: &[],
    },
    Machine {
        folder: "odrive",
        fit: &["0.csv"],
        judged: &["1.csv"],
        right: &["cogging"],
        beside: &[],
    },
    Machine {
        folder: "flexible_link",
        fit: &["ctu_stage1.csv"],
        judged: &[],
        right: &["flexible_coupling"],
        beside: &[],
    },
];

/// What a discovery answers on a machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Row {
    machine: &'static str,
    /// What is right.
    expected: &'static [&'static str],
    /// What was named, or why there is no answer.
    answer: Result<Vec<String>, String>,
    right: bool,
    /// Whether something was named that is not there.
    wrong: bool,
    /// Error on the recordings that judge over that of the base.
    validation_ratio: Option<f64>,
    /// Unexplained torque or force in them over that of the base.
    torque_ratio: Option<f64>,
}

/// The machines whose data are there.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(crate) struct Real {
    rows: Vec<Row>,
    /// Machines whose data are not there.
    absent: Vec<&'static str>,
    /// The figures of the axis that has some of its own.
    emps: Option<Emps>,
}

impl Real {
    /// Discovers on each machine whose data are there.
    ///
    /// # Errors
    /// The user stops. What goes wrong with a machine is its answer.
    pub(super) fn run(rule: &Rule) -> miette::Result<Self> {
        let data = std::env::var_os("DRIVESCOPE_DATA").map(PathBuf::from);
        let mut real = Self::default();
        for machine in &MACHINES {
            interrupt::check()?;
            let folder = data.as_ref().map(|data| data.join(machine.folder));
            let Some(folder) = folder.filter(|folder| folder.is_dir()) else {
                real.absent.push(machine.folder);
                continue;
            };
            let found = machine.found(rule, &folder);
            if machine.folder == EMPS {
                real.emps = found.as_ref().ok().map(Emps::of);
            }
            let row = match found {
                Ok(found) => machine.row(Ok(found.named), &found.ladder),
                Err(error) => machine.row(Err(error.to_string()), &[]),
            };
            real.rows.push(row);
        }
        Ok(real)
    }

    /// What was named on each machine, right ones and wrong ones among them.
    pub(super) fn answers(
        &self,
    ) -> impl Iterator<Item = (&Result<Vec<String>, String>, bool, bool)> {
        self.rows.iter().map(|row| (&row.answer, row.right, row.wrong))
    }

    /// The rows of the table.
    pub(super) fn text(&self) -> String {
        let mut text = String::from("Machines that others recorded, unaided\n");
        for Row { machine, expected, answer, right, validation_ratio, torque_ratio, .. } in
            &self.rows
        {
            let named = match answer {
                Ok(named) if named.is_empty() => "nothing".to_owned(),
                Ok(named) => named.join(", "),
                Err(reason) => format!("no answer: {reason}"),
            };
            let judged = if *right { "right" } else { "not right" };
            let _ = write!(text, "  {machine:<14} {judged:<10} named {named}");
            let _ = writeln!(text, "  (there is {})", expected.join(" or "));
            for (what, ratio) in [("error", validation_ratio), ("unexplained torque", torque_ratio)]
            {
                if let Some(ratio) = ratio {
                    let what = format!("validation {what} over the base's");
                    let _ = writeln!(text, "    {what:<50} {ratio:.3}");
                }
            }
        }
        if !self.absent.is_empty() {
            let absent = self.absent.join(", ");
            let _ = writeln!(text, "  not run, no such folder in DRIVESCOPE_DATA: {absent}");
        }
        if !self.rows.is_empty() {
            let count = |is: fn(&Row) -> bool| self.rows.iter().filter(|row| is(row)).count();
            let (right, wrong) = (count(|row| row.right), count(|row| row.wrong));
            let all = self.rows.len();
            let _ = writeln!(text, "  right {right} of {all}, a wrong name in {wrong}");
        }
        text + &self.emps.as_ref().map(Emps::text).unwrap_or_default()
    }
}

impl Machine {
    fn found(&self, rule: &Rule, folder: &Path) -> miette::Result<Discovery> {
        let of = |names: &[&str]| -> miette::Result<Vec<(String, Recording)>> {
            let one = |name: &&str| {
                let (recording, _) =
                    read(folder.join(name), &ReadOptions::default()).map_err(into_report)?;
                Ok(((*name).to_owned(), recording))
            };
            names.iter().map(one).collect()
        };
        let (fit, judged) = (of(self.fit)?, of(self.judged)?);
        let drive = if self.folder == EMPS {
            drive_source::drive(EMPS)?
        } else {
            let first = FirstDrive::of(&fit[0].1, None, &Given::default())?;
            let (text, _) = first.file(self.folder)?;
            Drive::parse(&text, self.folder).map_err(into_report)?
        };
        let search = |some: &[(String, Recording)]| {
            if some.is_empty() {
                return Ok(ReadEvidence::none());
            }
            evidence_of((&drive, Purpose::Search), some, &[])
        };
        let Gathered { estimation, validation, .. } =
            Gathered::of(search(&fit)?, search(&judged)?)?;
        discover_by(rule, &drive, (&estimation, &validation), &Unwatched).map_err(into_report)
    }

    fn row(&self, answer: Result<Vec<String>, String>, ladder: &[LadderStep]) -> Row {
        let named = answer.as_ref().map_or(&[][..], Vec::as_slice);
        let is_of = |some: &[&str], name: &String| some.contains(&name.as_str());
        let wrong = named.iter().any(|name| !is_of(self.right, name) && !is_of(self.beside, name));
        let ends = ladder.first().zip(ladder.last());
        let remainder =
            |step: &LadderStep| step.validation_unexplained.torque.as_ref().map(|it| it.rms);
        Row {
            machine: self.folder,
            expected: self.right,
            right: !wrong && named.iter().any(|name| is_of(self.right, name)),
            wrong,
            validation_ratio: ends.map(|(base, end)| end.validation_error / base.validation_error),
            torque_ratio: ends.and_then(|(base, end)| Some(remainder(end)? / remainder(base)?)),
            answer,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_a_wrong_name_and_a_failure_is_no_right_answer() {
        let row = |named: &[&str]| {
            MACHINES[0].row(Ok(named.iter().map(|name| (*name).to_owned()).collect()), &[])
        };
        let is = |row: Row| (row.right, row.wrong);
        assert_eq!(is(row(&["asymmetric_friction", "delay"])), (true, false));
        assert_eq!(is(row(&["asymmetric_friction", "cogging"])), (false, true));
        assert_eq!(is(row(&["delay"])), (false, false));
        assert_eq!(is(row(&[])), (false, false));
        let failed = MACHINES[2].row(Err("no time axis".to_owned()), &[]);
        assert_eq!((failed.right, failed.wrong), (false, false));
        let real = Real { rows: vec![failed], absent: vec![EMPS], emps: None };
        let text = real.text();
        for part in ["no answer: no time axis", "DRIVESCOPE_DATA: emps", "right 0 of 1"] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
