//! How a diagnoser does over many draws of the noise: the published detection figures, measured
//! again with their spread, and the same figures of two detectors that are broken on purpose.
//!
//! The diagnoser is trained and designed once, on runs of the experiment's seed. It is judged on
//! runs of other seeds: of each one healthy run and the twelve faults. The drive runs natively,
//! which the FMU repeats bit for bit.

use rayon::prelude::*;
use serde::Serialize;

use crate::cosimulated::Follower;
use crate::experiment::{Experiment, Stream};
use crate::faults::{Fault, twelve};
use crate::native::ClosedLoops;
use crate::results::{ByDetector, DetectionRow, DetectorKind, FaultName, TorqueReading};
pub use crate::shares::{Share, Spread};
use crate::study::{
    Designed, Judgement, SAMPLES, Signals, StudyError, Watch, false_rate_of, row_of,
};

/// A fault of this detection time or less counts as found in time (the paper's 4057 and the like).
pub const IN_TIME: usize = 4060;

/// One fault under one method, over all seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultRow {
    pub fault: FaultName,
    /// Seeds in which it was declared, with no false alarm before it.
    pub detected: Share,
    /// Seeds in which t_dt was at most [`IN_TIME`].
    pub in_time: Share,
    pub r_td: Spread,
    /// t_dt over the seeds in which it was declared.
    pub t_dt: Spread,
}

/// One method over all seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodRows {
    pub method: DetectorKind,
    /// Seeds in which all twelve faults were detected.
    pub all_detected: Share,
    /// r_fd over the seeds' healthy runs.
    pub r_fd: Spread,
    /// Seeds whose healthy run had no fault declared.
    pub silent: Share,
    /// The twelve faults.
    pub faults: Vec<FaultRow>,
}

/// The figures of detectors that are broken on purpose: they must collapse.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Broken {
    /// A detector whose bands have no width: r_td looks perfect,
    pub always_r_td: f64,
    /// and so does its r_fd,
    pub always_r_fd: f64,
    /// and no fault counts as detected, since a declaration stands before it begins.
    pub always_detected: Share,
    /// Labels shuffled, healthy runs called faulty: r_td is r_fd,
    pub shuffled_r_td: f64,
    /// and nothing is detected.
    pub shuffled_detected: Share,
}

/// The table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parity {
    /// Seed of training and design.
    pub design_seed: u64,
    /// First seed of the judged runs; the others follow it.
    pub first_seed: u64,
    /// Judged seeds.
    pub seeds: u64,
    /// Reading of the torque faults.
    pub torque: TorqueReading,
    /// Significance level.
    pub beta: f64,
    /// Healthy samples that the widths were measured on.
    pub design_samples: usize,
    /// Healthy samples judged in all.
    pub healthy_samples: usize,
    pub methods: Vec<MethodRows>,
    /// Model error modelling, broken.
    pub broken: Broken,
}

/// What one seed gave.
struct OfSeed {
    faults: Vec<ByDetector<DetectionRow>>,
    r_fd: ByDetector,
    alarms: ByDetector<usize>,
    always: (Vec<DetectionRow>, f64),
    shuffled: DetectionRow,
}

/// Judges a diagnoser over `seeds` seeds after that of the experiment it was designed on.
///
/// # Errors
/// A sample that cannot be judged.
pub fn parity(
    designed: &Designed,
    experiment: &Experiment,
    torque: TorqueReading,
    seeds: u64,
    progress: &(dyn Fn() + Sync),
) -> Result<Parity, StudyError> {
    let faults = twelve(torque);
    let first_seed = experiment.seed.wrapping_add(1);
    let of_seeds = (0..seeds)
        .into_par_iter()
        .map(|k| {
            let seed = first_seed.wrapping_add(k);
            let experiment = experiment.with_seed(seed);
            let found = of_seed(designed, &experiment, &faults);
            progress();
            found
        })
        .collect::<Result<Vec<_>, _>>()?;
    let methods = DetectorKind::ALL.map(|method| method_rows(method, &faults, &of_seeds));
    let n = of_seeds.len();
    let mean =
        |values: &dyn Fn(&OfSeed) -> f64| of_seeds.iter().map(values).sum::<f64>() / n as f64;
    let twelve = faults.len() as f64;
    let always_hits: usize =
        of_seeds.iter().map(|s| s.always.0.iter().filter(|row| row.detected()).count()).sum();
    let broken = Broken {
        always_r_td: mean(&|s| s.always.0.iter().map(|row| row.r_td).sum::<f64>() / twelve),
        always_r_fd: mean(&|s| s.always.1),
        always_detected: Share::new(always_hits, n * faults.len()),
        shuffled_r_td: mean(&|s| s.shuffled.r_td),
        shuffled_detected: Share::new(of_seeds.iter().filter(|s| s.shuffled.detected()).count(), n),
    };
    Ok(Parity {
        design_seed: experiment.seed,
        first_seed,
        seeds,
        torque,
        beta: designed.diagnoser.confidence.beta(),
        design_samples: designed.summary.design_samples,
        healthy_samples: n * (SAMPLES - designed.diagnoser.run_up),
        methods: methods.into(),
        broken,
    })
}

fn of_seed(
    designed: &Designed,
    experiment: &Experiment,
    faults: &[Fault],
) -> Result<OfSeed, StudyError> {
    let healthy = experiment.closed_loop(SAMPLES, Stream::Healthy(0), None);
    let faulty = faults
        .iter()
        .zip(0..)
        .map(|(fault, k)| experiment.closed_loop(SAMPLES, Stream::Faulty(k), Some(fault)));
    let inputs: Vec<_> = std::iter::once(healthy).chain(faulty).collect();
    let mut loops = ClosedLoops::new(&experiment.drive);
    let judge = |run| -> Result<Judgement, StudyError> {
        let Signals { c_m, t } = Signals::of(run);
        let mut watch = Watch::new(&designed.diagnoser)?;
        c_m.iter().zip(&t).try_for_each(|(c_m, t)| watch.sample(*c_m, *t))?;
        Ok(watch.judgement())
    };
    let judged = loops.run(&inputs).iter().map(judge).collect::<Result<Vec<_>, _>>()?;
    let (healthy, faulty) = (&judged[0], &judged[1..]);
    let always = |judgement: &Judgement| judgement.trace(DetectorKind::Mem).with_bands_scaled(0.0);
    let row = |(fault, judgement): (&Fault, &Judgement)| {
        ByDetector::from_fn(|method| judgement.row(method, fault))
    };
    let always_rows = faults
        .iter()
        .zip(faulty)
        .map(|(fault, judgement)| row_of(&always(judgement), DetectorKind::Mem, fault));
    Ok(OfSeed {
        faults: faults.iter().zip(faulty).map(row).collect(),
        r_fd: ByDetector::from_fn(|method| healthy.false_rate(method)),
        alarms: ByDetector::from_fn(|method| healthy.alarms(method)),
        always: (always_rows.collect(), false_rate_of(&always(healthy))),
        shuffled: healthy.row(DetectorKind::Mem, &faults[0]),
    })
}

fn method_rows(method: DetectorKind, faults: &[Fault], seeds: &[OfSeed]) -> MethodRows {
    let n = seeds.len();
    let count =
        |hit: &dyn Fn(&OfSeed) -> bool| Share::new(seeds.iter().filter(|s| hit(s)).count(), n);
    let fault = |(k, fault): (usize, &Fault)| {
        let rows = || seeds.iter().map(move |seed| seed.faults[k].get(method));
        FaultRow {
            fault: fault.name.clone(),
            detected: count(&|seed| seed.faults[k].get(method).detected()),
            in_time: count(&|seed| {
                let row = seed.faults[k].get(method);
                row.detected() && row.t_dt.is_some_and(|t_dt| t_dt <= IN_TIME)
            }),
            r_td: Spread::of(rows().map(|row| row.r_td)),
            t_dt: Spread::of(rows().filter_map(|row| row.t_dt).map(|t_dt| t_dt as f64)),
        }
    };
    MethodRows {
        method,
        all_detected: count(&|seed| seed.faults.iter().all(|row| row.get(method).detected())),
        r_fd: Spread::of(seeds.iter().map(|seed| seed.r_fd.of(method))),
        silent: count(&|seed| seed.alarms.of(method) == 0),
        faults: faults.iter().enumerate().map(fault).collect(),
    }
}
