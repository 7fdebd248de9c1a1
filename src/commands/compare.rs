//! `compare`: a model against recordings of its drive, and where it fails.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::compare::{Options, compare};
use drivescope_discovery::{
    Observer, Purpose, Setting, USUAL_BAND_HZ, evaluate, relative_force_error,
};

use super::{RecordingOptions, Run};
use crate::answer::compare::{self as answer, CompareAnswer};
use crate::answer::text;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::read_evidence::{ReadEvidence, given_noise, read_evidence};
use crate::report::compare::compare_html;
use crate::session::Session;
use crate::{drive_source, output};

/// Compare a drive's model with recordings: how well it fits, and where and when it fails.
#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// Drive file, or a built-in drive (`dr300`, `emps`).
    drive: String,
    /// Recordings of one machine: the same signals and sampling time.
    #[arg(required = true, value_name = "REC")]
    recordings: Vec<PathBuf>,
    /// Further recordings, of which only the error is told.
    #[arg(long, value_name = "REC", num_args = 1..)]
    validate: Vec<PathBuf>,
    /// Standard deviations of the sensors' noise, SI: `i=0.01,omega=0.3`; what is not given is
    /// taken from the drive file or estimated from the recording.
    #[arg(long, value_name = "NAME=SD,..")]
    noise: Option<String>,
    /// Report to write (.html): what is missing over each variable, in pictures.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// End with exit status 1 if the model fails over any variable.
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    reading: RecordingOptions,
}

impl Run for Compare {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let drive = drive_source::drive(&self.drive)?;
        session.check_writable(&self.out.iter().collect::<Vec<_>>())?;
        let given = given_noise(&drive, self.noise.as_deref())?;
        let read = |files: &[PathBuf]| {
            read_evidence((&drive, Purpose::Drive), files, &given, &self.reading, session)
        };
        let ReadEvidence { evidence, noise, mut signals, doubts } = read(&self.recordings)?;
        let validation = if self.validate.is_empty() { None } else { Some(read(&self.validate)?) };
        if let Some(it) = &validation {
            signals.extend(it.signals.iter().cloned());
        }
        let observer = Observer::choose(&drive, &evidence.recordings, &evidence.noise);
        let setting = Setting::new(&drive, observer);
        let spinner = session.spinner();
        spinner.set_message("comparing");
        let options = Options { curves: true, seed: session.seed, fit: true };
        let compared = compare(&drive, &evidence, &setting, &options).map_err(into_report)?;
        let validation_error = validation
            .map(|it| evaluate(&drive, &it.evidence, &setting, true).map_err(into_report))
            .transpose()?
            .map(|judged| judged.squares.error());
        spinner.finish_and_clear();
        let first = evidence.recordings.first();
        let force = first.and_then(|it| relative_force_error(&drive, it, USUAL_BAND_HZ));
        let seed = session.seed;
        let setting =
            answer::Setting::new(&drive, &evidence, &noise[0], validation_error, &doubts, seed);
        let answer = CompareAnswer::new(&compared, &setting, &signals, force);
        let blocks = answer.blocks();
        if let Some(out) = &self.out {
            let html = compare_html(&setting, &blocks);
            output::write_file(out, |file| file.write_all(html.as_bytes()))?;
        }
        let fails = compared.fails();
        let on = |next: Next| {
            let next = next.with(&self.drive).files(&self.recordings);
            self.reading.on(next.judged(&self.validate, self.noise.as_deref()))
        };
        // Beyond the noise other values would explain more, whether or not a variable shows it.
        let next = match (compared.is_unfitted(), fails) {
            (true, shown) if shown || !answer::explains(&compared) => {
                on(Next::new("fit")).options(" -o fitted.toml")
            }
            (_, true) => on(Next::new("discover")).options(" -o found.toml"),
            (_, false) => Next::new("export").with(&self.drive).options(" -o drive.fmu"),
        };
        session.say(&text(&blocks), &answer, &next)?;
        Ok(if self.check && fails { Ending::Forbidden } else { Ending::Done })
    }
}
