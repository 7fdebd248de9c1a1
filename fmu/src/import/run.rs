//! One FMU over one experiment: what `fmu run` does.

use std::sync::Arc;

use drivescope_recording::{Recording, Signal, TextSignal};

use super::description::{Causality, Interface, Variable};
use super::error::Error;
use super::experiment::{recordable, steps};
use super::fmu::Fmu;
use super::held::{Held, from_recorded};
use super::instance::{Instance, Progress};
use super::instantiate::InstanceOptions;
use super::logging::Message;
use super::problem::{ExperimentProblem, VariableProblem};
use super::recorder::{Recorder, indices};
use super::values::Value;

/// Steps of a run for which nobody states a step size.
const STEPS: f64 = 1000.0;
/// Share of the step within which two times are one communication point.
const SAME_POINT: f64 = 1e-6;

/// How an FMU is to be run. Times are in s; what is left out is taken from the FMU's default
/// experiment.
#[derive(Debug, Clone, Default)]
pub struct RunOptions<'a> {
    /// Signals for the inputs of the same names, held between samples. Other inputs keep their start
    /// values.
    pub input: Option<&'a Recording>,
    /// Start time; otherwise that of the default experiment, or 0.
    pub start: Option<f64>,
    /// Stop time; otherwise that of the default experiment, or the end of the input.
    pub stop: Option<f64>,
    /// Communication step size; otherwise that of the default experiment, the sampling time of the
    /// input, or a thousandth of the run.
    pub step: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// The interface type; otherwise Co-Simulation if there is one.
    pub kind: Option<Interface>,
    /// Values that are set before the initialisation.
    pub parameters: Vec<(String, Value)>,
    /// Variables to record; otherwise all outputs.
    pub record: Option<Vec<String>>,
    /// Whether the FMU should log.
    pub logging: bool,
}

/// What a run gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Ran {
    /// Sample `k` lies at `start + k h`; it holds the driven inputs as they were set for the step from
    /// there, and the recorded variables as they were at that time. Elements of arrays are named
    /// `y[1]`, `y[2]`, ...
    pub recording: Recording,
    /// What is no number: strings, binaries (in hexadecimal digits), whole numbers beyond 2^53.
    pub texts: Vec<TextSignal>,
    /// When the FMU ended the simulation, s, if it did before the stop time.
    pub ended: Option<f64>,
    /// Outputs that cannot be recorded: clocks.
    pub left_out: Vec<String>,
    /// What the FMU logged.
    pub messages: Vec<Message>,
}

/// Runs an FMU. It ends early where the FMU asks to end the simulation; a communication point that is
/// reached then is recorded.
///
/// # Errors
/// An experiment that cannot be run, signals that fit no input, a value that cannot be set, a step
/// that fails or is discarded.
pub fn run(fmu: &Fmu, options: &RunOptions) -> Result<Ran, Error> {
    let window = Window::of(fmu, options)?;
    let kinds = fmu.description().interfaces();
    let kind = options.kind.or(kinds.first().copied()).unwrap_or(Interface::CoSimulation);
    let driven = drive(fmu, options.input)?;

    let name = fmu.description().model_name.clone();
    let mut instance =
        fmu.instantiate(kind, &InstanceOptions { name: name.clone(), logging: options.logging })?;
    for (name, value) in &options.parameters {
        instance.set_value(name, value)?;
    }
    let (scalars, arrays): (Vec<_>, Vec<_>) =
        driven.iter().partition(|input| input.variable.dimensions.is_empty());
    let scalar_names: Vec<&str> =
        scalars.iter().map(|input| input.variable.name.as_str()).collect();
    let scalar_inputs = instance.group(&scalar_names)?;
    let mut row = vec![0.0; scalars.len()];
    let mut apply = |instance: &mut Instance, time: f64| -> Result<(), Error> {
        if !scalars.is_empty() {
            for (value, input) in row.iter_mut().zip(&scalars) {
                *value = input.held[0].at(time);
            }
            instance.write(&scalar_inputs, &row)?;
        }
        for input in &arrays {
            let values: Vec<f64> = input.held.iter().map(|held| held.at(time)).collect();
            instance.set_array(&input.variable.name, &values)?;
        }
        Ok(())
    };
    let mut recorder = Recorder::new(fmu, &instance, options.record.as_deref())?;
    let columns = recorder.columns() + driven.iter().map(|input| input.held.len()).sum::<usize>();
    recordable(window.steps, columns)
        .map_err(|problem| Error::Experiment { fmu: fmu.name().to_owned(), problem })?;

    instance.enter_initialization(window.start, Some(window.stop), options.tolerance)?;
    apply(&mut instance, window.start)?;
    instance.exit_initialization()?;
    let mut samples = 0;
    let mut ended = None;
    loop {
        let time = window.start + samples as f64 * window.step;
        let due = instance.event_is_due();
        if due {
            // The event belongs to this time, and sees its inputs.
            apply(&mut instance, time)?;
            if instance.settle()? == Progress::Terminate {
                ended = ended.or(Some(time));
            }
        }
        recorder.sample(&mut instance)?;
        samples += 1;
        if samples > window.steps || ended.is_some() {
            break;
        }
        if !due {
            apply(&mut instance, time)?;
        }
        if instance.step(time, window.step)? == Progress::Terminate {
            let reached = instance.time();
            ended = Some(reached);
            // A sample lies at a communication point; what was reached between two has none.
            if reached < time + (1.0 - SAME_POINT) * window.step {
                break;
            }
        }
    }
    let messages = instance.messages();
    let left_out = std::mem::take(&mut recorder.left_out);
    let inputs = driven.iter().flat_map(|input| {
        let unit = input.variable.unit.clone().unwrap_or_else(|| "1".to_owned());
        let names = indices(&fmu.description().sizes(input.variable)).into_iter();
        names.zip(&input.held).map(move |(index, held)| Signal {
            name: format!("{}{index}", input.variable.name),
            unit: unit.clone(),
            values: (0..samples).map(|k| held.at(window.start + k as f64 * window.step)).collect(),
        })
    });
    let (outputs, texts) = recorder.finish();
    let signals = inputs.chain(outputs).collect();
    let recording = Recording::new(name, window.start, window.step, signals);
    Ok(Ran { recording, texts, ended, left_out, messages })
}

struct Window {
    start: f64,
    stop: f64,
    step: f64,
    steps: usize,
}

impl Window {
    fn of(fmu: &Fmu, options: &RunOptions) -> Result<Window, Error> {
        let wrong = |problem| Error::Experiment { fmu: fmu.name().to_owned(), problem };
        let proposed = fmu.description().default_experiment;
        let input = options.input.filter(|input| !input.is_empty());
        let start = options.start.or(proposed.start).unwrap_or(0.0);
        let end = input.map(|input| input.time(input.len() - 1));
        let stop =
            options.stop.or(proposed.stop).or(end).ok_or(wrong(ExperimentProblem::NoStop))?;
        let fixed = fmu.description().co_simulation.as_ref().and_then(|cs| cs.fixed_step);
        let step = options.step.or(proposed.step).or(fixed).or(input.map(|input| input.period_s));
        let step = step.unwrap_or((stop - start) / STEPS);
        let steps = steps(start, stop, step).map_err(wrong)?;
        Ok(Window { start, stop, step, steps })
    }
}

/// An input that a recording drives: one signal an element.
struct Driven<'f> {
    variable: &'f Variable,
    held: Vec<Held>,
}

/// The inputs that the recording has signals for: those of an array `u` are `u[1]`, `u[2]`, ...
fn drive<'f>(fmu: &'f Fmu, input: Option<&Recording>) -> Result<Vec<Driven<'f>>, Error> {
    let Some(input) = input else { return Ok(Vec::new()) };
    let wrong = |problem| Error::Experiment { fmu: fmu.name().to_owned(), problem };
    if input.is_empty() {
        return Err(wrong(ExperimentProblem::EmptyInput(input.name.clone())));
    }
    let description = fmu.description();
    let recording = Arc::new(input.clone());
    let inputs = || {
        let numeric = |v: &&Variable| v.causality == Causality::Input && v.kind.is_numeric();
        description.variables.iter().filter(numeric)
    };
    let mut driven = Vec::new();
    for variable in inputs() {
        let names = indices(&description.sizes(variable)).into_iter();
        let names: Vec<String> = names.map(|index| format!("{}{index}", variable.name)).collect();
        let at = |name: &String| input.signals.iter().position(|signal| signal.name == *name);
        let found: Vec<Option<usize>> = names.iter().map(at).collect();
        if found.iter().all(Option::is_none) {
            continue;
        }
        let own = variable.unit.as_ref().map(|name| description.unit_of_name(name));
        let problem = |problem| Error::Variable {
            fmu: fmu.name().to_owned(),
            name: variable.name.clone(),
            problem,
        };
        let mut held = Vec::new();
        for (found, name) in found.into_iter().zip(names) {
            let at = found.ok_or_else(|| problem(VariableProblem::NoSignal(name)))?;
            let unit = &input.signals[at].unit;
            let conversion = from_recorded(unit, own.as_ref(), &description.units);
            let conversion = conversion.ok_or_else(|| {
                let own = variable.unit.clone().unwrap_or_default();
                problem(VariableProblem::Unit { own, other: unit.clone() })
            })?;
            held.push(Held::new(Arc::clone(&recording), at, conversion));
        }
        driven.push(Driven { variable, held });
    }
    if driven.is_empty() {
        let inputs: Vec<&str> = inputs().map(|variable| variable.name.as_str()).collect();
        let inputs = if inputs.is_empty() { "none".to_owned() } else { inputs.join(", ") };
        let recording = input.name.clone();
        return Err(wrong(ExperimentProblem::NoInput { recording, inputs }));
    }
    Ok(driven)
}
