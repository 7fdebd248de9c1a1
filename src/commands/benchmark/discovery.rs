//! `benchmark discovery`: how often a hidden effect is named right.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;

use crate::benchmark::discovery::{Table, python, run, timed, unprogrammed};
use crate::commands::Run;
use crate::failure::{Ending, Failure};
use crate::next::Next;
use crate::session::Session;

/// Fewest cases of which every group has some.
const FEWEST: usize = 40;

/// How often hidden effects are named right, and what is named where nothing is hidden.
///
/// Half of the cases come from independent generators, Python programs that need numpy: the
/// Python of DRIVESCOPE_PYTHON, or python3 on the path. Machines that other people
/// recorded are rows of the table where DRIVESCOPE_DATA names a folder that holds them: `emps/`,
/// `hsm150/`, `odrive/`, `flexible_link/`.
#[derive(Debug, Args)]
pub(super) struct OfDiscovery {
    /// Cases to draw; 1000 hold more than 300 without a hidden effect. A tenth more hide laws that
    /// nobody programmed, for which formulas are sought.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    cases: usize,
    /// Folder for the cases as files: `case_0000` and so on, each with the drive file to start from,
    /// both recordings, and the truth in `truth.json`.
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
}

impl Run for OfDiscovery {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        if self.cases < FEWEST {
            return Err(Failure::Usage {
                what: format!("--cases {}: too few for a table", self.cases),
                instead: format!("give {FEWEST} or more"),
            }
            .into());
        }
        session.check_writable(&[])?;
        let fresh = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |it| it.as_secs());
        let seed = session.given_seed.unwrap_or_else(fresh);
        let all = self.cases + unprogrammed(self.cases);
        let bar = session.progress((all + timed(all)) as u64, "discovering");
        let advance = || bar.inc(1);
        let found = run(self.cases, seed, &python(), self.keep.as_deref(), &advance)?;
        bar.finish_and_clear();
        let table = Table::new(seed, found);
        session.say(&table.text(), &table, &Next::new("benchmark detection"))?;
        Ok(Ending::Done)
    }
}
