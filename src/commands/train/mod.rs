//! `train`: healthy recordings, and labelled faulty ones, to a diagnoser file.

mod answer;
mod bank;
mod joined;
mod labelled;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drivescope_diagnoser::{
    Channel, Confidence, Data, Design, Diagnoser, FaultyRun, Interface, IsolatorOptions, Recipe,
    Sets,
};
use drivescope_recording::Recording;

use self::answer::Answer;
use self::labelled::Labelled;
use super::{RecordingOptions, Run, at_period};
use crate::failure::{Ending, Failure, told};
use crate::interrupt;
use crate::next::Next;
use crate::session::Session;

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
        default_value_t = 1e6,
        requires = "drive",
        allow_negative_numbers = true
    )]
    arl_0: f64,
    /// Fresh healthy samples, simulated, that these limits are verified on.
    #[arg(long = "verify", value_name = "N", default_value_t = 3_000_000, requires = "drive")]
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
    #[arg(long, default_value_t = 0.05, allow_negative_numbers = true)]
    beta: f64,
    /// Time for which every sample must lie outside before a fault is declared, s.
    #[arg(long, value_name = "S", default_value_t = 0.25, allow_negative_numbers = true)]
    window: f64,
    /// Time at the start of every recording that only settles the models, s.
    #[arg(long, value_name = "S", default_value_t = 2.5, allow_negative_numbers = true)]
    run_up: f64,
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

/// Inputs and outputs to look for where none are named.
const USUAL_INPUTS: [&str; 2] = ["C_m", "u"];
const USUAL_OUTPUTS: [&str; 3] = ["T", "omega", "v"];

impl Run for Train {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        session.check_writable(&[&self.output])?;
        let healthy = self.read(&self.healthy, session)?;
        let interface = self.interface(&healthy[0])?;
        let period = interface.period_s;
        let at_one_rate = |recordings: Vec<Recording>| -> miette::Result<Vec<Recording>> {
            recordings.into_iter().map(|it| at_period(it, period, session)).collect()
        };
        let healthy = at_one_rate(healthy)?;
        let excited = at_one_rate(self.read(&self.excited, session)?)?;
        let files: Vec<PathBuf> = self.fault.iter().map(|fault| fault.file.clone()).collect();
        let faulty = at_one_rate(self.read(&files, session)?)?;
        let samples = |name: &str, seconds: f64, least: usize| -> miette::Result<usize> {
            // Written so that NaN is refused.
            if !(0.0..=1e6).contains(&seconds) {
                return Err(Failure::Usage {
                    what: format!("--{name} {seconds}: not a time"),
                    instead: "give seconds, 0 or more".to_owned(),
                }
                .into());
            }
            Ok(((seconds / period).round() as usize).max(least))
        };
        let run_up = samples("run-up", self.run_up, 0)?;
        let window = samples("window", self.window, 1)?;
        let data = |recording| interface.select(recording).map_err(told);
        let bank = self.drive.as_deref().map(|drive| {
            let spinner = session.spinner();
            let designed = bank::design(drive, &healthy, (self.arl_0, self.verified, session.seed));
            spinner.finish_and_clear();
            designed
        });
        let bank = bank.transpose()?;
        // Each by itself first: what is wrong is said of the file that it is in.
        healthy.iter().try_for_each(|recording| data(recording).map(|_| ()))?;
        let two = if healthy.len() > 2 { joined::alternating(&healthy) } else { Vec::new() };
        let healthy = if two.is_empty() { &healthy } else { &two };
        let healthy: Vec<Data> = healthy.iter().map(data).collect::<Result<_, _>>()?;
        let excited: Vec<Data> = excited.iter().map(data).collect::<Result<_, _>>()?;
        let faulty = self.fault.iter().zip(&faulty).map(|(Labelled { name, .. }, recording)| {
            Ok(FaultyRun { fault: name, recording: &recording.name, data: data(recording)? })
        });
        let faulty: Vec<FaultyRun> = faulty.collect::<miette::Result<_>>()?;
        let Some(healthy) = pair(&healthy, (1, 2)) else {
            return Err(Failure::Usage {
                what: "no healthy recording".to_owned(),
                instead: "name one or two".to_owned(),
            }
            .into());
        };
        let excited = pair(&excited, (2, 3)).unwrap_or_else(|| {
            session.remark(
                "no excited recording was given (--excited): the models know what the healthy runs \
                 go through, and are guesses beyond it",
            );
            healthy.clone()
        });
        let confidence = Confidence::new(self.beta).map_err(told)?;
        let design = Design { run_up, window, ..Design::paper(confidence) };
        let mut recipe = Recipe::paper(interface.inputs.len(), design, session.seed);
        if self.without.contains(&Part::Recurrent) {
            recipe.recurrent_error = None;
        }
        if self.without.contains(&Part::Gmdh) {
            recipe.gmdh = None;
        }
        let spinner = session.spinner();
        let learned = Diagnoser::learn(interface.clone(), &Sets { excited, healthy }, &recipe);
        spinner.finish_and_clear();
        interrupt::check()?;
        let mut learned = learned.map_err(told)?;
        let mut faults = None;
        if !faulty.is_empty() {
            let options = IsolatorOptions { seed: session.seed, ..IsolatorOptions::default() };
            let found = learned.diagnoser.clone().with_faults(&faulty, &options);
            let (diagnoser, report) = found.map_err(told)?;
            (learned.diagnoser, faults) = (diagnoser, Some(report));
        }
        let bank = bank.map(|(design, answer)| {
            learned.diagnoser.bank = Some(design);
            answer
        });
        {
            let _not_now = interrupt::writing();
            learned.diagnoser.save(&self.output).map_err(told)?;
        }
        let answer = Answer::new(&self.output, &learned, faults.as_ref(), bank);
        let next = Next::new("diagnose").files([&self.output]).options(" REC --check");
        session.wrote(&answer.text(), &answer, &next)?;
        Ok(Ending::Done)
    }
}

impl Train {
    fn read(&self, files: &[PathBuf], session: &Session) -> miette::Result<Vec<Recording>> {
        let read = |file: &PathBuf| -> miette::Result<Recording> {
            let (recording, report) = self.reading.read(file, session)?;
            let wanted = self.input.iter().chain(&self.output_signal).map(String::as_str);
            report.require(&recording, &wanted.collect::<Vec<_>>()).map_err(told)?;
            Ok(recording)
        };
        files.iter().map(read).collect()
    }

    /// The signals that were named, or the usual ones.
    fn interface(&self, recording: &Recording) -> miette::Result<Interface> {
        let named = |name: &str| {
            let signal = recording.signal(name)?;
            Some(Channel::new(name, signal.unit.clone()))
        };
        let missing = |what: &str, option: &str| {
            let known: Vec<&str> = recording.signals.iter().map(|s| s.name.as_str()).collect();
            Failure::Usage {
                what: format!("{}: no {what} signal is known by its name", recording.name),
                instead: format!("name it with --{option}; there are {}", known.join(", ")),
            }
        };
        let output = match &self.output_signal {
            Some(name) => named(name),
            None => USUAL_OUTPUTS.into_iter().find_map(named),
        };
        let inputs: Vec<Channel> = match self.input.is_empty() {
            true => USUAL_INPUTS.into_iter().find_map(named).into_iter().collect(),
            false => self.input.iter().filter_map(|name| named(name)).collect(),
        };
        if inputs.is_empty() {
            return Err(missing("input", "input").into());
        }
        let output = output.ok_or_else(|| missing("output", "output-signal"))?;
        if inputs.contains(&output) {
            return Err(Failure::Usage {
                what: format!("`{}` is both input and output", output.name),
                instead: "watch a signal that is no input".to_owned(),
            }
            .into());
        }
        Ok(Interface { period_s: recording.period_s, inputs, output })
    }
}

/// Two data sets: those given, or `parts.0` of `parts.1` parts of a single one and the rest.
fn pair<'a>(data: &[Data<'a>], parts: (usize, usize)) -> Option<[Data<'a>; 2]> {
    match data {
        [] => None,
        [single] => {
            let cut = single.len() * parts.0 / parts.1;
            Some([single.span(0..cut), single.span(cut..single.len())])
        }
        [first, second, ..] => Some([first.clone(), second.clone()]),
    }
}
