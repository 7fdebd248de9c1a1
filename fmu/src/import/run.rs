//! One FMU over one experiment: what `fmu run` does.

use std::sync::Arc;

use drivescope_recording::{Recording, Signal};

use super::description::{Causality, Kind, Variable};
use super::error::Error;
use super::experiment::steps;
use super::fmu::{Fmu, InstanceOptions};
use super::held::{Held, from_recorded};
use super::instance::Progress;
use super::problem::{ExperimentProblem, VariableProblem};
use super::values::Value;

/// Steps of a run for which nobody states a step size.
const STEPS: f64 = 1000.0;

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
    pub kind: Option<Kind>,
    /// Values that are set before the initialisation.
    pub parameters: Vec<(String, Value)>,
    /// Variables to record; otherwise all scalar numeric outputs.
    pub record: Option<Vec<String>>,
    /// Whether the FMU should log.
    pub logging: bool,
}

/// Runs an FMU. Sample `k` of the recording lies at `start + k h`; it holds the driven inputs as they
/// were set for the step from there, and the recorded variables as they were at that time. It ends
/// early where the FMU asks to end the simulation.
///
/// # Errors
/// An experiment that cannot be run, signals that fit no input, a value that cannot be set, a step
/// that fails or is discarded.
pub fn run(fmu: &Fmu, options: &RunOptions) -> Result<Recording, Error> {
    let window = Window::of(fmu, options)?;
    let kinds = fmu.description().kinds();
    let kind = options.kind.or(kinds.first().copied()).unwrap_or(Kind::CoSimulation);
    let driven = drive(fmu, options.input)?;
    let outputs: Vec<String> = match &options.record {
        Some(names) => names.clone(),
        None => fmu.description().scalars(Causality::Output).map(|v| v.name.clone()).collect(),
    };

    let name = fmu.description().model_name.clone();
    let mut instance =
        fmu.instantiate(kind, &InstanceOptions { name: name.clone(), logging: options.logging })?;
    for (name, value) in &options.parameters {
        instance.set_value(name, value)?;
    }
    let input_names: Vec<&str> =
        driven.iter().map(|(variable, _)| variable.name.as_str()).collect();
    let output_names: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let (inputs, reads) = (instance.group(&input_names)?, instance.group(&output_names)?);
    let mut row_in = vec![0.0; driven.len()];
    let mut row_out = vec![0.0; outputs.len()];
    let mut columns = vec![Vec::with_capacity(window.steps + 1); driven.len() + outputs.len()];
    let sample = |time: f64, row: &mut [f64]| {
        for (value, (_, held)) in row.iter_mut().zip(&driven) {
            *value = held.at(time);
        }
    };

    instance.enter_initialization(window.start, Some(window.stop), options.tolerance)?;
    sample(window.start, &mut row_in);
    if !inputs.is_empty() {
        instance.write(&inputs, &row_in)?;
    }
    instance.exit_initialization()?;
    for k in 0..=window.steps {
        let time = window.start + k as f64 * window.step;
        instance.read(&reads, &mut row_out)?;
        sample(time, &mut row_in);
        for (column, value) in columns.iter_mut().zip(row_in.iter().chain(&row_out)) {
            column.push(*value);
        }
        if k == window.steps {
            break;
        }
        if !inputs.is_empty() {
            instance.write(&inputs, &row_in)?;
        }
        if instance.step(time, window.step)? == Progress::Terminate {
            break;
        }
    }
    let variables = input_names.iter().chain(&output_names).map(|name| fmu.variable(name));
    let signals = variables.zip(columns).map(|(variable, values)| {
        let variable = variable?;
        let unit = variable.unit.clone().unwrap_or_else(|| "1".to_owned());
        Ok(Signal { name: variable.name.clone(), unit, values })
    });
    let signals = signals.collect::<Result<Vec<_>, Error>>()?;
    Ok(Recording::new(name, window.start, window.step, signals))
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

/// The inputs that the recording has a signal for.
fn drive<'f>(fmu: &'f Fmu, input: Option<&Recording>) -> Result<Vec<(&'f Variable, Held)>, Error> {
    let Some(input) = input else { return Ok(Vec::new()) };
    let wrong = |problem| Error::Experiment { fmu: fmu.name().to_owned(), problem };
    if input.is_empty() {
        return Err(wrong(ExperimentProblem::EmptyInput(input.name.clone())));
    }
    let description = fmu.description();
    let recording = Arc::new(input.clone());
    let mut driven = Vec::new();
    for variable in description.scalars(Causality::Input) {
        let Some(at) = input.signals.iter().position(|signal| signal.name == variable.name) else {
            continue;
        };
        let own = variable.unit.as_ref().map(|name| description.unit_of_name(name));
        let unit = &input.signals[at].unit;
        let conversion = from_recorded(unit, own.as_ref(), &description.units);
        let conversion = conversion.ok_or_else(|| Error::Variable {
            fmu: fmu.name().to_owned(),
            name: variable.name.clone(),
            problem: VariableProblem::Unit {
                own: variable.unit.clone().unwrap_or_default(),
                other: unit.clone(),
            },
        })?;
        driven.push((variable, Held::new(Arc::clone(&recording), at, conversion)));
    }
    if driven.is_empty() {
        let inputs: Vec<&str> =
            description.scalars(Causality::Input).map(|variable| variable.name.as_str()).collect();
        let inputs = if inputs.is_empty() { "none".to_owned() } else { inputs.join(", ") };
        let recording = input.name.clone();
        return Err(wrong(ExperimentProblem::NoInput { recording, inputs }));
    }
    Ok(driven)
}
