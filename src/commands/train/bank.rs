//! The bank of a training: noise and limits for a drive whose equations are known.

use drivescope_diagnoser::bank::{
    BankDesign, Calibration, Event, LearnedNoise, Limits, Mechanism, Row, Separation, Verified,
};
use drivescope_monitor::bank::{self, AnyProcess, Columns, Designed, without_current};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use serde::Serialize;

use crate::failure::{Failure, told};
use crate::interrupt;
use crate::report::words::number;

/// Share of the alarms seen in the healthy recordings that the design foresees, below which the
/// drive model is not theirs.
const FORESEEN: f64 = 0.05;
/// Changes of the control effort that are tried for a confusion set, the mildest first.
const CHANGES: [f64; 6] = [0.75, 1.25, 0.5, 1.5, 0.0, -1.0];
/// Size at which mechanisms are compared: of a fraction, or as a share of the greatest bias.
const COMPARED: f64 = 0.1;

/// What was found on the way.
#[derive(Debug, Clone, Serialize)]
pub(super) struct BankAnswer {
    drive: String,
    noise: LearnedNoise,
    arl_0: f64,
    limits: Limits,
    horizon_samples: usize,
    baseline_samples: usize,
    verified: VerifiedAnswer,
    /// What cannot be told apart at the operating point of the first recording.
    confusions: Vec<Confusion>,
}

#[derive(Debug, Clone, Serialize)]
struct VerifiedAnswer {
    samples: usize,
    alarms: usize,
    /// Lower 95 % limit of the mean samples between alarms.
    arl_0_at_least: f64,
    /// Healthy samples of the recordings, baselines excluded, and alarms in them.
    recorded: usize,
    recorded_alarms: usize,
}

/// A mechanism and those that a fault of that size is confused with.
#[derive(Debug, Clone, Serialize)]
struct Confusion {
    mechanism: String,
    size: f64,
    /// Whether it shows at all: an inertia does not at a constant speed.
    shows: bool,
    set: Vec<String>,
    /// What a change of the set point would tell it from.
    separable: Vec<Separable>,
    /// The same where no current is measured, if it shows then.
    #[serde(skip_serializing_if = "Option::is_none")]
    set_without_current: Option<Vec<String>>,
}

/// A mechanism of a confusion set that another speed takes out of it.
#[derive(Debug, Clone, Serialize)]
struct Separable {
    mechanism: String,
    /// Speed to change to, rad/s (m/s).
    speed: f64,
}

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
    let designed = bank::design(known, period_s, &runs, seed).map_err(told)?;
    interrupt::check()?;
    let Designed { noise, drive: known, process, tails, tails_without_current, how } = designed;
    let limits = tails.limits(arl_0);
    let fresh = Calibration { samples: verified, seed: seed.wrapping_add(1), ..how };
    let verified = process.verify(limits, &fresh).map_err(told)?;
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
            let told = |(of, _): &&(Separation, f64)| !of.confused(j, size(it)).contains(&other);
            let (_, speed) = through.iter().find(told)?;
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

impl BankAnswer {
    /// As text for a person.
    pub(super) fn text(&self) -> String {
        let Self { drive, noise, arl_0, limits, verified, .. } = self;
        let mut text = format!(
            "bank over {drive}: noise learned: speed {}, current {} A, torque {} over {} s (SI)\n\
             limits for {arl_0:e} samples between false alarms: likelihood ratio {}, squares {}; \
             verified: {} alarms in {} fresh healthy samples (at least {:.2e} between, 95 %), {} in \
             the {} of the recordings\n",
            number(noise.omega),
            number(noise.i),
            number(noise.torque),
            number(noise.torque_time),
            number(limits.ratio),
            number(limits.squares),
            verified.alarms,
            verified.samples,
            verified.arl_0_at_least,
            verified.recorded_alarms,
            verified.recorded,
        );
        for Confusion { mechanism, size, shows, set, separable, set_without_current } in
            &self.confusions
        {
            if !shows {
                text += &format!("{mechanism} of {} does not show here\n", number(*size));
            }
            if !set.is_empty() {
                text += &format!("{mechanism} cannot be told from {}\n", set.join(", "));
            }
            for Separable { mechanism: other, speed } in separable {
                let speed = number(*speed);
                text += &format!("  a set point changed to {speed} (SI) tells it from {other}\n");
            }
            let blind = set_without_current.iter().flatten();
            let more: Vec<&str> =
                blind.filter(|it| !set.contains(it)).map(String::as_str).collect();
            if !more.is_empty() {
                text +=
                    &format!("{mechanism}: without the current, nor from {}\n", more.join(", "));
            }
        }
        text
    }
}
