//! `benchmark detection`: the paper's detection figures over many draws of the noise, and delays of all
//! detectors at equal mean times between false alarms over many machines.

mod curves;

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use clap::Args;
use drivescope_fmu::description::Version;
use drivescope_fmu::import::Fmu;
use drivescope_scenarios::experiment::Experiment;
use drivescope_scenarios::parity::{Broken, FaultRow, IN_TIME, MethodRows, Parity, Share, parity};
use drivescope_scenarios::results::{DetectorKind, TorqueReading};
use drivescope_scenarios::study::design;
use drivescope_scenarios::trials::{Curves, TrialOptions, detector_steps, detectors};
use serde::Serialize;

use super::bar::{Bar, share};
use crate::commands::Run;
use crate::commands::counts::all_positive;
use crate::commands::twelve::TwelveDetected;
use crate::failure::{Ending, Failure, into_report};
use crate::next::Next;
use crate::report::words::{fault, percent, torque};
use crate::session::Session;
use crate::{drive_source, fmu_file, interrupt};

/// Detection of the twelve faults over many seeds of the noise, with intervals, and the same
/// figures of two detectors that are broken on purpose; then delays of all detectors, the bank among
/// them, at equal mean times between false alarms on machines drawn anew.
#[derive(Debug, Args)]
pub(super) struct OfDetection {
    /// Seeds to judge; training and design have another one.
    #[arg(long, value_name = "N", default_value_t = 200)]
    seeds: u64,
    /// Designs of the diagnoser, each with a seed of its own, that every seed is judged with.
    #[arg(long, value_name = "N", default_value_t = 1)]
    designs: u64,
    /// Machines that delays are measured on; 0 leaves them out.
    #[arg(long, value_name = "N", default_value_t = 200)]
    machines: usize,
    /// Healthy samples that false alarms are counted on, for each detector.
    #[arg(long, value_name = "N", default_value_t = 4_000_000)]
    healthy: usize,
    /// Folder for the recordings that delays are measured on, some 60 MB of CSV, for detectors of other
    /// people (tools/other_detectors.py).
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    #[command(flatten)]
    twelve: TwelveDetected,
}

/// What the figures must reach (flux reading).
const LEAST_DETECTED: f64 = 0.99;
const LEAST_R_TD: f64 = 0.98;
const LEAST_IN_TIME: f64 = 0.95;
const MOST_OFF_BETA: f64 = 0.005;

#[derive(Debug, Serialize)]
struct DetectionBenchmark<'a> {
    #[serde(flatten)]
    parity: &'a Parity,
    /// The same with further designs.
    further: &'a [Parity],
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<&'a Curves>,
    bars: Vec<Bar>,
}

impl Run for OfDetection {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let counts = [("seeds", self.seeds), ("designs", self.designs)];
        all_positive(&counts, "; 200 seeds give intervals worth printing")?;
        session.check_writable(&[])?;
        let TwelveDetected { faults, beta } = self.twelve;
        let drive = drive_source::drive(&faults.drive)?;
        if let Some(path) = &self.keep {
            let unwritable = |source| Failure::Write { path: path.clone(), source };
            fs::create_dir_all(path).map_err(unwritable)?;
        }
        let folder = tempfile::tempdir()
            .map_err(|source| Failure::Write { path: std::env::temp_dir(), source })?;
        let (closed, open) = (folder.path().join("closed.fmu"), folder.path().join("open.fmu"));
        fmu_file::write(&drive, false, Version::Two, &closed)?;
        fmu_file::write(&drive, true, Version::Two, &open)?;
        let (closed, open) =
            (Fmu::open(&closed).map_err(into_report)?, Fmu::open(&open).map_err(into_report)?);
        let steps = if self.machines == 0 { 0 } else { detector_steps() };
        let all = self.designs * self.seeds + steps;
        let bar = session.progress(all, "designing, then judging seeds");
        let torque: TorqueReading = faults.torque.into();
        let (mut found, mut first) = (Vec::new(), None);
        for k in 0..self.designs {
            let seed = session.seed.wrapping_add(k * (self.seeds + 1));
            let experiment = Experiment::new(drive.clone(), seed).map_err(into_report)?;
            let designed = design(&experiment, (&closed, &open), beta).map_err(into_report)?;
            let parity = parity(&designed, &experiment, torque, self.seeds, &|| bar.inc(1));
            interrupt::check()?;
            found.push(parity.map_err(into_report)?);
            first.get_or_insert(designed);
        }
        let mut curves = None;
        if let Some(designed) = first.filter(|_| steps > 0) {
            let Self { machines, healthy, .. } = self;
            let options = TrialOptions { machines, healthy, arl_0: 1e6, seed: session.seed };
            let of_all = detectors(drive, &designed, &options, self.keep.as_deref(), &|| {
                bar.inc(1);
                interrupt::check().is_err()
            });
            interrupt::check()?;
            curves = Some(of_all.map_err(into_report)?);
        }
        bar.finish_and_clear();
        let Some((parity, further)) = found.split_first() else { return Ok(Ending::Done) };
        let mut bars = bars(&found);
        bars.extend(curves.iter().flat_map(curves::bars));
        let mut text: String = found.iter().map(text).collect();
        text.extend(curves.as_ref().map(curves::text));
        text.push('\n');
        text.extend(bars.iter().map(Bar::line));
        let next = Next::new("benchmark isolation");
        session.say(
            &text,
            &DetectionBenchmark { parity, further, curves: curves.as_ref(), bars },
            &next,
        )?;
        Ok(Ending::Done)
    }
}

fn bars(found: &[Parity]) -> Vec<Bar> {
    let mut bars = Vec::new();
    for method in DetectorKind::ALL {
        let of = found.iter().flat_map(|parity| &parity.methods);
        let of = of.filter(|rows| rows.method == method).map(|rows| &rows.all_detected);
        let all = Share::pooled(of).share;
        let what = format!("{}: share of seeds with all twelve faults detected", method.label());
        bars.push(Bar::at_least(what, all, LEAST_DETECTED));
    }
    bars.extend(found.iter().flat_map(of_mem));
    bars
}

fn of_mem(found: &Parity) -> Vec<Bar> {
    let Some(mem) = found.methods.iter().find(|rows| rows.method == DetectorKind::Mem) else {
        return Vec::new();
    };
    let least = |value: &dyn Fn(&FaultRow) -> f64| {
        mem.faults.iter().map(value).fold(f64::INFINITY, f64::min)
    };
    let off = (mem.r_fd.mean - found.beta).abs();
    vec![
        Bar::at_least("mean r_td of the worst fault", least(&|row| row.r_td.mean), LEAST_R_TD),
        Bar::at_least(
            format!("share of seeds with t_dt <= {IN_TIME}, worst fault"),
            least(&|row| row.in_time.share),
            LEAST_IN_TIME,
        ),
        Bar::at_most("mean r_fd off beta", off, MOST_OFF_BETA),
    ]
}

fn text(found: &Parity) -> String {
    let mut text = format!(
        "{} seeds from {}, trained and designed with seed {}; torque fault read as {}; beta = {}\n\
         widths measured on {} healthy samples, judged on {}; intervals: 95 %, Wilson\n",
        found.seeds,
        found.first_seed,
        found.design_seed,
        torque(found.torque),
        found.beta,
        found.design_samples,
        found.healthy_samples
    );
    for MethodRows { method, all_detected, r_fd, silent, faults } in &found.methods {
        let [low, high] = r_fd.range;
        let _ = write!(
            text,
            "\n{}: all twelve detected {}\n  r_fd {} %, 5 to 95 % of seeds: {} to {} %; no false \
             alarm in {}\n",
            method.label(),
            share(all_detected),
            percent(r_fd.mean, 2),
            percent(low, 2),
            percent(high, 2),
            share(silent)
        );
        for row in faults {
            let _ = writeln!(
                text,
                "  {:<22} detected {:<24} r_td {:>5} % (least {:>5})  t_dt {:.0} (95 %: {:.0}), \
                 <= {IN_TIME}: {}",
                fault(&row.fault),
                share(&row.detected),
                percent(row.r_td.mean, 1),
                percent(row.r_td.least, 1),
                row.t_dt.mean,
                row.t_dt.range[1],
                share(&row.in_time)
            );
        }
    }
    let Broken { always_r_td, always_r_fd, always_detected, shuffled_r_td, shuffled_detected } =
        &found.broken;
    let _ = write!(
        text,
        "\nbroken on purpose: always alarming: r_td {} %, r_fd {} %, detected {}\n\
         labels shuffled (health called a fault): r_td {} %, detected {}\n",
        percent(*always_r_td, 1),
        percent(*always_r_fd, 1),
        share(always_detected),
        percent(*shuffled_r_td, 1),
        share(shuffled_detected)
    );
    text
}
