//! Ten mechanisms at random size and set point: detected, within the printed set, how large.

use drivescope_plant::sampled::rated_torque;
use rand::RngExt;
use serde::Serialize;

use super::bench::{Bench, fault, set};
use super::machine::{Group, Machine, Plan};
use crate::profile::Profile;
use crate::shares::Share;

/// The mechanisms. An inertia does not show at a constant speed, and the supply acts as the
/// amplifier does but for its limit.
const KINDS: [&str; 10] = [
    "tacho",
    "flux",
    "torque_constant",
    "actuator",
    "load",
    "resistance",
    "friction",
    "current_sensor",
    "tacho_bias",
    "current_bias",
];
/// Set points as shares of that of the design: the second and third were never shown.
const SET_POINTS: [f64; 3] = [1.0, 0.5, 1.25];
/// Magnitudes are drawn between these with even logarithms: of a fraction, and for a bias as shares of
/// the speed of the design and of the rated current.
const SIZES: (f64, f64) = (0.01, 0.2);
/// Where bands of sizes meet.
const BANDS: [f64; 4] = [0.01, 0.03, 0.08, 0.2];
/// Samples of a run after the onset: small faults are found late.
const AFTER: usize = 2000;
/// Mechanisms whose sizes have a bar of their own.
const SIZED: [&str; 3] = ["tacho", "flux", "actuator"];

/// Estimated sizes against the true ones, where the answer is not "unknown".
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sizes {
    /// What is estimated.
    pub what: String,
    /// Root mean square of the errors, in percentage points; absent where nothing was estimated.
    pub rms_points: Option<f64>,
    /// 95 % intervals that hold the true size.
    pub covered: Share,
}

/// Some of the cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MechanismRow {
    pub what: String,
    /// Cases in which a fault was declared.
    pub detected: Share,
    /// Of the declared: truth within the printed set.
    pub in_set: Share,
    /// Of all cases, undeclared ones counted as misses.
    pub in_set_of_all: Share,
    /// Size, as a fraction, from which on nine in ten are declared; none if there is none.
    pub declared_from: Option<f64>,
    /// Of the declared: truth named first.
    pub named: Share,
    /// Mean number of mechanisms in the printed set.
    pub set_size: f64,
}

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mechanisms {
    /// All cases, then those of each mechanism, set point and band of sizes.
    pub rows: Vec<MechanismRow>,
    /// All but the mechanism whose effect the random load hides.
    pub sizes: Vec<Sizes>,
    /// Truth of the next mechanism within the printed set: must collapse.
    pub shuffled: Share,
}

struct Case {
    kind: usize,
    set_point: usize,
    /// As a share of the scale.
    share: f64,
    /// Mechanisms of the printed set, the named first; nothing where no fault was declared. Empty
    /// where it is unknown.
    set: Option<Vec<String>>,
    /// Error of the size and half the interval, in the same shares.
    error: Option<(f64, f64)>,
}

pub(super) fn mechanisms(bench: &Bench) -> Mechanisms {
    let cases: Vec<Case> = bench
        .each(Group::Mechanisms, bench.machines, |machine, _| {
            let each =
                (0..SET_POINTS.len()).map(|set_point| of_set_point(bench, machine, set_point));
            each.collect::<Vec<_>>()
        })
        .into_iter()
        .flatten()
        .flatten()
        .collect();
    let every: Vec<&Case> = cases.iter().collect();
    let only = |keep: &dyn Fn(&Case) -> bool| -> Vec<&Case> {
        cases.iter().filter(|case| keep(case)).collect()
    };
    let mut rows = vec![row("all", &every)];
    for (number, kind) in KINDS.iter().enumerate() {
        rows.push(row(kind, &only(&|case| case.kind == number)));
    }
    for (number, share) in SET_POINTS.iter().enumerate() {
        let what = format!("{share} of the set point shown");
        rows.push(row(&what, &only(&|case| case.set_point == number)));
    }
    for band in BANDS.windows(2) {
        let what = format!("{} to {} %", 100.0 * band[0], 100.0 * band[1]);
        rows.push(row(&what, &only(&|case| (band[0]..band[1]).contains(&case.share))));
    }
    let mut sizes = vec![sized("all", &every)];
    for kind in SIZED {
        sizes.push(sized(kind, &only(&|case| KINDS[case.kind] == kind)));
    }
    let next = |case: &Case| KINDS[(case.kind + KINDS.len() / 2) % KINDS.len()];
    let shuffled = within(&every, next);
    Mechanisms { rows, sizes, shuffled }
}

/// What a fraction of 1 is, in the unit of a mechanism.
fn scale(bench: &Bench, kind: &str) -> f64 {
    let drive = &bench.experiment.drive;
    match kind {
        "tacho_bias" => bench.experiment.set_point,
        "current_bias" => rated_torque(drive).unwrap_or(0.0) / drive.motor.k_m,
        _ => 1.0,
    }
}

fn of_set_point(bench: &Bench, machine: &mut Machine, set_point: usize) -> Vec<Case> {
    machine.renew_noise(set_point);
    let onset = machine.onset(bench);
    let speed = SET_POINTS[set_point] * bench.experiment.set_point;
    let shares = KINDS.map(|_| {
        let (least, most) = SIZES;
        let uniform: f64 = machine.random.random();
        machine.sign() * least * (most / least).powf(uniform)
    });
    let plans: Vec<Plan> = KINDS
        .iter()
        .zip(shares)
        .map(|(kind, share)| Plan {
            reference: vec![speed; onset + AFTER],
            faults: vec![fault(kind, share * scale(bench, kind), onset, Profile::Step)],
        })
        .collect();
    let runs = machine.rows(&plans);
    let process = bench.designed.process.as_ref();
    let id = |j: usize| process.mechanisms()[j].id.clone();
    let of_run = |(kind, rows): (usize, &Vec<_>)| {
        let judgement = bench.seen(process, bench.limits(true), rows, onset).judgement;
        let set = judgement.as_ref().map(|judgement| set(process, judgement));
        // To what is unknown no size is told.
        let told = judgement.iter().filter(|it| it.named().is_some());
        let mut candidates = told.flat_map(|judgement| &judgement.candidates);
        let scale = scale(bench, KINDS[kind]);
        let error = candidates.find(|it| id(it.mechanism) == KINDS[kind]).map(|it| {
            let [low, high] = it.interval();
            (it.size / scale - shares[kind], 0.5 * (high - low) / scale)
        });
        Case { kind, set_point, share: shares[kind].abs(), set, error }
    };
    runs.iter().enumerate().map(of_run).collect()
}

/// Of the declared, those whose printed set holds a mechanism.
fn within(cases: &[&Case], truth: impl Fn(&Case) -> &'static str) -> Share {
    let sets = cases.iter().filter_map(|case| Some((case, case.set.as_ref()?)));
    let hits: Vec<bool> = sets.map(|(case, set)| set.iter().any(|id| id == truth(case))).collect();
    Share::new(hits.iter().filter(|hit| **hit).count(), hits.len())
}

fn row(what: &str, cases: &[&Case]) -> MechanismRow {
    let sets: Vec<(&str, &Vec<String>)> =
        cases.iter().filter_map(|case| Some((KINDS[case.kind], case.set.as_ref()?))).collect();
    let first = sets.iter().filter(|(kind, set)| set.first().is_some_and(|it| it == kind));
    let members: usize = sets.iter().map(|(_, set)| set.len()).sum();
    MechanismRow {
        what: what.to_owned(),
        detected: Share::new(sets.len(), cases.len()),
        in_set: within(cases, |case| KINDS[case.kind]),
        in_set_of_all: Share::new(within(cases, |case| KINDS[case.kind]).hits, cases.len()),
        declared_from: declared_from(cases),
        named: Share::new(first.count(), sets.len()),
        set_size: members as f64 / sets.len() as f64,
    }
}

/// The least size of which, and of all larger ones, nine in ten are declared.
fn declared_from(cases: &[&Case]) -> Option<f64> {
    const DECLARED: f64 = 0.9;
    /// Fewer cases at the top tell no share.
    const FEWEST: usize = 10;
    let mut by_size: Vec<(f64, bool)> =
        cases.iter().map(|case| (case.share, case.set.is_some())).collect();
    by_size.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (mut declared, mut least) = (0, None);
    for (count, (size, is_declared)) in by_size.iter().enumerate() {
        declared += usize::from(*is_declared);
        if count + 1 >= FEWEST && declared as f64 >= DECLARED * (count + 1) as f64 {
            least = Some(*size);
        }
    }
    least
}

fn sized(what: &str, cases: &[&Case]) -> Sizes {
    let errors: Vec<(f64, f64)> = cases.iter().filter_map(|case| case.error).collect();
    let n = errors.len();
    let squares: f64 = errors.iter().map(|(error, _)| error * error).sum();
    let covered = errors.iter().filter(|(error, half)| error.abs() <= *half).count();
    Sizes {
        what: what.to_owned(),
        rms_points: (n > 0).then(|| 100.0 * (squares / n as f64).sqrt()),
        covered: Share::new(covered, n),
    }
}
