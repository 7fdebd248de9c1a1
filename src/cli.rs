//! The command line.

use clap::Parser;

use crate::commands::Command;
use crate::session::Common;

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
