//! `benchmark`: published figures, measured again.

mod bank;
mod bar;
mod detection;
mod discovery;
mod isolation;
mod rule;
mod speed;

use clap::{Args, Subcommand};

use super::Run;
use crate::failure::Ending;
use crate::session::Session;

/// Measure the published tables, with confidence intervals.
#[derive(Debug, Args)]
pub(crate) struct Benchmark {
    #[command(subcommand)]
    table: TableOf,
}

#[derive(Debug, Subcommand)]
enum TableOf {
    Discovery(discovery::OfDiscovery),
    Detection(detection::OfDetection),
    Isolation(isolation::OfIsolation),
    Bank(bank::OfBank),
    Rule(rule::OfRule),
    Speed(speed::OfSpeed),
}

impl Run for Benchmark {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        match self.table {
            TableOf::Discovery(discovery) => discovery.run(session),
            TableOf::Detection(detection) => detection.run(session),
            TableOf::Isolation(isolation) => isolation.run(session),
            TableOf::Bank(bank) => bank.run(session),
            TableOf::Rule(rule) => rule.run(session),
            TableOf::Speed(speed) => speed.run(session),
        }
    }
}
