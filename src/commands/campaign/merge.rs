//! `campaign merge`: one dataset of the parts that shards have made.

use std::path::PathBuf;

use clap::Args;
use drivescope_scenarios::campaign;
use serde::Serialize;

use super::folder;
use super::shard::Shard;
use crate::commands::Run;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::session::Session;

/// Join the parts of a folder to one dataset.
#[derive(Debug, Args)]
pub(super) struct Merge {
    /// The folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

#[derive(Debug, Serialize)]
struct Merged {
    dataset: PathBuf,
    scenarios: u64,
}

impl Run for Merge {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let _claim = if self.folder.is_dir() {
            Some(folder::claim(&self.folder, Shard::WHOLE)?)
        } else {
            None
        };
        let (dataset, scenarios) = campaign::merge(&self.folder).map_err(into_report)?;
        let text = format!("{scenarios} scenarios: {}\n", dataset.display());
        let next = Next::new("campaign report").with(self.folder.display());
        session.wrote(&text, &Merged { dataset, scenarios }, &next)?;
        Ok(Ending::Done)
    }
}
