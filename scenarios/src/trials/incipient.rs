//! Faults that grow: how large they are when they are detected.

use drivescope_diagnoser::bank::Limits;
use serde::Serialize;

use super::bench::{Bench, fault, set};
use super::delays::first_over;
use super::machine::{Group, Plan};
use crate::profile::Profile;
use crate::shares::{Share, Spread};

/// Full size, and samples over which it is reached.
const FULL: f64 = 0.2;
const OVER: usize = 1000;
/// Mean samples between false alarms.
const ARL_0: f64 = 1e5;
/// The mechanisms, each with the size by which it is to be detected.
const MECHANISMS: [(&str, f64); 4] =
    [("tacho", 0.01), ("flux", 0.015), ("actuator", 0.015), ("load", 0.2)];

/// One mechanism that grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Incipient {
    pub mechanism: String,
    /// Designed mean samples between false alarms.
    pub arl_0: f64,
    /// Size at the alarm.
    pub size: Spread,
    /// Size by which it is to be detected.
    pub by: f64,
    /// Machines on which it was.
    pub in_time: Share,
    /// Machines on which the first judgement has it in its printed set.
    pub in_set: Share,
    /// The same of a detector that always alarms: nothing, for it does so before the fault.
    pub always: Share,
}

pub(super) fn incipient(bench: &Bench) -> Vec<Incipient> {
    let always = Limits { ratio: 0.0, squares: 0.0 };
    let limits = [bench.designed.tails.limits(ARL_0), always];
    let over_s = OVER as f64 * bench.experiment.period_s;
    let found = bench.each(Group::Incipient, bench.machines, |machine, _| {
        let onset = machine.onset(bench);
        let plans = MECHANISMS.map(|(kind, _)| Plan {
            reference: vec![machine.experiment.set_point; onset + OVER],
            faults: vec![fault(kind, machine.sign() * FULL, onset, Profile::Ramp { over_s })],
        });
        let process = bench.designed.process.as_ref();
        let runs = machine.rows(&plans);
        let of_run = |(rows, (kind, _)): (&Vec<_>, (&str, f64))| {
            let judgement = bench.seen(process, bench.limits(true), rows, onset).judgement;
            let named = judgement.is_some_and(|it| set(process, &it).iter().any(|id| id == kind));
            (first_over(bench, process, &limits, rows, onset), named)
        };
        runs.iter().zip(MECHANISMS).map(of_run).collect::<Vec<_>>()
    });
    let row = |(number, (mechanism, by)): (usize, &(&str, f64))| {
        let sizes = |which: usize| -> Vec<f64> {
            let delays = found.iter().filter_map(|machine| machine[number].0[which]);
            delays.map(|delay| FULL * delay as f64 / OVER as f64).collect()
        };
        let in_time = |which: usize| {
            let hits = sizes(which).into_iter().filter(|size| size <= by).count();
            Share::new(hits, found.len())
        };
        Incipient {
            mechanism: (*mechanism).to_owned(),
            arl_0: ARL_0,
            by: *by,
            size: Spread::of(sizes(0)),
            in_time: in_time(0),
            in_set: {
                let named = found.iter().filter(|machine| machine[number].1).count();
                Share::new(named, found.len())
            },
            always: in_time(1),
        }
    };
    MECHANISMS.iter().enumerate().map(row).collect()
}
