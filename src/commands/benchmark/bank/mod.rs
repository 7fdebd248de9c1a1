//! `benchmark bank`: the bank of hypotheses on machines that it has never seen.

mod bars;
mod text;

use clap::Args;
use drivescope_scenarios::drives::built_in;
use drivescope_scenarios::trials::{STEPS, TrialOptions, Trials, trials};
use serde::Serialize;

use super::bar::Bar;
use crate::commands::Run;
use crate::commands::counts::all_positive;
use crate::failure::{Ending, Failure, into_report};
use crate::interrupt;
use crate::next::Next;
use crate::session::Session;

/// Fewest machines of a row.
const FEWEST: usize = 4;
/// Fewest healthy samples.
const FEWEST_HEALTHY: usize = 80_000;

/// Names, sizes, delays and false alarms of the bank over machines drawn anew, each with noise of its
/// own (standard deviations over machines: resistance 3 %, friction 10 %), with intervals; beside a
/// detector that knows machine and mechanism, and figures that must collapse.
#[derive(Debug, Args)]
pub(super) struct OfBank {
    /// Designs of the bank, each on healthy runs of two other machines.
    #[arg(long, value_name = "N", default_value_t = 4)]
    designs: u64,
    /// Machines of each row, under each design.
    #[arg(long, value_name = "N", default_value_t = 100)]
    machines: usize,
    /// Healthy samples on which false alarms are counted, under each design.
    #[arg(long, value_name = "N", default_value_t = 4_000_000)]
    healthy: usize,
    /// Mean samples between false alarms that the bank is designed for.
    #[arg(long = "arl0", value_name = "N", default_value_t = 1e6)]
    arl_0: f64,
}

#[derive(Debug, Serialize)]
struct BankBenchmark<'a> {
    #[serde(flatten)]
    trials: &'a Trials,
    /// The same with further designs.
    further: &'a [Trials],
    bars: Vec<Bar>,
}

impl Run for OfBank {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let Self { designs, machines, healthy, arl_0 } = self;
        all_positive(&[("designs", designs)], "; 4 tell how much one design differs from another")?;
        let refused = |what: String, instead: String| Failure::Usage { what, instead };
        if machines < FEWEST {
            let what = format!("--machines {machines}: too few for a table");
            return Err(refused(what, format!("give {FEWEST} or more")).into());
        }
        if healthy < FEWEST_HEALTHY {
            let what = format!("--healthy {healthy}: too few samples for a table");
            return Err(refused(what, format!("give {FEWEST_HEALTHY} or more")).into());
        }
        if !(arl_0.is_finite() && arl_0 >= 1e3) {
            let what = format!("--arl0 {arl_0}: not a mean number of samples between false alarms");
            return Err(refused(what, "give 1000 or more; 1e6 is usual".to_owned()).into());
        }
        session.check_writable(&[])?;
        let drive = built_in("dr300").transpose().map_err(into_report)?.ok_or_else(|| {
            refused("there is no drive dr300".to_owned(), "it is built in".to_owned())
        })?;
        let bar = session.progress(designs * STEPS, "trying the bank");
        let mut found = Vec::new();
        for k in 0..designs {
            // The seed after a design's is that of the machines it is judged on.
            let seed = session.seed.wrapping_add(2 * k);
            let options = TrialOptions { machines, healthy, arl_0, seed };
            let one = trials(drive.clone(), &options, &|| {
                bar.inc(1);
                interrupt::check().is_err()
            });
            interrupt::check()?;
            found.push(one.map_err(into_report)?);
        }
        bar.finish_and_clear();
        let bars = bars::bars(&found);
        let text = text::text(&found, &bars);
        let next = Next::new("benchmark detection");
        let Some((trials, further)) = found.split_first() else { return Ok(Ending::Done) };
        session.say(&text, &BankBenchmark { trials, further, bars }, &next)?;
        Ok(Ending::Done)
    }
}
