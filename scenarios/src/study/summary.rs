//! The study's runs put together into its results.

use drivescope_diagnoser::{Confidence, size_groups};
use drivescope_plant::drive::Drive;
use sha2::{Digest, Sha256};

use super::design::{Designed, WINDOW};
use super::judge::Judgement;
use super::signals::Signals;
use super::{Judged, RUN_UP, Run, SAMPLES, Study, StudyError, StudyOptions, isolation, paper};
use crate::experiment::Experiment;
use crate::faults::{Fault, SPAN};
use crate::results::{
    ByDetector, DetectionRow, DetectorKind, DriveSummary, FaultName, FaultSpan, FmuSummary,
    FurtherRun, HealthySummary, IdentificationRow, LevelRows, NoiseSummary, ReadingRows,
    StudyResults, TheoremSummary, TorqueReading,
};

/// Significance levels of the tables, beside the one that was asked for.
const LEVELS: [f64; 2] = [0.05, 0.01];

/// Everything that depends on the significance level.
struct Level {
    r_fd: ByDetector,
    alarms: ByDetector<usize>,
    detection: Vec<DetectionRow>,
    readings: Vec<ReadingRows>,
}

/// The tables of one level, all judgements taken at it.
fn level(judged: &[Judged], torque: TorqueReading, at: impl Fn(&Judgement) -> Judgement) -> Level {
    let at: Vec<Judgement> = judged.iter().map(|judged| at(&judged.judgement)).collect();
    let runs = || judged.iter().zip(&at).map(|(judged, judgement)| (&judged.run, judgement));
    let healthy: Vec<&Judgement> =
        runs().filter(|(run, _)| matches!(run, Run::Healthy(_))).map(|(_, j)| j).collect();
    let count = healthy.len() as f64;
    let rows = |reading: TorqueReading| -> Vec<DetectionRow> {
        let of_method = |method| {
            runs().filter_map(move |(run, judgement)| match run {
                Run::Faulty(of, fault, _) if *of == reading => Some(judgement.row(method, fault)),
                _ => None,
            })
        };
        DetectorKind::ALL.into_iter().flat_map(of_method).collect()
    };
    let others = TorqueReading::ALL.into_iter().filter(|reading| *reading != torque);
    Level {
        r_fd: ByDetector::from_fn(|m| healthy.iter().map(|j| j.false_rate(m)).sum::<f64>() / count),
        alarms: ByDetector::from_fn(|m| healthy.iter().map(|j| j.alarms(m)).sum()),
        detection: rows(torque),
        readings: others.map(|torque| ReadingRows { torque, detection: rows(torque) }).collect(),
    }
}

/// The rows of the runs beside the twelve.
fn further(judged: &[Judged]) -> Vec<FurtherRun> {
    let of = |judged: &Judged| {
        let Run::Further(name, faults, _) = &judged.run else { return None };
        // What counts is that something is declared: the span is that of all of them.
        let fault = faults.first()?;
        let rows = DetectorKind::ALL.into_iter().map(|method| {
            let row = judged.judgement.row(method, fault);
            DetectionRow { fault: FaultName { label: name.clone(), ..row.fault }, ..row }
        });
        Some(FurtherRun { faults: name.clone(), detection: rows.collect() })
    };
    judged.iter().filter_map(of).collect()
}

/// The rows of Table 3.
fn identification(
    judged: &[(&Fault, Signals, &Judgement)],
) -> Result<Vec<IdentificationRow>, StudyError> {
    let sizes = judged.iter().map(|(fault, _, judgement)| judgement.symptom(fault));
    let sizes = sizes.collect::<Result<Vec<f64>, _>>()?;
    let groups = size_groups(&sizes).into_iter();
    let row = |((s, group), (fault, _, _)): ((f64, _), &(&Fault, Signals, &Judgement))| {
        let label = &fault.name.label;
        IdentificationRow {
            fault: fault.name.clone(),
            s,
            s_paper: paper::symptom(label),
            group,
            group_paper: paper::group(label),
        }
    };
    Ok(sizes.into_iter().zip(groups).zip(judged).map(row).collect())
}

pub(super) fn summarise(
    options: &StudyOptions,
    experiment: &Experiment,
    designed: &Designed,
    judged: Vec<Judged>,
    theorem: TheoremSummary,
) -> Result<Study, StudyError> {
    let faulty: Vec<(&Fault, Signals, &Judgement)> = judged
        .iter()
        .filter_map(|judged| match &judged.run {
            Run::Faulty(of, fault, _) if *of == options.torque => {
                Some((fault, Signals::of(&judged.signals), &judged.judgement))
            }
            _ => None,
        })
        .collect();
    let isolated = isolation::isolate(experiment, &designed.diagnoser, options.torque, &faulty)?;
    let identification = identification(&faulty)?;
    let own = designed.diagnoser.confidence;
    let Level { r_fd, alarms, detection, readings } =
        level(&judged, options.torque, Judgement::clone);
    let mut levels = Vec::new();
    for beta in LEVELS.into_iter().filter(|beta| *beta != options.beta) {
        let factor = Confidence::new(beta)?.t_beta() / own.t_beta();
        let Level { r_fd, alarms, detection, readings } =
            level(&judged, options.torque, |judgement| judgement.at_level(factor));
        levels.push(LevelRows { beta, r_fd, alarms, detection, readings });
    }
    let healthy_runs = judged.iter().filter(|j| matches!(j.run, Run::Healthy(_))).count();
    let noise = &options.drive.noise;
    let per_si = options.drive.sensors.tacho_unit.per_si();
    let results = StudyResults {
        hidden_effect: None,
        seed: options.seed,
        drive: DriveSummary {
            name: options.drive.name.clone(),
            digest: digest(&options.drive),
            set_point: experiment.set_point * per_si,
            tacho_unit: experiment.tacho_unit().to_owned(),
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
        profile: options.profile.to_string(),
        window: WINDOW,
        detection,
        readings,
        further: further(&judged),
        levels,
        healthy: HealthySummary {
            samples: healthy_runs * (SAMPLES - RUN_UP),
            runs: healthy_runs,
            run_up: RUN_UP,
            alarms,
        },
        r_fd,
        model: designed.summary.clone(),
        structures: designed.structures.clone(),
        theorem,
        symptoms: isolated.symptoms,
        separability: isolated.separability,
        isolation: isolated.twelve,
        isolation_paper: isolated.paper,
        isolation_merged: isolated.merged,
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
    Ok(Study { results, pictures, runs })
}

/// SHA-256 of the drive file, hexadecimal.
fn digest(drive: &Drive) -> String {
    Sha256::digest(drive.to_toml()).iter().map(|byte| format!("{byte:02x}")).collect()
}
