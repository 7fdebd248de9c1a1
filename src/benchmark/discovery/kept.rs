//! The cases as files, for those who want to see one: drive file, both recordings and the truth.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;

use drivescope_plant::drive::LawData;
use drivescope_plant::file::target_key;
use serde::Serialize;

use super::{Case, Grade, Group};
use crate::failure::Failure;
use crate::output::{json, write_file, write_recording};

/// What is true of a case, as `truth.json` says it.
#[derive(Debug, Serialize)]
struct Truth<'a> {
    group: Group,
    /// Whether an independent program made it.
    foreign: bool,
    grade: Grade,
    hidden: &'a [String],
    /// The law where nobody programmed it.
    #[serde(skip_serializing_if = "Option::is_none")]
    law: Option<TypedLaw<'a>>,
    /// Standard deviation of the noise of each signal of the recordings, SI.
    noise: [BTreeMap<&'a str, f64>; 2],
}

/// A typed law with its coefficients.
#[derive(Debug, Serialize)]
struct TypedLaw<'a> {
    formula: String,
    parameters: BTreeMap<&'a str, f64>,
}

/// Writes every case into a folder `case_0000` and so on of its own.
///
/// # Errors
/// The path that cannot be written.
pub(super) fn keep(cases: &[Case], folder: &Path) -> miette::Result<()> {
    for (number, case) in cases.iter().enumerate() {
        let own = folder.join(format!("case_{number:04}"));
        let unwritable = |source| Failure::Write { path: own.clone(), source };
        std::fs::create_dir(&own).map_err(unwritable)?;
        let text = |name: &str, text: &str| {
            write_file(&own.join(name), |out| out.write_all(text.as_bytes()))
        };
        text("drive.toml", &case.drive.to_toml())?;
        text("truth.json", &json(&truth(case))?)?;
        write_recording(&own.join("estimation.csv"), &case.estimation.recording)?;
        write_recording(&own.join("validation.csv"), &case.validation.recording)?;
    }
    Ok(())
}

fn truth(case: &Case) -> Truth<'_> {
    let law = case.law.as_ref().and_then(|law| {
        let effect = law.effect();
        let Some(LawData::Typed { target, text }) = &effect.law else { return None };
        let parameters = effect.parameters.iter().map(|(name, value)| (name.as_str(), *value));
        Some(TypedLaw {
            formula: format!("{} = {text}", target_key(*target, case.drive.motion)),
            parameters: parameters.collect(),
        })
    });
    let noise = [&case.estimation, &case.validation]
        .map(|it| it.noise.iter().map(|(name, sd)| (name.as_str(), *sd)).collect());
    let Case { group, foreign, grade, hidden, .. } = case;
    Truth { group: *group, foreign: *foreign, grade: *grade, hidden, law, noise }
}

#[cfg(test)]
mod tests {
    use drivescope_plant::drive::Drive;
    use drivescope_recording::{ReadOptions, read};

    use super::*;
    use crate::benchmark::discovery::own;

    #[test]
    fn a_case_reads_back_as_it_was_judged() {
        let here = tempfile::tempdir().expect("a folder");
        let cases = own::unprogrammed(2, 7);
        keep(&cases, here.path()).expect("written");
        for (number, case) in cases.iter().enumerate() {
            let own = here.path().join(format!("case_{number:04}"));
            assert_eq!(Drive::read(own.join("drive.toml")).expect("a drive"), case.drive);
            for (name, kept) in [("estimation", &case.estimation), ("validation", &case.validation)]
            {
                let file = own.join(format!("{name}.csv"));
                let (back, _) = read(file, &ReadOptions::default()).expect("a recording");
                for signal in &kept.recording.signals {
                    let same = back.signals.iter().find(|it| it.name == signal.name);
                    assert_eq!(same.map(|it| &it.values), Some(&signal.values), "{}", signal.name);
                }
            }
            let text = std::fs::read_to_string(own.join("truth.json")).expect("the truth");
            let truth: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            assert_eq!(truth["hidden"][0], case.hidden[0]);
            assert!(truth["law"]["formula"].as_str().is_some_and(|it| it.contains(" = ")));
        }
    }
}
