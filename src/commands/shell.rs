//! Help for the shell: completions and the manual page, both from the command line's definition.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Run;
use crate::cli::Cli;
use crate::failure::{Ending, into_report};
use crate::output;
use crate::session::Session;

/// Print the completions for a shell.
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell.
    shell: Shell,
}

impl Run for Completions {
    fn run(self, _: &Session) -> miette::Result<Ending> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "drivescope", &mut text);
        output::print(&String::from_utf8_lossy(&text))?;
        Ok(Ending::Done)
    }
}

/// Print the manual page (roff): `drivescope man | man -l -`.
#[derive(Debug, Args)]
pub(crate) struct Man {}

impl Run for Man {
    fn run(self, _: &Session) -> miette::Result<Ending> {
        let mut text = Vec::new();
        let mut root = Cli::command();
        root.build();
        clap_mangen::Man::new(root.clone()).render(&mut text).map_err(into_report)?;
        for command in root.get_subcommands().filter(|command| command.get_name() != "help") {
            let page = clap_mangen::Man::new(command.clone());
            page.render_name_section(&mut text).map_err(into_report)?;
            page.render_synopsis_section(&mut text).map_err(into_report)?;
            page.render_description_section(&mut text).map_err(into_report)?;
            page.render_options_section(&mut text).map_err(into_report)?;
        }
        output::print(&String::from_utf8_lossy(&text))?;
        Ok(Ending::Done)
    }
}
