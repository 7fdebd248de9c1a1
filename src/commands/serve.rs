//! `serve`: the local page.

use std::path::PathBuf;

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

impl Run for Serve {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let Self { drive, recordings, port, largest_upload } = self;
        let served = Served { port, drive, recordings, most_bytes: largest_upload * 1_000_000 };
        serve(&served, session)?;
        Ok(Ending::Done)
    }
}
