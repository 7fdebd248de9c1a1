//! Runs of a drive's FMU through the co-simulation algorithm.
//!
//! The FMU is one component; what follows the run, a diagnoser, is another, connected to its
//! signals. By Gauss-Seidel the diagnoser sees, at the end of step k, what the drive showed in
//! it: C_m, T and I_m of sample k.

use std::sync::Arc;

use drivescope_diagnoser::DetectorError;
use drivescope_fmu::cosim::{
    self, Component, Experiment, Failure, FmuComponent, Phase, Port, PortKind, Ports, System,
};
use drivescope_fmu::import::{self, Fmu, InstanceOptions, Progress, Value};
use drivescope_recording::{Recording, Signal};
use thiserror::Error;

use crate::native::RECORDED;

/// Name of the FMU among the components, and of what follows it.
const DRIVE: &str = "drive";
const FOLLOWER: &str = "diagnoser";
/// What a follower sees, in the order of [`Follower::sample`].
const FOLLOWED: [&str; 2] = ["C_m", "T"];

/// Why a run fails.
#[derive(Debug, Error)]
pub enum RunError {
    /// The FMU cannot be made ready.
    #[error(transparent)]
    Fmu(#[from] Box<import::Error>),
    /// The co-simulation cannot be put together or run.
    #[error(transparent)]
    CoSimulation(#[from] Box<cosim::Error>),
    /// The run ended before its time.
    #[error("the run ended after {samples} of {wanted} samples: {}", why(end))]
    Short {
        /// Samples that were run.
        samples: usize,
        /// Samples that were asked for.
        wanted: usize,
        /// Why.
        end: cosim::End,
    },
}

/// Why a run was short, in words.
fn why(end: &cosim::End) -> String {
    match end {
        cosim::End::Stop => "its stop time was reached".to_owned(),
        cosim::End::Terminated { component, time } => {
            format!("the FMU `{component}` asked for the end at {time:.6} s")
        }
        cosim::End::Discarded { component, time, reached, .. } => {
            format!("the FMU `{component}` came from {time:.6} s to {reached:.6} s and no further")
        }
    }
}

impl From<import::Error> for RunError {
    fn from(error: import::Error) -> Self {
        Self::Fmu(Box::new(error))
    }
}

impl From<cosim::Error> for RunError {
    fn from(error: cosim::Error) -> Self {
        Self::CoSimulation(Box::new(error))
    }
}

/// What follows a run sample by sample.
pub trait Follower: Send {
    /// The control signal and the tachometer signal of the next sample.
    ///
    /// # Errors
    /// A sample that it cannot take.
    fn sample(&mut self, c_m: f64, t: f64) -> Result<(), DetectorError>;
}

/// A follower as a component: two inputs, no output.
struct Following<'a, F>(&'a mut F);

impl<F: Follower> Component for Following<'_, F> {
    fn ports(&self) -> Ports {
        let port = |name: &str| Port { name: name.to_owned(), kind: PortKind::Float, unit: None };
        Ports { inputs: FOLLOWED.map(port).to_vec(), ..Ports::default() }
    }

    fn select(&mut self, _: &[usize], _: &[usize]) -> Result<(), Failure> {
        Ok(())
    }

    fn initialize(&mut self, _: Phase, _: &[f64], _: &mut [f64]) -> Result<(), Failure> {
        Ok(())
    }

    fn step(&mut self, _: f64, _: f64, inputs: &[f64], _: &mut [f64]) -> Result<Progress, Failure> {
        if let [c_m, t] = *inputs {
            self.0.sample(c_m, t).map_err(|error| Failure::Participant(Box::new(error)))?;
        }
        Ok(Progress::Continue)
    }
}

/// Runs the closed loop over the inputs; row k as in [`crate::native::closed_loop`].
///
/// # Errors
/// The FMU refuses or the follower stops.
pub fn closed_loop(
    fmu: &Fmu,
    inputs: &Recording,
    follower: Option<&mut impl Follower>,
) -> Result<Recording, RunError> {
    let mut system = system(fmu, inputs, &RECORDED, &[])?;
    if let Some(follower) = follower {
        system.add(FOLLOWER, Following(follower))?;
        for signal in FOLLOWED {
            system.connect(&format!("{DRIVE}.{signal}"), &format!("{FOLLOWER}.{signal}"))?;
        }
    }
    // Row 0 is the start; what sample k shows stands at the end of its step.
    rows(&mut system, inputs, &RECORDED, 1)
}

/// Runs the open loop over the inputs; row k holds T and I_m at the start of step k.
///
/// # Errors
/// The FMU refuses.
pub fn open_loop(fmu: &Fmu, inputs: &Recording) -> Result<Recording, RunError> {
    const SHOWN: [&str; 2] = ["T", "I_m"];
    let mut system = system(fmu, inputs, &SHOWN, &[])?;
    rows(&mut system, inputs, &SHOWN, 0)
}

/// Runs the closed loop of any FMU over the inputs, with those values of its parameters; row k holds what
/// it shows of those outputs at the end of step k, in its own units.
///
/// # Errors
/// The FMU refuses.
pub fn foreign_loop(
    fmu: &Fmu,
    inputs: &Recording,
    shown: &[&str],
    parameters: &[(&str, f64)],
) -> Result<Recording, RunError> {
    rows(&mut system(fmu, inputs, shown, parameters)?, inputs, shown, 1)
}

/// The FMU with its inputs, those values of its parameters, and what is recorded of it.
fn system<'a>(
    fmu: &Fmu,
    inputs: &Recording,
    shown: &[&str],
    parameters: &[(&str, f64)],
) -> Result<System<'a>, RunError> {
    let h = inputs.period_s;
    let experiment = Experiment::new(inputs.start_s, inputs.time(inputs.len()), h);
    let mut system = System::new(experiment);
    let mut drive = fmu.co_simulation(&InstanceOptions::named(DRIVE))?;
    for (name, value) in parameters {
        drive.set_value(name, &Value::Number(*value))?;
    }
    system.add(DRIVE, FmuComponent::new(drive))?;
    let recording = Arc::new(inputs.clone());
    for signal in &inputs.signals {
        system.input(&recording, &signal.name, &format!("{DRIVE}.{}", signal.name))?;
    }
    for name in shown {
        system.record(&format!("{DRIVE}.{name}"))?;
    }
    Ok(system)
}

/// Runs the system; one row a sample of the inputs, from row `first` of what was recorded.
fn rows(
    system: &mut System,
    inputs: &Recording,
    shown: &[&str],
    first: usize,
) -> Result<Recording, RunError> {
    let outcome = system.run()?;
    let wanted = inputs.len();
    let samples = outcome.recording.len().saturating_sub(1);
    if samples < wanted {
        return Err(RunError::Short { samples, wanted, end: outcome.end });
    }
    let signals = shown.iter().zip(outcome.recording.signals).map(|(name, signal)| Signal {
        name: (*name).to_owned(),
        unit: signal.unit,
        values: signal.values[first..first + wanted].to_vec(),
    });
    Ok(Recording { signals: signals.collect(), ..inputs.clone() })
}
