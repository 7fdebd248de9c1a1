//! Faults of kinds that the bank does not hold: "unknown", or a wrong name.
//!
//! A kind is left out of the bank together with those that act as it does, and then shown to it.

use drivescope_diagnoser::bank::Cause;
use serde::Serialize;

use super::TrialError;
use super::bench::{Bench, fault};
use super::machine::{Group, Plan};
use crate::profile::Profile;
use crate::shares::Share;
use drivescope_monitor::bank::process;

/// Samples of a run after the onset.
const AFTER: usize = 600;

/// A kind of fault that a bank is not told of.
struct Kind {
    what: &'static str,
    left_out: &'static [&'static str],
    /// Mechanisms with their magnitudes.
    acting: &'static [(&'static str, f64)],
    profile: Profile,
}

const STEP: Profile = Profile::Step;
const KINDS: [Kind; 10] = [
    left_out("current_sensor", &["current_sensor"], &[("current_sensor", 0.2)]),
    left_out("current_bias", &["current_bias"], &[("current_bias", 0.3)]),
    left_out("resistance", &["resistance"], &[("resistance", 0.2)]),
    left_out("flux", &["flux"], &[("flux", 0.2)]),
    left_out("tacho", &["tacho", "tacho_bias"], &[("tacho", 0.2)]),
    left_out("actuator", &["actuator", "supply"], &[("actuator", 0.2)]),
    left_out("noise of the tachometer", &[], &[("tacho_noise", 2.0)]),
    left_out("noise of the current sensor", &[], &[("current_noise", 2.0)]),
    left_out("tacho and flux at once", &[], &[("tacho", 0.1), ("flux", 0.1)]),
    Kind {
        what: "loose contact of the tachometer",
        left_out: &[],
        acting: &[("tacho", 0.2)],
        profile: Profile::Intermittent { on_s: 0.05, off_s: 0.05 },
    },
];

const fn left_out(
    what: &'static str,
    left_out: &'static [&'static str],
    acting: &'static [(&'static str, f64)],
) -> Kind {
    Kind { what, left_out, acting, profile: STEP }
}

/// One kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnknownRow {
    /// What fails.
    pub what: String,
    /// What was taken out of the bank.
    pub left_out: Vec<String>,
    /// Machines on which the answer was "unknown".
    pub unknown: Share,
    /// Machines on which something was named.
    pub named: Share,
    /// What was named, most often first, with how often.
    pub names: Vec<(String, usize)>,
}

/// All kinds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unknown {
    pub unknown: Share,
    /// Something was named.
    pub named: Share,
    /// Each kind.
    pub rows: Vec<UnknownRow>,
}

pub(super) fn unknown(bench: &Bench) -> Result<Unknown, TrialError> {
    let rows = KINDS.iter().enumerate().map(|(number, kind)| {
        let known = process(&bench.designed.drive, bench.experiment.period_s, kind.left_out)?;
        let answers = bench.each(Group::Unknown, bench.machines, |machine, _| {
            machine.renew_noise(number);
            let onset = machine.onset(bench);
            let reference = vec![machine.experiment.set_point; onset + AFTER];
            let faults = kind.acting.iter().map(|(id, size)| {
                // Noise does not become less than none.
                let sign = if id.ends_with("noise") { 1.0 } else { machine.sign() };
                fault(id, sign * size, onset, kind.profile)
            });
            let plan = Plan { reference, faults: faults.collect() };
            let rows = machine.rows(&[plan]);
            let seen = bench.seen(known.as_ref(), bench.limits(true), &rows[0], onset);
            seen.judgement.map(|judgement| match judgement.cause {
                Cause::Mechanism(j) => Some(known.mechanisms()[j].id.clone()),
                Cause::Frozen(_) => Some("freeze".to_owned()),
                Cause::Unknown | Cause::Healthy => None,
            })
        });
        Ok(row(kind, &answers))
    });
    let rows = rows.collect::<Result<Vec<UnknownRow>, TrialError>>()?;
    let sum = |share: fn(&UnknownRow) -> Share| {
        let (hits, of) = rows.iter().map(share).fold((0, 0), |(h, n), it| (h + it.hits, n + it.of));
        Share::new(hits, of)
    };
    Ok(Unknown { unknown: sum(|row| row.unknown), named: sum(|row| row.named), rows })
}

/// Answers: nothing said, unknown, or a name.
fn row(kind: &Kind, answers: &[Option<Option<String>>]) -> UnknownRow {
    let n = answers.len();
    let mut names: Vec<(String, usize)> = Vec::new();
    for name in answers.iter().flatten().flatten() {
        match names.iter_mut().find(|(known, _)| known == name) {
            Some((_, count)) => *count += 1,
            None => names.push((name.clone(), 1)),
        }
    }
    names.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let named: usize = names.iter().map(|(_, count)| count).sum();
    let unknown = answers.iter().filter(|it| matches!(it, Some(None))).count();
    UnknownRow {
        what: kind.what.to_owned(),
        left_out: kind.left_out.iter().map(|id| (*id).to_owned()).collect(),
        unknown: Share::new(unknown, n),
        named: Share::new(named, n),
        names,
    }
}
