//! The study: train a diagnoser on healthy runs, then judge the twelve faults.
//!
//! 1. Training: the open-loop FMU under the excitation (25) gives the process model T = f(C_m).
//! 2. Design: healthy closed-loop runs give the error models, their bands and the constant
//!    thresholds; open and closed loop together a GMDH network with bounded parameters.
//! 3. Judgement: healthy runs and twelve faulty runs, each through the closed-loop FMU with
//!    detectors that follow it sample by sample, in parallel.
//! 4. Isolation and identification: classifiers trained on faulty runs of their own answer to the
//!    judged ones; sizes (27).
//!
//! Training, design, learning of symptoms and judgement use separate streams of noise.

mod design;
mod isolation;
mod judge;
mod paper;
mod signals;
mod structures;
mod summary;

use std::path::Path;

use drivescope_diagnoser::{
    ConfidenceError, DataError, DetectorError, IsolationError, RecipeError, SpanError,
    SymptomError, TrainingError,
};
use drivescope_fmu::import::{self, Fmu};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use rayon::prelude::*;
use thiserror::Error;

use crate::experiment::{Experiment, ExperimentError, Stream};
use crate::faults::{Fault, SPAN, twelve};
use crate::profile::Profile;
use crate::results::{Pictures, StudyResults, TorqueReading};
use crate::{cosimulated, native};
pub use design::{Designed, design};
pub(crate) use isolation::{STARTS, symptoms};
pub use judge::{Judgement, Watch, false_rate_of, row_of};
pub use signals::Signals;

/// Samples of a closed-loop run: up to the end of the faults.
pub const SAMPLES: usize = SPAN.end;
/// Samples at the start of a closed-loop run that are not judged: the start from rest.
pub const RUN_UP: usize = 1000;
/// Samples of the run of slow reversals.
const SLOW_SAMPLES: usize = 2000;
/// Healthy runs that false alarms are counted on.
const HEALTHY_RUNS: u64 = 20;

/// Why a study fails.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The drive does not suit.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The FMU does not run.
    #[error("the exported FMU does not run")]
    Fmu(#[from] import::Error),
    /// The co-simulation does not run.
    #[error(transparent)]
    CoSimulation(#[from] cosimulated::RunError),
    /// A model of the diagnoser cannot be made.
    #[error("the diagnoser cannot be trained")]
    Recipe(#[from] RecipeError),
    /// The structures cannot be compared.
    #[error("the structures of the process model cannot be compared")]
    Training(#[from] TrainingError),
    /// The symptoms do not serve.
    #[error("the symptoms of the faults do not serve")]
    Symptoms(#[from] SymptomError),
    /// No classifier can be trained.
    #[error("the faults cannot be isolated")]
    Isolation(#[from] IsolationError),
    /// A signal does not serve.
    #[error("the healthy run does not serve for the design")]
    Data(#[from] DataError),
    /// The confidence level is impossible.
    #[error(transparent)]
    Confidence(#[from] ConfidenceError),
    /// A sample cannot be judged.
    #[error(transparent)]
    Detector(#[from] DetectorError),
    /// A rate cannot be stated.
    #[error(transparent)]
    Span(#[from] SpanError),
    /// Whoever watched it ended it.
    #[error("the study was stopped")]
    Stopped,
}

/// What a study is asked.
#[derive(Debug, Clone)]
pub struct StudyOptions {
    pub drive: Drive,
    /// Seed of all randomness.
    pub seed: u64,
    /// Reading of the torque faults in the tables.
    pub torque: TorqueReading,
    /// Confidence level of the bands (two-sided).
    pub beta: f64,
    /// How the sizes of the judged faults go over their span.
    pub profile: Profile,
    /// Runs beside the twelve: a name, and the faults that act together in it.
    pub further: Vec<(String, Vec<Fault>)>,
}

/// A study's outcome.
#[derive(Debug)]
pub struct Study {
    /// The figures.
    pub results: StudyResults,
    /// Traces for the report: a healthy run, then the twelve faults.
    pub pictures: Vec<Pictures>,
    /// Inputs and signals of runs for a comparison with other simulators: a healthy one, the
    /// twelve faults, and slow reversals in which the shaft sticks and slips.
    pub runs: Vec<RepeatableRun>,
}

/// One run, as another simulator can repeat it.
#[derive(Debug)]
pub struct RepeatableRun {
    /// Name for files: `healthy`, `stick_slip` or that of the fault.
    pub name: String,
    /// Inputs, a row a sample.
    pub inputs: Recording,
    /// What the FMU gave.
    pub signals: Recording,
}

/// Steps of a study, for a progress bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The models are being trained and their thresholds designed.
    Training,
    /// That many runs will be judged.
    Judging(usize),
    /// One more run was judged.
    Judged,
    /// Classifiers are being trained.
    Isolation,
}

/// Runs the study through the two FMUs of the drive, closed and open loop; it ends where
/// `progress` answers true.
///
/// # Errors
/// [`StudyError`], which says what did not suit.
pub fn study(
    options: &StudyOptions,
    (closed, open): (&Path, &Path),
    progress: &(dyn Fn(Progress) -> bool + Sync),
) -> Result<Study, StudyError> {
    let experiment = Experiment::new(options.drive.clone(), options.seed)?;
    let (closed, open) = (Fmu::open(closed)?, Fmu::open(open)?);
    let reported = |step| if progress(step) { Err(StudyError::Stopped) } else { Ok(()) };
    reported(Progress::Training)?;
    let designed = design(&experiment, (&closed, &open), options.beta)?;

    let runs = plan(options);
    reported(Progress::Judging(runs.len()))?;
    let judge = || -> Result<Vec<Judged>, StudyError> {
        let judged = runs.into_par_iter().map(|run| {
            let judged = judge_run(&experiment, &closed, &designed, run)?;
            reported(Progress::Judged).map(|()| judged)
        });
        judged.collect()
    };
    let (judged, theorem) = rayon::join(judge, structures::theorem);
    let judged = judged?;
    reported(Progress::Isolation)?;
    let mut study = summary::summarise(options, &experiment, &designed, judged, theorem?)?;
    let inputs = experiment.slow_reversals(SLOW_SAMPLES);
    let signals = cosimulated::closed_loop(&closed, &inputs, None::<&mut Watch>)?;
    let native = native::closed_loop(&experiment.drive, &inputs);
    let difference = &mut study.results.fmu.max_relative_difference_native;
    *difference = difference.max(greatest_difference(&signals, &native));
    study.runs.push(RepeatableRun { name: "stick_slip".to_owned(), inputs, signals });
    Ok(study)
}

/// A run to judge.
#[derive(Debug, Clone)]
enum Run {
    Healthy(u64),
    Faulty(TorqueReading, Fault, u64),
    /// Faults that act together, and the stream of its noise.
    Further(String, Vec<Fault>, u64),
}

/// Streams of noise of further runs begin here: the twelve have those before.
const FURTHER: u64 = 1000;

fn plan(options: &StudyOptions) -> Vec<Run> {
    let profile = options.profile;
    let healthy = (0..HEALTHY_RUNS).map(Run::Healthy);
    let faulty = TorqueReading::ALL.into_iter().flat_map(|reading| {
        let faults = twelve(reading).into_iter().enumerate();
        // The readings share the noise of each fault: they differ in the fault alone.
        faults.map(move |(k, fault)| Run::Faulty(reading, Fault { profile, ..fault }, k as u64))
    });
    let further = options.further.iter().zip(FURTHER..);
    let further = further.map(|((name, faults), k)| Run::Further(name.clone(), faults.clone(), k));
    healthy.chain(faulty).chain(further).collect()
}

struct Judged {
    run: Run,
    inputs: Recording,
    signals: Recording,
    judgement: Judgement,
    /// Greatest relative difference from the native run.
    native: f64,
}

impl Judged {
    fn repeatable(self, name: String) -> RepeatableRun {
        RepeatableRun { name, inputs: self.inputs, signals: self.signals }
    }
}

fn judge_run(
    experiment: &Experiment,
    fmu: &Fmu,
    designed: &Designed,
    run: Run,
) -> Result<Judged, StudyError> {
    let inputs = match &run {
        Run::Healthy(k) => experiment.closed_loop(SAMPLES, Stream::Healthy(*k), None),
        Run::Faulty(_, fault, k) => {
            experiment.closed_loop(SAMPLES, Stream::Faulty(*k), Some(fault))
        }
        Run::Further(_, faults, k) => {
            let reference = vec![experiment.set_point; SAMPLES];
            experiment.following(reference, Stream::Faulty(*k), faults)
        }
    };
    let mut watch = Watch::new(&designed.diagnoser)?;
    let signals = cosimulated::closed_loop(fmu, &inputs, Some(&mut watch))?;
    let native = native::closed_loop(&experiment.drive, &inputs);
    let judgement = watch.judgement();
    let native = greatest_difference(&signals, &native);
    Ok(Judged { run, inputs, signals, judgement, native })
}

/// Greatest difference between two recordings of the same signals, relative to the greatest
/// magnitude of each signal.
pub fn greatest_difference(a: &Recording, b: &Recording) -> f64 {
    let of_signal = |(a, b): (&drivescope_recording::Signal, &drivescope_recording::Signal)| {
        let scale = b.values.iter().fold(f64::MIN_POSITIVE, |most, value| most.max(value.abs()));
        let differences = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max) / scale
    };
    a.signals.iter().zip(&b.signals).map(of_signal).fold(0.0, f64::max)
}
