//! `fmu`: any FMU of any tool, described, checked and run.

mod info;
mod run;
mod validate;

use clap::{Args, Subcommand};

use super::Run;
use crate::failure::Ending;
use crate::session::Session;

/// Describe, check or run any FMU.
#[derive(Debug, Args)]
#[command(arg_required_else_help = true)]
pub(crate) struct Fmu {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Info(info::Info),
    Validate(validate::Validate),
    Run(Box<run::RunFmu>),
}

impl Run for Fmu {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        match self.what {
            What::Info(arguments) => arguments.run(session),
            What::Validate(arguments) => arguments.run(session),
            What::Run(arguments) => (*arguments).run(session),
        }
    }
}
