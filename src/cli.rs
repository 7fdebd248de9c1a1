//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser};

use crate::commands::Command;

/// Simulates an electric drive, exports it as an FMU, diagnoses its faults, and finds what its
/// model lacks.
#[derive(Debug, Parser)]
#[command(name = "drivescope", version, max_term_width = 100, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What every command takes.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Common options")]
pub(crate) struct Common {
    /// Write the result as JSON to FILE, or with `-` to standard output in place of the text.
    #[arg(long, global = true, value_name = "FILE|-")]
    pub(crate) json: Option<PathBuf>,
    /// Seed of everything random: the same seed gives the same bytes; 1 by default, and a fresh
    /// one for benchmarks.
    #[arg(long, global = true, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Say nothing but the answer and errors: no progress, no remarks; nothing at all where the
    /// result is in the file that was asked for.
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_command_and_option_says_what_it_does() {
        fn described(command: &clap::Command) {
            let name = command.get_name();
            assert!(command.get_about().is_some(), "`{name}` has no description");
            for argument in command.get_arguments() {
                assert!(argument.get_help().is_some(), "`{name}`: {} has none", argument.get_id());
            }
            command
                .get_subcommands()
                .filter(|inner| inner.get_name() != "help")
                .for_each(described);
        }
        let mut command = Cli::command();
        command.build();
        described(&command);
    }
}
