//! Detectors of a campaign: designed once, on healthy runs of the nominal drive with seeds of their
//! own, at the set points of the plan.
//!
//! Process model and error model are those of the study (the paper's network and its ARX error
//! model); widths, thresholds and the whitening of the CUSUM come from another, longer set of runs.

use drivescope_diagnoser::{
    Channel, Column, Confidence, ConfidenceError, Cusum, CusumError, Data, DataError,
    Design as How, DesignError as BandError, Diagnoser, Interface, Model, Start, Structure,
    Training, TrainingError, residual, train,
};
use drivescope_monitor::bank::DesignError as BankError;
use drivescope_plant::fault::{FaultLanes, Faults};
use drivescope_plant::integrate::Integrator;
use drivescope_plant::sampled::{InputLanes, Inputs, Sampled, speed_bound};
use drivescope_recording::Recording;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

use super::bank::DesignedBank;
use super::plan::{Method, Plan};
use crate::experiment::{Experiment, Stream};
use crate::native;

/// Samples of an excited run.
const EXCITED: usize = 1000;
/// Samples that the error model is fitted on, at each set point.
const FITTED: usize = 4000;
/// Samples at the start of a healthy run that nothing is learned from, at least.
const SETTLING: usize = 500;
/// Set points of the plan that healthy runs are made at, at most.
const SET_POINTS: u64 = 8;
/// Order of the whitening filter: the residual is correlated over some twenty samples.
const WHITENING: usize = 20;
/// Level that the design states; each scenario has its own.
const BETA: f64 = 0.05;

/// Why there are no detectors.
#[derive(Debug, Error)]
pub enum DesignError {
    /// The process model cannot be trained.
    #[error("process model: {0}")]
    Process(#[from] TrainingError),
    /// Bands cannot be designed.
    #[error(transparent)]
    Bands(#[from] BandError),
    /// A healthy signal does not serve.
    #[error("healthy run of the design: {0}")]
    Data(#[from] DataError),
    /// There are no innovations.
    #[error(transparent)]
    Cusum(#[from] CusumError),
    /// There is no bank.
    #[error("bank: {0}")]
    Bank(#[from] BankError),
    /// The level is impossible.
    #[error(transparent)]
    Confidence(#[from] ConfidenceError),
    /// A stored design that cannot be read.
    #[error("not a design of detectors: {0}")]
    Parse(#[from] toml::de::Error),
    /// A design that cannot be put into words.
    #[error("the design cannot be written as TOML: {0}")]
    Serialise(#[from] toml::ser::Error),
}

/// Detectors that are ready to watch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Digest of the plan that it is for.
    pub plan: String,
    /// Version of the program that made it.
    pub version: String,
    /// Whitening of the CUSUM.
    pub cusum: Cusum,
    /// Process model, error model, constant thresholds.
    pub diagnoser: Diagnoser,
    /// The bank, where the plan has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bank: Option<DesignedBank>,
}

/// Control signal and tachometer signal of runs, one after the other.
#[derive(Debug)]
struct Runs {
    c_m: Vec<f64>,
    t: Vec<f64>,
    length: usize,
}

impl Runs {
    fn of(runs: &[Recording], length: usize) -> Self {
        let joined = |signal: usize| {
            runs.iter().flat_map(|run| run.signals[signal].values.iter().copied()).collect()
        };
        Self { c_m: joined(0), t: joined(1), length }
    }

    fn data(&self) -> Result<Data<'_>, DataError> {
        let column = |name, values| Column { name, values };
        let data = Data::new(vec![column("C_m", &self.c_m)], column("T", &self.t))?;
        let begins = (0..self.t.len()).step_by(self.length.max(1));
        Ok(data.in_segments(begins.map(|begin| begin..begin + self.length).collect()))
    }
}

impl Design {
    /// Designs the detectors of a plan.
    ///
    /// # Errors
    /// [`DesignError`], which says what did not suit.
    pub fn new(plan: &Plan) -> Result<Self, DesignError> {
        let experiment = plan.experiment.with_seed(plan.design_seed);
        let run_up = plan.run_up.max(SETTLING);
        let [estimated, judged] = [0, 1].map(|part| excited(&experiment, part));
        let training = Training { seed: plan.design_seed, ..Training::default() };
        let process = train(Structure::PAPER, &estimated.data()?, &judged.data()?, &training)?;
        let set_points = plan.design_set_points(SET_POINTS);
        let each = plan.design_samples.div_ceil(set_points.len());
        let runs = healthy(&experiment, &set_points, run_up + FITTED, 0);
        let fitted = Runs::of(&runs, run_up + FITTED);
        let of_bank = || DesignedBank::new(plan, &runs);
        let bank = plan.methods.contains(&Method::Bank).then(of_bank).transpose()?;
        let long = run_up + each;
        let long = Runs::of(&healthy(&experiment, &set_points, long, 1), long);
        let interface = Interface {
            period_s: experiment.period_s,
            inputs: vec![Channel::new("C_m", "V")],
            output: Channel::new("T", experiment.tacho_unit()),
        };
        let how = How { run_up, ..How::paper(Confidence::new(BETA)?) };
        let model = Model::Network(process.network);
        let (fitted, long) = (fitted.data()?, long.data()?);
        let (diagnoser, _) = Diagnoser::design(interface, model, &fitted, &long, &how)?;
        let r = residual(&mut diagnoser.model.run(), &long, Start::Rest);
        let of_r = long.with_output("residual", &r)?;
        let left = residual(&mut diagnoser.model_error.model.run(), &of_r, Start::Rest);
        let cusum = Cusum::learn(&of_r.judged(&left, run_up), WHITENING)?;
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Ok(Self { plan: plan.digest.clone(), version, cusum, diagnoser, bank })
    }

    /// The design as text: [`Self::parse`] gives the same again.
    ///
    /// # Errors
    /// A design that TOML does not hold.
    pub fn to_toml(&self) -> Result<String, DesignError> {
        Ok(toml::to_string(self)?)
    }

    /// Reads what [`Self::to_toml`] wrote.
    ///
    /// # Errors
    /// Another text.
    pub fn parse(text: &str) -> Result<Self, DesignError> {
        Ok(toml::from_str(text)?)
    }

    /// Hexadecimal digest: scenarios judged by equal detectors can stand in one table.
    pub fn digest(&self) -> String {
        let text = self.to_toml().unwrap_or_default();
        Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Healthy closed-loop runs of one length at each set point, from rest.
fn healthy(
    experiment: &Experiment,
    set_points: &[f64],
    samples: usize,
    which: u64,
) -> Vec<Recording> {
    set_points
        .par_iter()
        .enumerate()
        .map(|(k, set_point)| {
            let stream = Stream::Design((which << 16) + k as u64);
            let inputs = experiment.following(vec![*set_point; samples], stream, &[]);
            native::closed_loop(&experiment.drive, &inputs)
        })
        .collect()
}

/// An open-loop run under the excitation (25).
fn excited(experiment: &Experiment, part: u64) -> Runs {
    let excited = experiment.excited(EXCITED, Stream::Training(part));
    let drive = &experiment.drive;
    let integrator = Integrator::new(drive.model(), speed_bound(drive));
    let mut sampled = Sampled::new(drive, integrator, false);
    let none = FaultLanes::splat(Faults::NONE);
    let value =
        |name: &str, k: usize| excited.inputs.signal(name).map_or(0.0, |signal| signal.values[k]);
    let t = (0..EXCITED).map(|k| {
        let time = k as f64 * experiment.period_s;
        let inputs = InputLanes::splat(Inputs {
            u: value("u", k),
            load: value("noise_T_l", k),
            noise_t: value("noise_T", k),
            noise_i_m: value("noise_I_m", k),
            ..Inputs::NONE
        });
        sampled.sample(time, &inputs, &none);
        sampled.advance(time, experiment.period_s);
        sampled.signals().t[0]
    });
    let t = t.collect();
    Runs { c_m: excited.c_m, t, length: EXCITED }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_design_is_stored_and_read_and_is_the_same_again() {
        let text = "schema = 1\ndrive = \"dr300\"\ndraws = 4\nduration = 10\n\
                    design = { samples = 20000 }\nset_point = { uniform = [100, 200] }\n";
        let plan = Plan::parse(text, "plan.toml", Path::new("")).expect("a right plan");
        let design = Design::new(&plan).expect("it suits");
        let again = Design::parse(&design.to_toml().expect("text")).expect("the same");
        assert!(again == design && again.digest() == design.digest());
        assert_eq!(Design::new(&plan).expect("it suits"), design);
        assert_eq!(design.plan, plan.digest);
    }
}
