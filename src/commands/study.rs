//! `study`: the whole experiment of the reference paper, through the exported FMU.
//!
//! Files of the folder: `study.json`, `report.html`; the FMUs `closed_loop_fmi2.fmu`,
//! `closed_loop_fmi3.fmu`, `open_loop_fmi2.fmu`; and for every fault, a healthy run and
//! one of stick-slip `runs/NAME.inputs.csv` and `runs/NAME.signals.csv`, from which any simulator
//! can repeat the run.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use drivescope_fmu::description::Version;
use drivescope_scenarios::faults::{Fault, SPAN};
use drivescope_scenarios::profile::Profile;
use drivescope_scenarios::results::{FaultName, Pictures, StudyResults};
use drivescope_scenarios::study::{Progress, Study as Outcome, StudyOptions, study};
use drivescope_scenarios::trials::{HIDDEN_STEPS, hidden_effect};
use indicatif::ProgressBar;
use serde::Serialize;

use super::Run;
use super::counts::all_positive;
use super::twelve::TwelveDetected;
use crate::answer::block::Block;
use crate::failure::{Ending, Failure, into_report};
use crate::next::Next;
use crate::report::study::study_html;
use crate::run_folder::RunFolder;
use crate::session::Session;
use crate::simulation::fault::{FaultError, FaultOverTime};
use crate::{answer, drive_source, fmu_file, interrupt, output};

/// Run the main job: twelve faults in parallel through the exported FMU, tables and a report.
#[derive(Debug, Args)]
pub(crate) struct Study {
    /// Folder for study.json, report.html, the FMUs and the runs.
    #[arg(long, value_name = "DIR", default_value = "study")]
    out: PathBuf,
    #[command(flatten)]
    twelve: TwelveDetected,
    /// How the judged faults go with time: step, ramp=SECONDS (incipient), pulses=ON/EVERY, or
    /// intermittent=ON/OFF. The classifiers are taught by steps.
    #[arg(long, default_value_t = Profile::Step)]
    profile: Profile,
    /// A run beside the twelve, with another kind of fault or several at once, joined by `+`, each
    /// with a profile of its own: `tacho_bias=3`, `tacho_freeze=1`, `tacho_noise=200%`,
    /// `tacho_bias=6:ramp=4` (a drift), `tacho=5%+load=20%`. May be given several times.
    #[arg(long, value_name = "KIND=SIZE[:PROFILE][+..]")]
    fault: Vec<Together>,
    /// An effect of the drive that its model is taken to have lacked: the report then shows the smallest
    /// detectable faults before it was added and after.
    #[arg(long, value_name = "EFFECT")]
    hidden: Option<String>,
    /// Machines of each point of those curves.
    #[arg(long, value_name = "N", default_value_t = 40, requires = "hidden")]
    hidden_machines: usize,
}

/// Faults that act together over the span of the study.
#[derive(Debug, Clone)]
struct Together {
    typed: String,
    faults: Vec<Fault>,
}

impl FromStr for Together {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        // A `+` before a letter joins faults; before a digit it is a sign.
        let mut parts = vec![String::new()];
        let mut rest = typed.chars().peekable();
        while let Some(c) = rest.next() {
            if c == '+' && rest.peek().is_some_and(|next| next.is_alphabetic()) {
                parts.push(String::new());
            } else if let Some(part) = parts.last_mut() {
                part.push(c);
            }
        }
        let fault = |part: &String| -> Result<Fault, String> {
            let FaultOverTime { mechanism, size, from_s, to_s, profile } =
                part.parse().map_err(|error: FaultError| error.to_string())?;
            if from_s != 0.0 || to_s.is_finite() {
                return Err(format!(
                    "`{part}`: faults of the study act over samples {} to {}: leave out `@`",
                    SPAN.start, SPAN.end
                ));
            }
            let (kind, label) = (mechanism.id.to_owned(), typed.to_owned());
            let name = FaultName { kind, size, label };
            Ok(Fault { name, from: SPAN.start, until: SPAN.end, profile })
        };
        let faults = parts.iter().map(fault).collect::<Result<_, _>>()?;
        Ok(Self { typed: typed.to_owned(), faults })
    }
}

impl Run for Study {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let machines = [("hidden-machines", self.hidden_machines as u64)];
        all_positive(&machines, "; 200 give smooth curves")?;
        let TwelveDetected { faults, beta } = self.twelve;
        let drive = drive_source::drive(&faults.drive)?;
        if let Some(effect) = &self.hidden
            && !drive.effects.iter().any(|it| it.kind == *effect)
        {
            let has: Vec<&str> = drive.effects.iter().map(|it| it.kind.as_str()).collect();
            return Err(Failure::Usage {
                what: format!("--hidden {effect}: {} has no such effect", faults.drive),
                instead: format!("name one that it has: {}", has.join(", ")),
            }
            .into());
        }
        let folder = RunFolder::take(&self.out)?;
        session.check_writable(&[])?;
        let at = |name: &str| folder.work().join(name);
        let closed = at("closed_loop_fmi2.fmu");
        let open = at("open_loop_fmi2.fmu");
        fmu_file::write(&drive, false, Version::Two, &closed)?;
        fmu_file::write(&drive, false, Version::Three, &at("closed_loop_fmi3.fmu"))?;
        fmu_file::write(&drive, true, Version::Two, &open)?;

        let model = self.hidden.as_ref().map(|_| drive.clone());
        let (torque, profile) = (faults.torque.into(), self.profile);
        let further = self.fault.into_iter().map(|it| (it.typed, it.faults)).collect();
        let options = StudyOptions { drive, seed: session.seed, torque, beta, profile, further };
        let bar = session.progress(1, "training and designing the diagnoser");
        let asked = interrupt::asked();
        let outcome = study(&options, (&closed, &open), &|step| {
            show(&bar, step);
            asked.check().is_err()
        });
        bar.finish_and_clear();
        interrupt::check()?;
        let mut outcome = outcome.map_err(into_report)?;
        if let Some((effect, drive)) = self.hidden.as_ref().zip(model) {
            let bar = session.progress(HIDDEN_STEPS, "smallest detectable faults");
            let found =
                hidden_effect(&drive, effect, (self.hidden_machines, session.seed), &|| {
                    bar.inc(1);
                    interrupt::check().is_err()
                });
            bar.finish_and_clear();
            interrupt::check()?;
            outcome.results.hidden_effect = Some(found.map_err(into_report)?);
        }

        let blocks = answer::study::blocks(&outcome.results, &outcome.pictures);
        write(&outcome, &blocks, folder.work())?;
        folder.finish()?;
        session.remark(format_args!("report: {}", self.out.join("report.html").display()));
        let next = Next::new("benchmark detection");
        session.wrote(&answer::text(&blocks), &outcome.results, &next)?;
        Ok(Ending::Done)
    }
}

/// What study.json holds.
#[derive(Debug, Serialize)]
struct WithTraces<'a> {
    #[serde(flatten)]
    results: &'a StudyResults,
    /// Traces of the healthy run and of the twelve faults.
    traces: &'a [Pictures],
}

/// Writes results, report and runs.
fn write(outcome: &Outcome, blocks: &[Block], folder: &Path) -> miette::Result<()> {
    let text = |name: &str, text: &str| {
        output::write_file(&folder.join(name), |out| out.write_all(text.as_bytes()))
    };
    let runs = folder.join("runs");
    let unwritable = |source| Failure::Write { path: runs.clone(), source };
    std::fs::create_dir_all(&runs).map_err(unwritable)?;
    for run in &outcome.runs {
        let path = |kind: &str| runs.join(format!("{}.{kind}.csv", run.name));
        output::write_recording(&path("inputs"), &run.inputs)?;
        output::write_recording(&path("signals"), &run.signals)?;
    }
    text("report.html", &study_html(&outcome.results, blocks))?;
    let whole = WithTraces { results: &outcome.results, traces: &outcome.pictures };
    text("study.json", &output::json(&whole)?)?;
    Ok(())
}

/// Shows where the study is.
fn show(bar: &ProgressBar, step: Progress) {
    match step {
        Progress::Training => bar.set_message("training and designing the diagnoser"),
        Progress::Judging(runs) => {
            bar.set_length(runs as u64);
            bar.set_message("judging faulty and healthy runs");
        }
        Progress::Judged => bar.inc(1),
        Progress::Isolation => bar.set_message("training classifiers"),
    }
}
