//! A training, wherever it was asked for.

use std::path::PathBuf;
use std::sync::Arc;

use drivescope_diagnoser::{
    Channel, Confidence, Data, Design, Diagnoser, FaultsReport, FaultyRun, Gmdh, Interface,
    IsolatorOptions, Learned, Selection, Sets, free_run,
};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use super::models::Models;
use super::{bank, joined};
use crate::answer::block::Block;
use crate::answer::train::{BankAnswer, TrainAnswer};
use crate::failure::{Failure, into_report};
use crate::interrupt;
use crate::session::Session;

/// What is designed for where nothing is said.
pub(super) const ARL_0: f64 = 1e6;
pub(super) const VERIFIED: usize = 3_000_000;
pub(super) const BETA: f64 = 0.05;
pub(super) const WINDOW_S: f64 = 0.25;
pub(super) const RUN_UP_S: f64 = 2.5;

/// Inputs and outputs to look for where none are named.
const USUAL_INPUTS: [&str; 2] = ["C_m", "u"];
const USUAL_OUTPUTS: [&str; 3] = ["T", "omega", "v"];

/// How a diagnoser is trained, but for the recordings.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    /// The drive as its text and what it describes, where its equations are known.
    pub(crate) drive: Option<(String, Drive)>,
    /// Mean number of samples between false alarms that the bank is designed for, and fresh samples
    /// that this is verified on.
    pub(crate) arl_0: f64,
    pub(crate) verified: usize,
    /// Share of healthy samples outside the bands.
    pub(crate) beta: f64,
    /// Time after which a fault is declared, s.
    pub(crate) window_s: f64,
    /// Time that only settles the models, s.
    pub(crate) run_up_s: f64,
    /// Sizes, orders and searches.
    pub(crate) models: Models,
    /// Whether there is a recurrent error model and a GMDH network.
    pub(crate) recurrent: bool,
    pub(crate) gmdh: bool,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            drive: None,
            arl_0: ARL_0,
            verified: VERIFIED,
            beta: BETA,
            window_s: WINDOW_S,
            run_up_s: RUN_UP_S,
            models: Models::default(),
            recurrent: true,
            gmdh: true,
        }
    }
}

/// What a training came to.
#[derive(Debug)]
pub(crate) struct Trained {
    pub(crate) learned: Learned,
    faults: Option<FaultsReport>,
    bank: Option<BankAnswer>,
    compared: Option<Selection>,
    /// Greatest difference of the GMDH network from its locally recurrent form on a healthy recording.
    recurrent_difference: Option<f64>,
}

impl Trained {
    /// The answer in blocks.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        self.answer(None).blocks()
    }

    /// As an answer of the command.
    pub(super) fn answer(&self, output: Option<PathBuf>) -> TrainAnswer {
        let found = (self.faults.as_ref(), self.bank.as_ref());
        let models = (self.compared.as_ref(), self.recurrent_difference);
        TrainAnswer::new(output, &self.learned, found, models)
    }
}

/// Recordings at one sampling time.
#[derive(Debug, Default)]
pub(crate) struct Material {
    pub(crate) healthy: Vec<Recording>,
    /// Healthy ones in which the input goes through its range.
    pub(crate) excited: Vec<Recording>,
    /// Those of faults, by their names.
    pub(crate) faulty: Vec<(String, Recording)>,
}

/// Trains a diagnoser of that interface.
///
/// # Errors
/// Recordings or a drive that do not serve.
pub(crate) fn train(
    interface: &Interface,
    Material { healthy, excited, faulty }: Material,
    plan: &Plan,
    session: &Session,
) -> miette::Result<Trained> {
    let samples = |name: &str, seconds: f64, least: usize| -> miette::Result<usize> {
        // Written so that NaN is refused.
        if !(0.0..=1e6).contains(&seconds) {
            return Err(Failure::Usage {
                what: format!("--{name} {seconds}: not a time"),
                instead: "give seconds, 0 or more".to_owned(),
            }
            .into());
        }
        Ok(((seconds / interface.period_s).round() as usize).max(least))
    };
    let run_up = samples("run-up", plan.run_up_s, 0)?;
    let window = samples("window", plan.window_s, 1)?;
    let data = |recording| interface.select(recording).map_err(into_report);
    let bank = plan.drive.as_ref().map(|drive| {
        let spinner = session.spinner();
        let designed = bank::design(drive, &healthy, (plan.arl_0, plan.verified, session.seed));
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
    let faulty = faulty.iter().map(|(name, recording)| {
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
    let confidence = Confidence::new(plan.beta).map_err(into_report)?;
    let design = Design { run_up, window, ..Design::steady(confidence) };
    let spinner = session.spinner();
    let parts = (plan.recurrent, plan.gmdh);
    let sets = Sets { excited, healthy };
    let recipe = plan.models.recipe((design, session.seed), &sets, parts);
    let (recipe, compared) = recipe.inspect_err(|_| spinner.finish_and_clear())?;
    let learned = match plan.models.process(compared.as_ref()) {
        Some(process) => Diagnoser::learn_around(interface.clone(), process, &sets, &recipe),
        None => Diagnoser::learn(interface.clone(), &sets, &recipe),
    };
    spinner.finish_and_clear();
    interrupt::check()?;
    let mut learned = learned.map_err(into_report)?;
    let mut faults = None;
    if !faulty.is_empty() {
        let options = IsolatorOptions { seed: session.seed, ..IsolatorOptions::default() };
        let found = learned.diagnoser.clone().with_faults(&faulty, &options);
        let (diagnoser, report) = found.map_err(into_report)?;
        (learned.diagnoser, faults) = (diagnoser, Some(report));
    }
    let bank = bank.map(|(design, answer)| {
        learned.diagnoser.bank = Some(design);
        answer
    });
    let network = learned.diagnoser.gmdh.as_ref().map(|robust| &robust.network);
    let recurrent_difference =
        network.and_then(|network| recurrent_difference(network, &sets.healthy[1]));
    Ok(Trained { learned, faults, bank, compared, recurrent_difference })
}

/// The signals that were named, or the usual ones.
///
/// # Errors
/// A recording without them.
pub(crate) fn interface(
    recording: &Recording,
    inputs: &[String],
    output: Option<&str>,
) -> miette::Result<Interface> {
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
    let output = match output {
        Some(name) => named(name),
        None => USUAL_OUTPUTS.into_iter().find_map(named),
    };
    let inputs: Vec<Channel> = match inputs.is_empty() {
        true => USUAL_INPUTS.into_iter().find_map(named).into_iter().collect(),
        false => inputs.iter().filter_map(|name| named(name)).collect(),
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

/// How far a GMDH network and its locally recurrent form (Section 2.4) run apart from rest.
fn recurrent_difference(network: &Arc<Gmdh>, healthy: &Data) -> Option<f64> {
    const COMPARED: usize = 2000; // State space by dense matrices is slow.
    let part = healthy.span(0..healthy.len().min(COMPARED));
    let recurrent = network.locally_recurrent()?.free_run(part.inputs());
    let own = free_run(&mut network.run(), part.inputs()).swap_remove(0);
    Some(own.iter().zip(&recurrent).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
}
