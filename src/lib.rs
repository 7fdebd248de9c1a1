//! The program: commands over the crates of the workspace.
//!
//! [`run`] reads the command line (`cli`), makes the `Session` that every command
//! gets, and runs one of `commands`. A command computes with the other crates, prints its
//! answer, and returns a finding or an error; here it becomes the exit code: 0 done, 1 a finding that
//! `--check` forbids, 2 bad input or an output that cannot be written, 70 an error of the program
//! itself, 130 stopped by the user.

mod answer;
mod benchmark;
pub mod call;
mod claim;
mod cli;
mod commands;
mod drive_source;
mod drive_text;
mod evidence;
mod expression;
mod failure;
mod first_drive;
mod fmu_file;
mod formula_text;
mod interrupt;
mod next;
mod output;
mod page;
mod panics;
mod read_evidence;
pub mod report;
mod run_folder;
mod session;
mod simulation;

use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::Parser;

use cli::Cli;
use failure::Ending;
use session::Session;

/// Runs the program with these arguments, the first of which is its name.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    ended(arguments).into()
}

/// The same; how it ended.
fn ended(arguments: impl IntoIterator<Item = OsString>) -> Ending {
    panics::install();
    interrupt::install();
    failure::install();
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(usage) => {
            // A reader that has gone away is no reason to complain.
            let _ = usage.print();
            return if usage.use_stderr() { Ending::BadInput } else { Ending::Done };
        }
    };
    let session = Session::new(&cli.common);
    let run = || cli.command.run(&session).unwrap_or_else(|report| failure::report(&report));
    // The hook has said what there is to say of a panic.
    catch_unwind(AssertUnwindSafe(run)).unwrap_or(Ending::Internal)
}
