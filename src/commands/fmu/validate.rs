//! `fmu validate`: an FMU against the rules of the standard, and a short run of it.

use std::path::PathBuf;

use clap::Args;
use drivescope_fmu::import::{Finding, Fmu, Severity, validate};
use serde::Serialize;

use crate::commands::Run;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::session::Session;

/// Check an FMU against the standard and try it.
#[derive(Debug, Args)]
pub(crate) struct Validate {
    /// The FMU.
    file: PathBuf,
    /// End with exit code 1 if anything is found.
    #[arg(long)]
    check: bool,
}

#[derive(Debug, Serialize)]
struct Shown {
    severity: &'static str,
    line: Option<u32>,
    column: Option<u32>,
    text: String,
}

impl Run for Validate {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let fmu = Fmu::open(&self.file).map_err(into_report)?;
        let findings = validate(&fmu);
        let shown: Vec<Shown> = findings.iter().map(shown).collect();
        let verdict = match findings.len() {
            0 => "nothing found".to_owned(),
            1 => "1 finding".to_owned(),
            many => format!("{many} findings"),
        };
        let lines: String = findings.iter().map(|finding| format!("  {finding}\n")).collect();
        let next = Next::new("fmu run").files([&self.file]).options(" -o run.csv");
        session.say(&format!("{}: {verdict}\n{lines}", fmu.name()), &shown, &next)?;
        Ok(if self.check && !findings.is_empty() { Ending::Forbidden } else { Ending::Done })
    }
}

fn shown(finding: &Finding) -> Shown {
    Shown {
        severity: if finding.severity == Severity::Error { "error" } else { "warning" },
        line: finding.place.map(|place| place.line),
        column: finding.place.map(|place| place.column),
        text: finding.text.clone(),
    }
}
