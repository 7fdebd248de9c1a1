//! `train`: healthy recordings, and labelled faulty ones, to a diagnoser file.

mod bank;
mod joined;
mod labelled;
mod models;
mod training;

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drivescope_recording::Recording;

use self::labelled::Labelled;
use self::models::Models;
use self::training::{ARL_0, BETA, RUN_UP_S, VERIFIED, WINDOW_S};
pub(crate) use self::training::{Material, Plan, Trained, interface, train};
use super::{RecordingOptions, Run, at_period};
use crate::answer::text;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::session::Session;
use crate::{drive_source, output};

/// Train a diagnoser on healthy recordings: models, bands and thresholds of one output signal; and, where
/// recordings of faults are given, a classifier that names them.
#[derive(Debug, Args)]
pub(crate) struct Train {
    /// Healthy recordings of the kind that will be watched, any number: on the first, third, ... the
    /// error models are fitted, on the others, which should be long, the bands are measured. A single
    /// one is halved.
    #[arg(required = true, value_name = "REC")]
    healthy: Vec<PathBuf>,
    /// The drive, where its equations are known: a drive file as `fit` or `discover` wrote it, or a
    /// built-in drive. The diagnoser then holds a bank of hypotheses over it, which names mechanism,
    /// size and onset without having been shown a fault.
    #[arg(long, value_name = "DRIVE")]
    drive: Option<String>,
    /// Mean number of samples between false alarms that the bank's limits are designed for.
    #[arg(
        long = "arl0",
        value_name = "N",
        default_value_t = ARL_0,
        requires = "drive",
        allow_negative_numbers = true
    )]
    arl_0: f64,
    /// Fresh healthy samples, simulated, that these limits are verified on.
    #[arg(long = "verify", value_name = "N", default_value_t = VERIFIED, requires = "drive")]
    verified: usize,
    /// Healthy recordings in which the input goes through its range (an open loop, say): on the
    /// first the process model is trained, on the second it is judged. A single one is divided;
    /// without any, the others serve.
    #[arg(long, num_args = 1..=2, value_name = "REC")]
    excited: Vec<PathBuf>,
    /// A recording of a fault, by a name of your own for it; several of one fault may be given, and
    /// two faults or more. What `diagnose` then sees declared is named after the fault it looks like.
    #[arg(long, value_name = "NAME=REC")]
    fault: Vec<Labelled>,
    /// Input signals of the model; by default C_m, or else u.
    #[arg(long, value_delimiter = ',', value_name = "NAME,..")]
    input: Vec<String>,
    /// The signal to watch; by default T, omega or v, whichever is there.
    #[arg(long, value_name = "NAME")]
    output_signal: Option<String>,
    /// Share of healthy samples outside the bands.
    #[arg(long, default_value_t = BETA, allow_negative_numbers = true)]
    beta: f64,
    /// Time for which every sample must lie outside before a fault is declared, s.
    #[arg(long, value_name = "S", default_value_t = WINDOW_S, allow_negative_numbers = true)]
    window: f64,
    /// Time at the start of every recording that only settles the models, s.
    #[arg(long, value_name = "S", default_value_t = RUN_UP_S, allow_negative_numbers = true)]
    run_up: f64,
    #[command(flatten)]
    models: Models,
    /// Leave out models that are not needed.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "MODEL,..")]
    without: Vec<Part>,
    /// Diagnoser file to write (TOML).
    #[arg(short, long, value_name = "DIAGNOSER")]
    output: PathBuf,
    #[command(flatten)]
    reading: RecordingOptions,
}

/// A model that a diagnoser can do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// The recurrent error model.
    Recurrent,
    /// The GMDH network.
    Gmdh,
}

impl Run for Train {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        session.check_writable(&[&self.output])?;
        let healthy = self.read(&self.healthy, session)?;
        let interface = interface(&healthy[0], &self.input, self.output_signal.as_deref())?;
        let period = interface.period_s;
        let at_one_rate = |recordings: Vec<Recording>| -> miette::Result<Vec<Recording>> {
            recordings.into_iter().map(|it| at_period(it, period, session)).collect()
        };
        let files: Vec<PathBuf> = self.fault.iter().map(|fault| fault.file.clone()).collect();
        let faulty = at_one_rate(self.read(&files, session)?)?;
        let material = Material {
            healthy: at_one_rate(healthy)?,
            excited: at_one_rate(self.read(&self.excited, session)?)?,
            faulty: self.fault.iter().map(|it| it.name.clone()).zip(faulty).collect(),
        };
        let drive = self.drive.as_deref().map(|given| {
            Ok::<_, miette::Report>((drive_source::text(given)?, drive_source::drive(given)?))
        });
        let plan = Plan {
            drive: drive.transpose()?,
            arl_0: self.arl_0,
            verified: self.verified,
            beta: self.beta,
            window_s: self.window,
            run_up_s: self.run_up,
            models: self.models,
            recurrent: !self.without.contains(&Part::Recurrent),
            gmdh: !self.without.contains(&Part::Gmdh),
        };
        let trained = train(&interface, material, &plan, session)?;
        let file = trained.learned.diagnoser.to_toml().map_err(into_report)?;
        output::write_file(&self.output, |out| out.write_all(file.as_bytes()))?;
        let answer = trained.answer(session.named(&self.output));
        let next = Next::new("diagnose").files([&self.output]).options(" REC --check");
        session.wrote(&text(&answer.blocks()), &answer, &next)?;
        Ok(Ending::Done)
    }
}

impl Train {
    fn read(&self, files: &[PathBuf], session: &Session) -> miette::Result<Vec<Recording>> {
        let read = |file: &PathBuf| -> miette::Result<Recording> {
            let (recording, report) = self.reading.read(file, session)?;
            let wanted = self.input.iter().chain(&self.output_signal).map(String::as_str);
            report.require(&recording, &wanted.collect::<Vec<_>>()).map_err(into_report)?;
            Ok(recording)
        };
        files.iter().map(read).collect()
    }
}
