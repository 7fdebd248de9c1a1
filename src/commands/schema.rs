//! `schema`: JSON Schemas, from which editors complete and check the files of this program.

use clap::{Args, ValueEnum};
use drivescope_plant::file::schema_json;
use miette::IntoDiagnostic;

use super::Run;
use crate::failure::Ending;
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
}

impl Run for Schema {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let text = match self.of {
            Kind::Drive => schema_json(),
        };
        let value: serde_json::Value = serde_json::from_str(&text).into_diagnostic()?;
        session.answer(&text, &value)?;
        Ok(Ending::Done)
    }
}
