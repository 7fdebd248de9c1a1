//! `benchmark rule`: what becomes of the answers when a number of the rule of naming is moved.

use clap::Args;

use crate::benchmark::discovery::{Moved, discoveries, python};
use crate::commands::Run;
use crate::commands::counts::all_positive;
use crate::failure::Ending;
use crate::next::Next;
use crate::session::Session;

/// What becomes of the answers when a number of the rule of naming is moved.
///
/// Each of its ten numbers is halved and doubled, over the same cases: half of them from independent
/// generators (Python programs that need numpy: the Python of DRIVESCOPE_PYTHON, or python3 on the
/// path), and over the machines that other people recorded, where DRIVESCOPE_DATA names a folder that
/// holds them.
#[derive(Debug, Args)]
pub(super) struct OfRule {
    /// Cases to draw; each is answered 21 times. A tenth more hide laws that nobody programmed.
    #[arg(long, value_name = "N", default_value_t = 40)]
    cases: usize,
}

impl Run for OfRule {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        all_positive(&[("cases", self.cases as u64)], "")?;
        session.check_writable(&[])?;
        let bar = session.progress(discoveries(self.cases) as u64, "discovering");
        let moved = Moved::run(self.cases, session.seed, &python(), &|| bar.inc(1))?;
        bar.finish_and_clear();
        session.say(&moved.text(), &moved, &Next::new("benchmark discovery"))?;
        Ok(Ending::Done)
    }
}
