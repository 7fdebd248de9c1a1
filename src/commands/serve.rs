//! `serve`: the local page.

use std::path::{Path, PathBuf};

use clap::Args;

use super::Run;
use crate::failure::Ending;
use crate::page::{Served, serve};
use crate::session::Session;

/// Open the local page: drop a recording, see where the model fails, learn what is missing, add it.
#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Drive file, or a built-in drive (`dr300`, `emps`), to begin with; without it a first drive
    /// is made from the recording.
    drive: Option<String>,
    /// Recordings to begin with.
    #[arg(value_name = "REC")]
    recordings: Vec<PathBuf>,
    /// Port on this machine's loopback address; by default any that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Greatest size of an uploaded file, MB.
    #[arg(long, value_name = "MB", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    largest_upload: u64,
}

/// Whether the argument is a file other than a drive file.
fn is_recording(argument: &str) -> bool {
    let path = Path::new(argument);
    path.is_file() && path.extension().is_none_or(|extension| extension != "toml")
}

impl Run for Serve {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let Self { mut drive, mut recordings, port, largest_upload } = self;
        // `serve log.csv`: a file that is no drive file begins the recordings.
        if let Some(first) = drive.take_if(|it| is_recording(it)) {
            recordings.insert(0, PathBuf::from(first));
        }
        let served = Served { port, drive, recordings, most_bytes: largest_upload * 1_000_000 };
        serve(&served, session)?;
        Ok(Ending::Done)
    }
}
