//! The commands: one file each, and its line in the list below. Help, completions and the manual
//! page derive from it.

mod add;
mod benchmark;
mod campaign;
mod compare;
mod cosim;
mod counts;
mod diagnose;
mod discover;
mod effects;
mod export;
mod fit;
mod fmu;
mod init;
mod recording_options;
mod schema;
mod serve;
mod shell;
mod simulate;
mod study;
mod train;
mod twelve;

use clap::{Args, Subcommand};

pub(crate) use campaign::{campaign_in, campaign_rows, campaign_traces};
pub(crate) use diagnose::{Diagnose, Stream};
pub(crate) use recording_options::{RecordingOptions, at_period, resampled_near};
pub(crate) use train::{Material as TrainMaterial, Plan, Trained, interface, train};

use crate::failure::Ending;
use crate::session::Session;

/// What a command is: its arguments, and what it does with them.
pub(crate) trait Run: Args {
    /// Does it.
    ///
    /// # Errors
    /// Whatever makes the input unusable.
    fn run(self, session: &Session) -> miette::Result<Ending>;
}

macro_rules! commands {
    ($($name:ident: $arguments:ty),+ $(,)?) => {
        /// A command with its arguments; each is described where its arguments are.
        #[derive(Debug, Subcommand)]
        pub(crate) enum Command { $($name($arguments)),+ }

        impl Command {
            /// Runs it.
            pub(crate) fn run(self, session: &Session) -> miette::Result<Ending> {
                match self { $(Self::$name(arguments) => arguments.run(session)),+ }
            }
        }
    };
}

commands! {
    Study: study::Study,
    Train: train::Train,
    Diagnose: diagnose::Diagnose,
    Simulate: simulate::Simulate,
    Init: init::Init,
    Compare: compare::Compare,
    Fit: fit::Fit,
    Discover: discover::Discover,
    Add: add::Add,
    Campaign: campaign::Campaign,
    Benchmark: benchmark::Benchmark,
    Export: export::Export,
    Fmu: fmu::Fmu,
    Cosim: cosim::Cosim,
    Effects: effects::Effects,
    Serve: serve::Serve,
    Schema: schema::Schema,
    Completions: shell::Completions,
    Man: shell::Man,
}
