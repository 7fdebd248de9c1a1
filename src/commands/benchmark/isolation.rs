//! `benchmark isolation`: the paper's classifiers over many designs, draws and machines, beside the
//! bank.

use std::fmt::Write;

use clap::Args;
use drivescope_fmu::description::Version;
use drivescope_fmu::import::Fmu;
use drivescope_scenarios::experiment::Experiment;
use drivescope_scenarios::parity::Spread;
use drivescope_scenarios::study::design;
use drivescope_scenarios::trials::{
    ClassTable, ClassifierRow, IsolationOptions, IsolationTrials, isolation,
};
use serde::Serialize;

use super::bar::{Bar, share};
use crate::commands::Run;
use crate::commands::counts::all_positive;
use crate::commands::twelve::TwelveFaults;
use crate::failure::{Ending, Failure, into_report};
use crate::next::Next;
use crate::report::words::{fault, percent};
use crate::session::Session;
use crate::{drive_source, fmu_file, interrupt};

/// Isolation of the twelve faults: the paper's perceptron beside a quadratic discriminant, for several
/// designs over many draws of the noise, then on machines drawn anew (standard deviations: resistance
/// 3 %, friction 10 %) beside the bank of hypotheses; with intervals, and shuffled labels.
#[derive(Debug, Args)]
pub(super) struct OfIsolation {
    /// Designs, each with a seed of its own.
    #[arg(long, value_name = "N", default_value_t = 5)]
    designs: u64,
    /// Draws of the noise that each design is judged on.
    #[arg(long, value_name = "N", default_value_t = 200)]
    seeds: u64,
    /// Machines drawn anew.
    #[arg(long, value_name = "N", default_value_t = 200)]
    machines: usize,
    #[command(flatten)]
    faults: TwelveFaults,
}

/// Significance level of the designs; isolation does not depend on it but for what is unknown.
const BETA: f64 = 0.05;
/// What the bank must reach.
const LEAST_TWELVE: f64 = 0.999;
const LEAST_WORST: f64 = 0.995;

#[derive(Debug, Serialize)]
struct Found<'a> {
    #[serde(flatten)]
    trials: &'a IsolationTrials,
    bars: Vec<Bar>,
}

impl Run for OfIsolation {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let Self { designs, seeds, machines, .. } = self;
        let counts = [("designs", designs), ("seeds", seeds), ("machines", machines as u64)];
        all_positive(&counts, " of each; 5, 200 and 200 give intervals worth printing")?;
        session.check_writable(&[])?;
        let drive = drive_source::drive(&self.faults.drive)?;
        let folder = tempfile::tempdir()
            .map_err(|source| Failure::Write { path: std::env::temp_dir(), source })?;
        let (closed, open) = (folder.path().join("closed.fmu"), folder.path().join("open.fmu"));
        fmu_file::write(&drive, false, Version::Two, &closed)?;
        fmu_file::write(&drive, true, Version::Two, &open)?;
        let (closed, open) =
            (Fmu::open(&closed).map_err(into_report)?, Fmu::open(&open).map_err(into_report)?);
        let bar = session.progress(2 * designs + 2, "designing, then judging");
        let mut made = Vec::new();
        for k in 0..designs {
            let seed = session.seed.wrapping_add(k);
            let experiment = Experiment::new(drive.clone(), seed).map_err(into_report)?;
            let designed = design(&experiment, (&closed, &open), BETA).map_err(into_report)?;
            made.push((experiment, designed));
            bar.inc(1);
            interrupt::check()?;
        }
        let torque = self.faults.torque.into();
        let options = IsolationOptions { draws: seeds, machines, torque, seed: session.seed };
        let found = isolation(&drive, &made, &options, &|| {
            bar.inc(1);
            interrupt::check().is_err()
        });
        bar.finish_and_clear();
        interrupt::check()?;
        let found = found.map_err(into_report)?;
        let bars = bars(&found);
        let next = Next::new("benchmark bank");
        session.say(&text(&found, &bars), &Found { trials: &found, bars }, &next)?;
        Ok(Ending::Done)
    }
}

fn bars(found: &IsolationTrials) -> Vec<Bar> {
    let bank = &found.bank.with_current;
    let what = "the bank, twelve faults in one window";
    let mut bars = vec![Bar::at_least(what, bank.among_twelve.share, LEAST_TWELVE)];
    if let Some((_, worst)) = bank.worst(|row| row.among_twelve) {
        bars.push(Bar::at_least(format!("{what}, the worst of them"), worst.share, LEAST_WORST));
    }
    bars
}

fn row(text: &mut String, row: &ClassifierRow) {
    let interval = |of: &Spread| {
        let [low, high] = of.interval;
        format!("{:>5} % [{}, {}]", percent(of.mean, 1), percent(low, 1), percent(high, 1))
    };
    let [low, high] = row.samples.range;
    let _ = writeln!(
        text,
        "  {:<13} {:<7} samples {} ({} to {} %), worst fault {} {}; runs by majority {}; \
         next fault {}",
        row.classifier,
        row.classes,
        interval(&row.samples),
        percent(low, 1),
        percent(high, 1),
        fault(&row.worst_fault),
        interval(&row.worst),
        share(&row.runs),
        share(&row.shuffled)
    );
}

fn text(found: &IsolationTrials, bars: &[Bar]) -> String {
    let mut text = format!(
        "symptoms (C_m, r) as in the paper; {} starts of each perceptron; {} draws of the noise for each \
         design, 5 to 95 % of the draws in round brackets; intervals: 95 %, of means from the scatter of the draws, of \
         counts Wilson\n",
        found.starts, found.draws
    );
    for design in &found.designs {
        let _ = writeln!(text, "design of seed {}", design.seed);
        design.classifiers.iter().for_each(|it| row(&mut text, it));
    }
    for (classifier, classes) in [
        ("perceptron", "paper"),
        ("discriminant", "paper"),
        ("perceptron", "twelve"),
        ("discriminant", "twelve"),
    ] {
        let of = found.designs.iter().flat_map(|design| &design.classifiers);
        let of = of.filter(|it| it.classifier == classifier && it.classes == classes);
        let worst = of.map(|it| it.worst.mean).collect::<Vec<f64>>();
        let least = worst.iter().copied().fold(f64::INFINITY, f64::min);
        let most = worst.iter().copied().fold(0.0, f64::max);
        let _ = writeln!(
            text,
            "worst fault over the designs, {classifier}, {classes}: {} to {} %",
            percent(least, 1),
            percent(most, 1)
        );
    }
    let _ = writeln!(text, "{} machines drawn anew", found.machines);
    found.on_machines.iter().for_each(|it| row(&mut text, it));
    let bank = |signals: &str, table: &ClassTable| {
        format!(
            "  bank with {signals}, 0.5 s: among the twelve {}, of all mechanisms {}; next fault {}\n",
            share(&table.among_twelve),
            share(&table.named),
            share(&table.shuffled)
        )
    };
    text += &bank("C_m, T, I_m", &found.bank.with_current);
    text += &bank("C_m, T", &found.bank.without_current);
    text.extend(bars.iter().map(Bar::line));
    text
}
