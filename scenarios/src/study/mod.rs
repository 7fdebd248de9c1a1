//! The study: train a diagnoser on healthy runs, then judge the twelve faults.
//!
//! 1. Training: the open-loop FMU under the excitation (25) gives the process model T = f(C_m).
//! 2. Design: a healthy closed-loop run gives the error model, its bands and the constant
//!    thresholds.
//! 3. Judgement: healthy runs and twelve faulty runs, each through the closed-loop FMU with
//!    detectors that follow it sample by sample, in parallel.
//!
//! Training, design and judgement use separate streams of noise.

mod design;
mod judge;
mod paper;

use std::path::Path;

use drivescope_diagnoser::{
    ArxError, ConfidenceError, DataError, DetectorError, SpanError, TrainingError,
};
use drivescope_fmu::import::{self, Fmu};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use thiserror::Error;

use crate::experiment::{Experiment, ExperimentError, Stream};
use crate::faults::{Fault, SPAN, twelve};
use crate::results::{
    ByMethod, DetectionRow, DriveSummary, FaultSpan, FmuSummary, HealthySummary, Method,
    NoiseSummary, Pictures, ReadingRows, StudyResults, TorqueReading,
};
use crate::{cosimulated, native};
use design::Diagnoser;
use judge::Judgement;

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
    /// The process model cannot be trained.
    #[error("the process model cannot be trained")]
    Training(#[from] TrainingError),
    /// The error model cannot be fitted.
    #[error("the error model cannot be fitted")]
    ErrorModel(#[from] ArxError),
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
}

/// What a study is asked.
#[derive(Debug, Clone)]
pub struct StudyOptions {
    /// The drive.
    pub drive: Drive,
    /// Seed of all randomness.
    pub seed: u64,
    /// Reading of the torque faults in the tables.
    pub torque: TorqueReading,
    /// Confidence level of the bands (two-sided).
    pub beta: f64,
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
    /// The process model is being trained.
    Training,
    /// Bands and thresholds are being designed.
    Design,
    /// That many runs will be judged.
    Judging(usize),
    /// One more run was judged.
    Judged,
}

/// Runs the study through the two FMUs of the drive, closed and open loop.
///
/// # Errors
/// [`StudyError`], which says what did not suit.
pub fn study(
    options: &StudyOptions,
    (closed, open): (&Path, &Path),
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Study, StudyError> {
    let experiment = Experiment::new(options.drive.clone(), options.seed)?;
    let (closed, open) = (Fmu::open(closed)?, Fmu::open(open)?);
    progress(Progress::Training);
    let process = design::train(&experiment, &open)?;
    progress(Progress::Design);
    let diagnoser = Diagnoser::design(&experiment, &closed, process, options.beta)?;

    let runs = plan();
    progress(Progress::Judging(runs.len()));
    let judged: Vec<Judged> = runs
        .into_par_iter()
        .map(|run| {
            let judged = judge_run(&experiment, &closed, &diagnoser, run);
            progress(Progress::Judged);
            judged
        })
        .collect::<Result<_, _>>()?;
    let mut study = summarise(options, &experiment, &diagnoser, judged);
    let inputs = experiment.slow_reversals(SLOW_SAMPLES);
    let signals = cosimulated::closed_loop(&closed, &inputs, None::<&mut judge::Watch>)?;
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
}

fn plan() -> Vec<Run> {
    let healthy = (0..HEALTHY_RUNS).map(Run::Healthy);
    let faulty = TorqueReading::ALL.into_iter().flat_map(|reading| {
        let faults = twelve(reading).into_iter().enumerate();
        // The readings share the noise of each fault: they differ in the fault alone.
        faults.map(move |(k, fault)| Run::Faulty(reading, fault, k as u64))
    });
    healthy.chain(faulty).collect()
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
    diagnoser: &Diagnoser,
    run: Run,
) -> Result<Judged, StudyError> {
    let inputs = match &run {
        Run::Healthy(k) => experiment.closed_loop(SAMPLES, Stream::Healthy(*k), None),
        Run::Faulty(_, fault, k) => {
            experiment.closed_loop(SAMPLES, Stream::Faulty(*k), Some(fault))
        }
    };
    let mut watch = diagnoser.watch()?;
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

fn summarise(
    options: &StudyOptions,
    experiment: &Experiment,
    diagnoser: &Diagnoser,
    judged: Vec<Judged>,
) -> Study {
    let healthy: Vec<&Judgement> = judged
        .iter()
        .filter(|judged| matches!(judged.run, Run::Healthy(_)))
        .map(|judged| &judged.judgement)
        .collect();
    let r_fd = ByMethod::from_fn(|method| {
        healthy.iter().map(|j| j.false_rate(method)).sum::<f64>() / healthy.len() as f64
    });
    let alarms =
        ByMethod::from_fn(|method| healthy.iter().map(|j| j.alarms(method, 0..SAMPLES)).sum());
    let rows = |reading: TorqueReading| -> Vec<DetectionRow> {
        Method::ALL
            .into_iter()
            .flat_map(|method| {
                judged.iter().filter_map(move |judged| match &judged.run {
                    Run::Faulty(of, fault, _) if *of == reading => {
                        Some(judged.judgement.row(method, fault))
                    }
                    _ => None,
                })
            })
            .collect()
    };
    let others = TorqueReading::ALL.into_iter().filter(|reading| *reading != options.torque);
    let identification = judged
        .iter()
        .filter_map(|judged| match &judged.run {
            Run::Faulty(of, fault, _) if *of == options.torque => {
                Some(judged.judgement.symptom(fault, diagnoser.constant_threshold()))
            }
            _ => None,
        })
        .collect();
    let noise = &options.drive.noise;
    let per_si = options.drive.sensors.tacho_unit.per_si();
    let results = StudyResults {
        seed: options.seed,
        drive: DriveSummary {
            name: options.drive.name.clone(),
            digest: digest(&options.drive),
            set_point: experiment.set_point * per_si,
            tacho_unit: diagnoser.tacho_unit().to_owned(),
            period_s: experiment.period_s,
        },
        noise: NoiseSummary {
            reference: noise.reference,
            omega: noise.omega,
            i: noise.i,
            torque: noise.torque,
            torque_time: noise.torque_time,
        },
        torque: options.torque,
        beta: options.beta,
        fault_span: FaultSpan { from: SPAN.start, to: SPAN.end },
        window: design::WINDOW,
        detection: rows(options.torque),
        readings: others.map(|torque| ReadingRows { torque, detection: rows(torque) }).collect(),
        healthy: HealthySummary {
            samples: healthy.len() * (SAMPLES - RUN_UP),
            runs: healthy.len(),
            run_up: RUN_UP,
            alarms,
        },
        r_fd,
        model: diagnoser.summary().clone(),
        identification,
        fmu: FmuSummary {
            max_relative_difference_native: judged
                .iter()
                .map(|judged| judged.native)
                .fold(0.0, f64::max),
            fmpy: Vec::new(),
        },
        paper: paper::figures(),
    };
    let mut pictures = Vec::new();
    let mut runs = Vec::new();
    for judged in judged {
        match judged.run {
            Run::Healthy(0) => {
                pictures.push(judged.judgement.picture(None, &judged.signals));
                runs.push(judged.repeatable("healthy".to_owned()));
            }
            Run::Faulty(reading, ref fault, _) if reading == options.torque => {
                pictures.push(judged.judgement.picture(Some(fault), &judged.signals));
                let name = fault.name.file_name();
                runs.push(judged.repeatable(name));
            }
            _ => {}
        }
    }
    Study { results, pictures, runs }
}

/// SHA-256 of the drive file, hexadecimal.
fn digest(drive: &Drive) -> String {
    Sha256::digest(drive.to_toml()).iter().map(|byte| format!("{byte:02x}")).collect()
}
