//! `schema`: JSON Schemas, from which editors complete and check the files of this program.

use clap::{Args, ValueEnum};
use drivescope_plant::file::schema_json;
use drivescope_scenarios::campaign;

use super::Run;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::session::Session;

/// Print the JSON Schema of a kind of file.
#[derive(Debug, Args)]
pub(crate) struct Schema {
    /// The kind of file.
    #[arg(default_value = "drive")]
    of: Kind,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// A drive file.
    Drive,
    /// A plan of a campaign.
    Plan,
}

impl Run for Schema {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let text = match self.of {
            Kind::Drive => schema_json(),
            Kind::Plan => campaign::plan::schema_json(),
        };
        let value: serde_json::Value = serde_json::from_str(&text).map_err(into_report)?;
        let next = match self.of {
            Kind::Drive => Next::new("init REC -o drive.toml"),
            Kind::Plan => Next::new("campaign plan.toml -o campaign"),
        };
        session.say(&text, &value, &next)?;
        Ok(Ending::Done)
    }
}
