//! `fit`: the parameters of a drive from recordings, with their standard errors.

mod answer;

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::{Evidence, Fitted, Options, Purpose, Setting, evaluate, fit};
use drivescope_plant::drive::Drive;
use drivescope_plant::file::Change;

use super::Run;
use crate::drive_source;
use crate::evidence::{EvidenceOptions, Gathered};
use crate::failure::{Ending, told};
use crate::next::Next;
use crate::output;
use crate::session::Session;
use answer::{Answer, Judged};

/// Estimate the parameters of a drive from recordings, with standard errors.
#[derive(Debug, Args)]
pub(crate) struct Fit {
    /// Drive file, or a built-in drive (`dr300`, `emps`): where the search starts.
    drive: String,
    /// Drive file to write (.toml): the given one with the estimated values, its comments kept.
    #[arg(short, long, value_name = "DRIVE")]
    output: PathBuf,
    #[command(flatten)]
    evidence: EvidenceOptions,
}

impl Run for Fit {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let base = drive_source::drive(&self.drive)?;
        session.check_writable(&[&self.output])?;
        let gathered = self.evidence.gather((&base, Purpose::Drive), session)?;
        let Gathered { estimation, validation, .. } = &gathered;
        let setting = Setting::of_fit(&base, estimation);
        let bar = session.progress(3, "fitting");
        let judge = |drive: &Drive, evidence: &Evidence, own: bool| {
            let judged = evaluate(drive, evidence, &setting, own).map_err(told)?;
            Ok::<_, miette::Report>(Judged::new(drive, evidence, judged))
        };
        // The base may overflow where the fitted drive does not: it then has no error to tell.
        let before = [judge(&base, estimation, false).ok(), judge(&base, validation, true).ok()];
        bar.inc(1);
        let options = Options { seed: session.seed, ..Options::default() };
        let fitted = fit(&base, estimation, &setting, &options).map_err(told)?;
        bar.inc(1);
        let after = [Judged::of_fit(&fitted, estimation), judge(&fitted.drive, validation, true)?];
        bar.finish_and_clear();
        let text = drive_source::text(&self.drive)?;
        let changes = changes(&fitted, &gathered);
        let (text, _) = Drive::edited(&text, &self.drive, &changes).map_err(told)?;
        output::write_file(&self.output, |out| out.write_all(text.as_bytes()))?;
        let answer = Answer::new(
            &base,
            &self.output,
            &gathered,
            &fitted,
            &setting,
            (before, after),
            session.seed,
        );
        let next = self.evidence.on(Next::new("compare").files([&self.output]));
        session.wrote(&answer.text(), &answer, &next)?;
        Ok(Ending::Done)
    }
}

/// What changes in the drive file.
fn changes(fitted: &Fitted, gathered: &Gathered) -> Vec<Change> {
    let from = gathered.files();
    let mut changes: Vec<Change> = fitted
        .parameters
        .iter()
        .map(|it| {
            let known = match it.at_bound {
                true => "at its bound".to_owned(),
                false => format!("standard error {:.2e}", it.std_error),
            };
            let origin = format!("fitted: {from}; {known}");
            Change { name: it.name.clone(), value: it.value, origin }
        })
        .collect();
    if fitted.drive.motor.tie_k && changes.iter().any(|change| change.name == "K_e") {
        let origin = format!("fitted: {from}; tied to K_e");
        changes.push(Change { name: "K_m".to_owned(), value: fitted.drive.motor.k_m, origin });
    }
    let all = fitted.drive.parameters();
    for own in fitted.recordings.first().map_or(&[][..], |fit| &fit.own) {
        let value = all.iter().find(|it| it.name == own.name).map_or(own.value, |it| it.value);
        let several = if fitted.recordings.len() > 1 { "mean of several, " } else { "" };
        let origin = format!("fitted: {from}; {several}differs from recording to recording");
        changes.push(Change { name: own.name.clone(), value, origin });
    }
    changes
}
