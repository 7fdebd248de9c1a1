//! `discover`: which physical effect the model lacks; found, added, and the error falls.

mod answer;
mod watch;

use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::discover;

use super::Run;
use crate::drive_source;
use crate::evidence::EvidenceOptions;
use crate::failure::{Ending, told};
use crate::interrupt;
use crate::output;
use crate::session::Session;

pub(super) use answer::{Answer, with_effects};
pub(super) use watch::Watching;

/// Find what a drive's model lacks, add it, and print the error before and after.
#[derive(Debug, Args)]
pub(crate) struct Discover {
    /// Drive file, or a built-in drive (`dr300`, `emps`): the base to which effects are added.
    drive: String,
    /// Drive file to write (.toml): the given one with what was found, its comments kept.
    #[arg(short, long, value_name = "DRIVE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    evidence: EvidenceOptions,
}

impl Run for Discover {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let base = drive_source::drive(&self.drive)?;
        let targets: Vec<&PathBuf> = self.output.iter().collect();
        session.check_writable(&targets)?;
        let gathered = self.evidence.gather(&base, session)?;
        let watching = Watching::new(session);
        let found = discover(&base, &gathered.estimation, &gathered.validation, &watching);
        watching.end();
        let found = found.map_err(told)?;
        // What was found until then is not the answer.
        interrupt::check()?;
        if let Some(path) = &self.output {
            let text = with_effects(&self.drive, &base, &found.drive, &gathered)?;
            output::write_file(path, |out| std::io::Write::write_all(out, text.as_bytes()))?;
        }
        let answer = Answer::new(&base, self.output.as_deref(), &gathered, &found, session.seed);
        session.answer(&answer.text(), &answer)?;
        Ok(Ending::Done)
    }
}
