//! The twelve faults told apart in a window of one horizon, by the whole bank and among the twelve.

use drivescope_diagnoser::bank::{Candidate, Cause, Judgement};
use serde::Serialize;

use super::bench::{Bench, with_or_without};
use super::machine::{Group, Plan};
use crate::faults::{Fault, twelve};
use crate::results::{FaultName, TorqueReading};
use crate::shares::Share;

/// Samples of a run after the onset: a horizon, and time for an alarm that comes late.
const AFTER: usize = 300;

/// One of the twelve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassRow {
    pub fault: FaultName,
    /// Machines on which the bank named it, of all its mechanisms, and its size is nearest.
    pub named: Share,
    /// The same where only the twelve are in question.
    pub among_twelve: Share,
}

/// The twelve faults with some signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassTable {
    /// All twelve together.
    pub named: Share,
    /// The same where only the twelve are in question.
    pub among_twelve: Share,
    /// Answers held against the truth of the next fault: must collapse.
    pub shuffled: Share,
    pub rows: Vec<ClassRow>,
}

/// With the current and without.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Classes {
    /// C_m, T, I_m.
    pub with_current: ClassTable,
    /// C_m, T.
    pub without_current: ClassTable,
}

/// What was answered to a fault: by the whole bank, and among the twelve.
type Answer = [Option<usize>; 2];

pub(super) fn classes(bench: &Bench) -> Classes {
    let faults = twelve(TorqueReading::Flux);
    let answers = bench.each(Group::Classes, bench.machines, |machine, _| {
        let onset = machine.onset(bench);
        let reference = vec![machine.experiment.set_point; onset + AFTER];
        let plan = |fault: &Fault| Plan {
            reference: reference.clone(),
            faults: vec![Fault { from: onset, until: usize::MAX, ..fault.clone() }],
        };
        let plans: Vec<Plan> = faults.iter().map(plan).collect();
        let runs = machine.rows(&plans);
        [true, false].map(|with_current| {
            let of_run = |rows: &Vec<_>| {
                let rows = with_or_without(rows, with_current);
                let process = bench.designed.process.as_ref();
                let limits = bench.limits(with_current);
                let seen = bench.seen(process, limits, &rows, onset);
                seen.judgement.map_or([None; 2], |it| answer(bench, &faults, &it))
            };
            runs.iter().map(of_run).collect::<Vec<Answer>>()
        })
    });
    let [with_current, without_current] = [0, 1].map(|which| {
        let of: Vec<&Vec<Answer>> = answers.iter().map(|both| &both[which]).collect();
        table(&faults, &of)
    });
    Classes { with_current, without_current }
}

/// The class of the named mechanism, and that of the likeliest of the twelve.
fn answer(bench: &Bench, faults: &[Fault], judgement: &Judgement) -> Answer {
    let mechanisms = bench.designed.process.mechanisms();
    let class = |of: &Candidate| {
        let id = &mechanisms[of.mechanism].id;
        let same = faults.iter().enumerate().filter(|(_, fault)| fault.name.kind == *id);
        let off = |fault: &Fault| (fault.name.size - of.size).abs();
        same.min_by(|a, b| off(a.1).total_cmp(&off(b.1))).map(|(class, _)| class)
    };
    let named = match judgement.cause {
        Cause::Mechanism(_) => judgement.candidates.first().and_then(class),
        Cause::Healthy | Cause::Frozen(_) | Cause::Unknown => None,
    };
    [named, judgement.candidates.iter().find_map(class)]
}

fn table(faults: &[Fault], machines: &[&Vec<Answer>]) -> ClassTable {
    let (n, all) = (machines.len(), faults.len());
    let right = |which: usize, truth: usize, class: usize| {
        machines.iter().filter(|answers| answers[class][which] == Some(truth)).count()
    };
    let whole = |which: usize, shift: usize| {
        let hits = (0..all).map(|class| right(which, (class + shift) % all, class)).sum();
        Share::new(hits, all * n)
    };
    let rows = faults.iter().enumerate().map(|(class, fault)| ClassRow {
        fault: fault.name.clone(),
        named: Share::new(right(0, class, class), n),
        among_twelve: Share::new(right(1, class, class), n),
    });
    ClassTable {
        named: whole(0, 0),
        among_twelve: whole(1, 0),
        shuffled: whole(1, 1),
        rows: rows.collect(),
    }
}

impl ClassTable {
    /// The fault that is named least often, by the whole bank or among the twelve.
    pub fn worst(&self, share: fn(&ClassRow) -> Share) -> Option<(&FaultName, Share)> {
        let rows = self.rows.iter().map(|row| (&row.fault, share(row)));
        rows.min_by(|a, b| a.1.share.total_cmp(&b.1.share))
    }
}
