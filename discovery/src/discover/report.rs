//! What a discovery answers.

use std::collections::BTreeMap;

use drivescope_plant::drive::Drive;
use serde::Serialize;

use super::experiment::NextExperiment;
use super::learned::LearnedCurve;
use super::not_judged::NotJudged;
use crate::balances::BothUnexplained;
use crate::compare::Finding;
use crate::doubt::Doubt;
use crate::estimate::{Estimate, OutputFits};
use crate::formula::Formula;
use crate::observer::Observer;
use crate::signals::SignalFinding;

/// What the loop says while it runs.
#[derive(Debug, Clone)]
pub enum Step<'a> {
    /// A step of the ladder: what was added (nothing first), and the errors.
    Ladder(&'a LadderStep),
    /// What is being done.
    Doing(&'static str),
    /// The error that a step of a fit came to, in units of the noise.
    Fitting(f64),
}

/// Who watches the loop.
pub trait Watch: Sync {
    /// Something happened.
    fn step(&self, _step: &Step<'_>) {}

    /// Whether [`Discovery::fails`] is wanted: the comparison of the base costs time and memory.
    fn compares(&self) -> bool {
        true
    }

    /// Whether the loop is to end.
    fn stopped(&self) -> bool {
        false
    }
}

/// Tells the error of a step of a fit; whether the fit is to end.
pub(super) fn seen_by(watch: &dyn Watch, error: f64) -> bool {
    watch.step(&Step::Fitting(error));
    watch.stopped()
}

/// Nobody watches.
#[derive(Debug, Clone, Copy)]
pub struct Unwatched;

impl Watch for Unwatched {}

/// A step of the ladder of errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderStep {
    /// What was added: nothing first.
    pub added: Option<String>,
    /// Error on the estimation data, in units of the noise.
    pub error: f64,
    /// Error on the validation data.
    pub validation_error: f64,
    /// What the balances leave unexplained of the estimation data.
    pub unexplained: BothUnexplained,
    /// The same of the validation data.
    pub validation_unexplained: BothUnexplained,
    /// Fit of each output of the estimation data, %.
    pub fit_percent: OutputFits,
    /// The same of the validation data.
    pub validation_fit_percent: OutputFits,
}

/// An estimated parameter of a ranked effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficient {
    /// Its value, SI.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Unit of both.
    pub unit: String,
}

/// A candidate that was refitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranked {
    pub effect: String,
    /// What these recordings do not tell from it.
    pub confusion_set: Vec<String>,
    /// Twice the logarithm of its evidence over that of the model without it, in all recordings: as
    /// a gain in BIC is read.
    pub delta_bic: f64,
    /// Greatest probability of so much evidence where it is not missing.
    pub p_value: f64,
    /// Share of the error above the noise floor that it removes in free run; 0 where it was not
    /// fitted so.
    pub excess_removed: f64,
    /// The part of `delta_bic` that recordings bring to which nothing was fitted: positive is better.
    pub validation_gain: f64,
    /// That it is what is missing, among the candidates and nothing, 0 to 1.
    pub probability: f64,
    /// Root of the mean square of what it does, as a share of what the balance holds (the torque
    /// that is not inertia's, the voltage over the resistance, a tenth of a sensor's signal).
    pub size: f64,
    /// Its parameters; a standard error is a number where it was fitted in free run.
    pub parameters: BTreeMap<String, Coefficient>,
    /// Why it was not named.
    pub refused: Option<String>,
}

/// A candidate that promised too little to be fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unfitted {
    pub effect: String,
    /// As of [`Ranked`], where it vanishes; a law that vanishes at no finite value may have more.
    pub delta_bic: f64,
}

/// What is random in the load torque (force) beside what the model explains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RandomLoad {
    /// Its standard deviation, N m (N).
    pub sd: f64,
    /// Time after which it forgets what it was, s.
    pub time: f64,
    /// What of it oscillates, if it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oscillation: Option<Oscillation>,
}

/// A load that oscillates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Oscillation {
    /// Root of its mean square in the recordings, N m (N).
    pub sd: f64,
    /// Frequency, Hz.
    pub hz: f64,
    /// Time after which it forgets its phase, s.
    pub time: f64,
}

/// What the loop answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// At least one effect is named.
    Named,
    /// Nothing is missing that these recordings could show.
    None,
    /// Something is missing, and none of the known effects is it.
    Unknown,
    /// The signals of the recordings do not let anything be judged.
    #[serde(rename = "not_judged")]
    NotJudged,
}

/// What a discovery found.
#[derive(Debug, Clone)]
pub struct Discovery {
    /// The base, fitted, before anything was added.
    pub base: Drive,
    /// The drive with everything that was named in it, fitted.
    pub drive: Drive,
    /// Its parameters with their standard errors.
    pub parameters: Vec<Estimate>,
    /// Errors of the base and after each addition.
    pub ladder: Vec<LadderStep>,
    /// The answer.
    pub verdict: Verdict,
    /// The effects that were named.
    pub named: Vec<String>,
    /// What is left: nothing or something unknown.
    pub remaining: Verdict,
    /// Candidates of the first round, best first, then those that later rounds named.
    pub ranking: Vec<Ranked>,
    /// Candidates of the first round that were weighed and not fitted, most probable first.
    pub unfitted: Vec<Unfitted>,
    /// Where the base fails, most telling first, as a comparison says.
    pub fails: Vec<Finding>,
    /// What could not be judged.
    pub not_judged: Vec<NotJudged>,
    /// The random load that the recordings show beside the drive at the end.
    pub load: Option<RandomLoad>,
    /// The curve that describes what nobody knows.
    pub learned: Option<LearnedCurve>,
    /// Formulas for what nobody knows, the most probable first; or for what was named, where they
    /// describe it closer.
    pub formulas: Vec<Formula>,
    /// The named effect in whose place the formulas stand.
    pub closer_than: Option<String>,
    /// What to record to tell apart what these recordings do not.
    pub next_experiment: Option<NextExperiment>,
    /// What is wrong with the signals of the recordings, the gravest first.
    pub signals: Vec<SignalFinding>,
    /// Doubts about the recordings that only the fit raises.
    pub doubts: Vec<Doubt>,
    pub observer: Observer,
}

impl Discovery {
    /// That drive as it is, with nothing found yet.
    pub(super) fn of(drive: &Drive, verdict: Verdict, observer: Observer) -> Self {
        Self {
            base: drive.clone(),
            drive: drive.clone(),
            parameters: Vec::new(),
            ladder: Vec::new(),
            verdict,
            named: Vec::new(),
            remaining: verdict,
            ranking: Vec::new(),
            unfitted: Vec::new(),
            fails: Vec::new(),
            not_judged: Vec::new(),
            load: None,
            learned: None,
            formulas: Vec::new(),
            closer_than: None,
            next_experiment: None,
            signals: Vec::new(),
            doubts: Vec::new(),
            observer,
        }
    }
}

impl Discovery {
    /// What a person should know that these recordings could not show, those with the same reason
    /// together: names and reason.
    pub fn not_shown(&self) -> Vec<(Vec<&str>, &str)> {
        let mut reasons: Vec<(Vec<&str>, &str)> = Vec::new();
        for one in self.not_judged.iter().filter(|one| one.worth_saying) {
            match reasons.iter_mut().find(|(_, reason)| *reason == one.reason) {
                Some((effects, _)) => effects.push(&one.effect),
                None => reasons.push((vec![&one.effect], &one.reason)),
            }
        }
        reasons
    }
}
