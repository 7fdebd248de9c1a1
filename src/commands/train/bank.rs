//! The bank of a training: noise and limits for a drive whose equations are known.

use drivescope_diagnoser::bank::{
    BankDesign, Calibration, Event, Mechanism, Row, Separation, Verified,
};
use drivescope_monitor::bank::{self, AnyProcess, Columns, Designed, without_current};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use crate::answer::train::{BankAnswer, Confusion, Separable, VerifiedAnswer};
use crate::failure::{Failure, into_report};
use crate::interrupt;

/// Share of the alarms seen in the healthy recordings that the design foresees, below which the
/// drive model is not theirs.
const FORESEEN: f64 = 0.05;
/// Changes of the control effort that are tried for a confusion set, the mildest first.
const CHANGES: [f64; 6] = [0.75, 1.25, 0.5, 1.5, 0.0, -1.0];
/// Size at which mechanisms are compared: of a fraction, or as a share of the greatest bias.
const COMPARED: f64 = 0.1;

/// Designs the bank of a drive on healthy recordings.
///
/// # Errors
/// A drive or recordings that make no bank, in words.
pub(super) fn design(
    (text, known): &(String, Drive),
    healthy: &[Recording],
    (arl_0, verified, seed): (f64, usize, u64),
) -> miette::Result<(BankDesign, BankAnswer)> {
    let not = |what: String, instead: &str| Failure::Usage { what, instead: instead.to_owned() };
    if !(arl_0.is_finite() && arl_0 >= 1e3) {
        let what = format!("--arl0 {arl_0}: not a mean number of samples between false alarms");
        return Err(not(what, "give 1000 or more; 1e6 is usual").into());
    }
    let period_s = healthy[0].period_s;
    let mut runs: Vec<Vec<Row>> = Vec::new();
    for recording in healthy {
        let words = |error| {
            not(format!("{}: {error}", recording.name), "record it, or name it with --columns")
        };
        for part in recording.parts() {
            runs.push(Columns::of(&part).map_err(words)?.1);
        }
    }
    let designed = bank::design(known, period_s, &runs, seed).map_err(into_report)?;
    interrupt::check()?;
    let Designed { noise, drive: known, process, tails, tails_without_current, how } = designed;
    let limits = tails.limits(arl_0);
    let fresh = Calibration { samples: verified, seed: seed.wrapping_add(1), ..how };
    let verified = process.verify(limits, &fresh).map_err(into_report)?;
    let design = BankDesign {
        period_s,
        arl_0,
        horizon: how.horizon,
        baseline: how.baseline,
        drive: text.clone(),
        limits,
        limits_without_current: tails_without_current.map(|tails| tails.limits(arl_0)),
        noise,
    };
    let (recorded, recorded_alarms) = recorded(process.as_ref(), healthy, &runs, &design)?;
    let answer = BankAnswer {
        drive: known.name.clone(),
        noise,
        arl_0,
        limits,
        horizon_samples: design.horizon,
        baseline_samples: design.baseline,
        verified: VerifiedAnswer {
            samples: verified.samples,
            alarms: verified.alarms,
            arl_0_at_least: Verified::arl_0_at_least(&verified),
            recorded,
            recorded_alarms,
        },
        confusions: confusions(process.as_ref(), &runs, &design),
    };
    Ok((design, answer))
}

/// Healthy samples beyond the baselines of the recordings, and alarms in them.
fn recorded(
    process: &dyn AnyProcess,
    healthy: &[Recording],
    runs: &[Vec<Row>],
    design: &BankDesign,
) -> miette::Result<(usize, usize)> {
    let (mut samples, mut alarms, mut learned) = (0, 0, 0);
    for rows in runs.iter().filter(|rows| rows.len() > design.baseline) {
        let (baseline, rows) = rows.split_at(design.baseline);
        let watch = process.learn(baseline, design.limits, design.horizon);
        let mut watch = watch.map_err(|error| Failure::Usage {
            what: format!("the healthy recordings make no bank: {error}"),
            instead: "fit the drive to them (drivescope fit DRIVE REC), or let discover find what \
                      it lacks"
                .to_owned(),
        })?;
        learned += 1;
        samples += rows.len();
        alarms +=
            rows.iter().filter(|row| matches!(watch.step(row), Some(Event::Alarm(_)))).count();
    }
    if learned == 0 {
        let needed = design.baseline as f64 * design.period_s;
        return Err(Failure::Usage {
            what: format!("{}: a bank learns a machine from {needed:.1} s", healthy[0].name),
            instead: "give a longer healthy recording".to_owned(),
        }
        .into());
    }
    let foreseen = samples as f64 / design.arl_0;
    if foreseen < FORESEEN * alarms as f64 {
        return Err(Failure::Usage {
            what: format!(
                "the drive model raises {alarms} alarms in {:.0} s of the healthy recordings",
                samples as f64 * design.period_s
            ),
            instead: "fit the drive to them (drivescope fit DRIVE REC), or let discover find what \
                      it lacks"
                .to_owned(),
        }
        .into());
    }
    Ok((samples, alarms))
}

/// Which mechanisms are confused at the end of the first run.
fn confusions(process: &dyn AnyProcess, runs: &[Vec<Row>], design: &BankDesign) -> Vec<Confusion> {
    let learned = |rows: &[Row]| process.learn(rows, design.limits, design.horizon).ok();
    let long = runs.iter().filter(|rows| rows.len() >= design.baseline);
    let first = |rows: &Vec<Row>| rows[..design.baseline].to_vec();
    let Some(rows) = long.map(first).next() else { return Vec::new() };
    let Some(watch) = learned(&rows) else { return Vec::new() };
    let Some(with) = watch.separation(&rows) else { return Vec::new() };
    let through: Vec<(Separation, f64)> =
        CHANGES.iter().filter_map(|by| watch.separation_through(&rows, *by)).collect();
    let without = design.limits_without_current.and_then(|_| {
        let blind = without_current(&rows);
        learned(&blind)?.separation(&blind)
    });
    let mechanisms = process.mechanisms();
    let size = |it: &Mechanism| if it.unit == "1" { COMPARED } else { COMPARED * it.most };
    let set = |of: &Separation, (j, it): (usize, &Mechanism)| -> Vec<usize> {
        if of.shows(j, size(it)) { of.confused(j, size(it)) } else { Vec::new() }
    };
    let names = |of: &Separation, of_mechanism: (usize, &Mechanism)| -> Vec<String> {
        set(of, of_mechanism).into_iter().map(|other| mechanisms[other].id.clone()).collect()
    };
    let separable = |(j, it): (usize, &Mechanism)| -> Vec<Separable> {
        let others = set(&with, (j, it)).into_iter().filter_map(|other| {
            let stated = |(of, _): &&(Separation, f64)| !of.confused(j, size(it)).contains(&other);
            let (_, speed) = through.iter().find(stated)?;
            Some(Separable { mechanism: mechanisms[other].id.clone(), speed: *speed })
        });
        others.collect()
    };
    let confusion = |(j, it): (usize, &Mechanism)| Confusion {
        mechanism: it.id.clone(),
        size: size(it),
        shows: with.shows(j, size(it)),
        set: names(&with, (j, it)),
        separable: separable((j, it)),
        set_without_current: without
            .as_ref()
            .filter(|without| without.shows(j, size(it)))
            .map(|without| names(without, (j, it))),
    };
    mechanisms.iter().enumerate().map(confusion).collect()
}
