//! `discover`: which physical effect the model lacks; found, added, and the error falls.

mod report;
mod watch;

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::{Discovery, Error, Evidence, Purpose, Verdict, Watch, discover};
use drivescope_plant::drive::Drive;

use super::Run;
use crate::answer::discover::{DiscoverAnswer, Missing};
use crate::answer::text;
use crate::drive_source;
use crate::drive_text::with_effects;
use crate::evidence::EvidenceOptions;
use crate::failure::{Ending, into_report};
use crate::interrupt;
use crate::next::Next;
use crate::output;
use crate::session::Session;

use report::report;
use watch::Watching;

/// Find what a drive's model lacks, add it, and print the error before and after.
#[derive(Debug, Args)]
pub(crate) struct Discover {
    /// Drive file, or a built-in drive (`dr300`, `emps`): the base to which effects are added.
    drive: String,
    /// Drive file to write (.toml): the given one with what was found, its comments kept.
    #[arg(short, long, value_name = "DRIVE")]
    output: Option<PathBuf>,
    /// Report to write (.html): what is missing, the ladder, parameters, and what is left.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    evidence: EvidenceOptions,
}

impl Run for Discover {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let search = Search {
            added: false,
            given: &self.drive,
            base: &drive_source::drive(&self.drive)?,
            output: self.output.as_ref(),
            report: self.out.as_ref(),
            evidence: &self.evidence,
        };
        search.run(session, discover)
    }
}

/// Which drive, which recordings, and where what is found goes to: what `discover` and `add` share.
pub(super) struct Search<'a> {
    /// Whether the effects that are named are added as the user wished, or missing.
    pub(super) added: bool,
    /// The drive as the user named it.
    pub(super) given: &'a str,
    /// That drive.
    pub(super) base: &'a Drive,
    /// Drive file to write.
    pub(super) output: Option<&'a PathBuf>,
    /// Report to write.
    pub(super) report: Option<&'a PathBuf>,
    /// The recordings.
    pub(super) evidence: &'a EvidenceOptions,
}

impl Search<'_> {
    /// Searches with its progress shown, then writes the drive file and the answer.
    pub(super) fn run(
        &self,
        session: &Session,
        find: impl FnOnce(&Drive, &Evidence, &Evidence, &dyn Watch) -> Result<Discovery, Error>,
    ) -> miette::Result<Ending> {
        session.check_writable(&self.output.into_iter().chain(self.report).collect::<Vec<_>>())?;
        let gathered = self.evidence.gather((self.base, Purpose::Search), session)?;
        let watching = Watching::new(session, self.base.motion);
        let found = find(self.base, &gathered.estimation, &gathered.validation, &watching);
        watching.end();
        // What was found until then is not the answer.
        interrupt::check()?;
        let found = found.map_err(into_report)?;
        let missing = Missing::of(&found, self.added);
        // Of what was not judged there is no drive to write.
        let output = self.output.filter(|_| found.verdict != Verdict::NotJudged);
        if let Some(path) = output {
            let text = with_effects(
                (self.given, &drive_source::text(self.given)?),
                self.base,
                &found.drive,
                &gathered,
            )?;
            output::write_file(path, |out| out.write_all(text.as_bytes()))?;
        }
        if let Some(path) = self.report {
            let html = report((&found, &missing), &gathered, session.seed)?;
            output::write_file(path, |out| out.write_all(html.as_bytes()))?;
        }
        let written = output.and_then(|path| session.named(path));
        let answer =
            DiscoverAnswer::new(self.base, written, &gathered, (&found, missing), session.seed);
        let next = match (output, found.verdict) {
            (Some(output), _) => self.evidence.on(Next::new("compare").files([output])),
            // Signals are mended first; nothing is there to be written.
            (None, Verdict::NotJudged) => {
                Next::new("serve").with(self.given).files(self.evidence.files())
            }
            (None, Verdict::None) => Next::new("export").with(self.given).options(" -o drive.fmu"),
            (None, Verdict::Named | Verdict::Unknown) => {
                let again = Next::new("discover").with(self.given);
                self.evidence.on(again).options(" -o found.toml --out found.html")
            }
        };
        session.say(&text(&answer.blocks()), &answer, &next)?;
        Ok(Ending::Done)
    }
}
