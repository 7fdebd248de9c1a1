//! The program `drivescope`.

use std::process::ExitCode;

fn main() -> ExitCode {
    drivescope::run(std::env::args_os())
}
