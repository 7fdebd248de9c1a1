//! `fit`: the parameters of a drive from recordings, with their standard errors.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::{Evidence, Options, Purpose, Setting, evaluate, fit};
use drivescope_plant::drive::Drive;

use super::Run;
use crate::answer::fit::{FitAnswer, Judged};
use crate::answer::text;
use crate::drive_source;
use crate::drive_text::with_estimates;
use crate::evidence::{EvidenceOptions, Gathered};
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::output;
use crate::session::Session;

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
            let judged = evaluate(drive, evidence, &setting, own).map_err(into_report)?;
            Ok::<_, miette::Report>(Judged::new(drive, evidence, &setting, &judged))
        };
        // The base may overflow where the fitted drive does not: it then has no error to tell.
        let before = [judge(&base, estimation, false).ok(), judge(&base, validation, true).ok()];
        bar.inc(1);
        let options = Options { seed: session.seed, ..Options::default() };
        let fitted = fit(&base, estimation, &setting, &options).map_err(into_report)?;
        bar.inc(1);
        let after = [
            Judged::of_fit(&fitted, estimation, &setting),
            judge(&fitted.drive, validation, true)?,
        ];
        bar.finish_and_clear();
        let given = drive_source::text(&self.drive)?;
        let file = with_estimates((&self.drive, &given), &fitted, &gathered)?;
        output::write_file(&self.output, |out| out.write_all(file.as_bytes()))?;
        let answer = FitAnswer::new(
            &base,
            session.named(&self.output),
            &gathered,
            &fitted,
            &setting,
            (before, after),
            session.seed,
        );
        let next = self.evidence.on(Next::new("compare").files([&self.output]));
        session.wrote(&text(&answer.blocks()), &answer, &next)?;
        Ok(Ending::Done)
    }
}
