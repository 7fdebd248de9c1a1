//! The bank of a training: noise and limits for a drive whose equations are known.

use drivescope_diagnoser::bank::{
    BankDesign, Calibration, Driving, Event, LearnedNoise, Limits, Mechanism, Row, Separation,
    Verified,
};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use drivescope_scenarios::bank::{
    AnyProcess, Columns, learn_noise, process, with_noise, without_current,
};
use serde::Serialize;

use crate::failure::{Failure, told};
use crate::report::words::number;
use crate::{drive_source, interrupt};

/// Time that a machine is learned from, s, and fewest rows.
const BASELINE_S: f64 = 5.0;
const FEWEST_BASELINE: usize = 200;
/// Time that a judgement rests on, s, and fewest rows.
const HORIZON_S: f64 = 0.5;
const FEWEST_HORIZON: usize = 40;
/// Healthy samples that limits are designed on.
const DESIGNED: usize = 300_000;
/// Share of the alarms seen in the healthy recordings that the design foresees, below which the
/// drive model is not theirs.
const FORESEEN: f64 = 0.05;
/// Size at which mechanisms are compared: of a fraction, or as a share of the greatest bias.
const COMPARED: f64 = 0.1;

/// What was found on the way.
#[derive(Debug, Serialize)]
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

#[derive(Debug, Serialize)]
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
#[derive(Debug, Serialize)]
struct Confusion {
    mechanism: String,
    size: f64,
    /// Whether it shows at all: an inertia does not at a constant speed.
    shows: bool,
    set: Vec<String>,
    /// The same where no current is measured, if it shows then.
    #[serde(skip_serializing_if = "Option::is_none")]
    set_without_current: Option<Vec<String>>,
}

/// Designs the bank of a drive on healthy recordings.
///
/// # Errors
/// A drive or recordings that make no bank, in words.
pub(super) fn design(
    drive: &str,
    healthy: &[Recording],
    (arl_0, verified, seed): (f64, usize, u64),
) -> miette::Result<(BankDesign, BankAnswer)> {
    let text = drive_source::text(drive)?;
    let known: Drive = drive_source::drive(drive)?;
    let not = |what: String, instead: &str| Failure::Usage { what, instead: instead.to_owned() };
    if !(arl_0.is_finite() && arl_0 >= 1e3) {
        let what = format!("--arl0 {arl_0}: not a mean number of samples between false alarms");
        return Err(not(what, "give 1000 or more; 1e6 is usual").into());
    }
    let period_s = healthy[0].period_s;
    let samples = |seconds: f64, least: usize| ((seconds / period_s).round() as usize).max(least);
    let (baseline, horizon) =
        (samples(BASELINE_S, FEWEST_BASELINE), samples(HORIZON_S, FEWEST_HORIZON));
    let mut runs: Vec<Vec<Row>> = Vec::new();
    let mut has_current = true;
    for recording in healthy {
        let words = |error| {
            not(format!("{}: {error}", recording.name), "record it, or name it with --columns")
        };
        for part in recording.parts() {
            let (columns, rows) = Columns::of(&part).map_err(words)?;
            has_current &= columns.has_current();
            runs.push(rows);
        }
    }
    let noise = learn_noise(&known, period_s, &runs).map_err(told)?;
    let known = with_noise(&known, &noise);
    let process = process(&known, period_s, &[]).map_err(told)?;
    interrupt::check()?;
    let driving = Driving::of(runs.iter().flatten(), period_s).ok_or_else(|| {
        not("the healthy recordings show nothing that drives".to_owned(), "record C_m or u")
    })?;
    let how = Calibration { driving, arl_0, baseline, horizon, samples: DESIGNED, seed };
    let limits = process.calibrate(&how).map_err(told)?;
    let mut blind = driving;
    blind.measured[1] = false;
    let limits_without_current = (has_current && blind.measured[0])
        .then(|| process.calibrate(&Calibration { driving: blind, ..how }))
        .transpose()
        .map_err(told)?;
    interrupt::check()?;
    let fresh = Calibration { samples: verified, seed: seed.wrapping_add(1), ..how };
    let verified = process.verify(limits, &fresh).map_err(told)?;
    let design = BankDesign {
        period_s,
        arl_0,
        horizon,
        baseline,
        drive: text,
        limits,
        limits_without_current,
        noise,
    };
    let (recorded, recorded_alarms) = recorded(process.as_ref(), healthy, &runs, &design)?;
    let answer = BankAnswer {
        drive: known.name.clone(),
        noise,
        arl_0,
        limits,
        horizon_samples: horizon,
        baseline_samples: baseline,
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
    let geometry = |rows: &[Row]| -> Option<Separation> {
        let watch = process.learn(rows, design.limits, design.horizon).ok()?;
        watch.separation(rows)
    };
    let long = runs.iter().filter(|rows| rows.len() >= design.baseline);
    let first = |rows: &Vec<Row>| rows[..design.baseline].to_vec();
    let Some(rows) = long.map(first).next() else { return Vec::new() };
    let Some(with) = geometry(&rows) else { return Vec::new() };
    let without = design.limits_without_current.and_then(|_| geometry(&without_current(&rows)));
    let mechanisms = process.mechanisms();
    let size = |it: &Mechanism| if it.unit == "1" { COMPARED } else { COMPARED * it.most };
    let names = |of: &Separation, (j, it): (usize, &Mechanism)| -> Vec<String> {
        let shown = of.shows(j, size(it)).then(|| of.confused(j, size(it)));
        let others = shown.into_iter().flatten();
        others.map(|other| mechanisms[other].id.clone()).collect()
    };
    let confusion = |(j, it): (usize, &Mechanism)| Confusion {
        mechanism: it.id.clone(),
        size: size(it),
        shows: with.shows(j, size(it)),
        set: names(&with, (j, it)),
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
        for Confusion { mechanism, size, shows, set, set_without_current } in &self.confusions {
            if !shows {
                text += &format!("{mechanism} of {} does not show here\n", number(*size));
            }
            if !set.is_empty() {
                text += &format!("{mechanism} cannot be told from {}\n", set.join(", "));
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
