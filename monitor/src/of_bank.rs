//! The bank of a diagnoser at work on rows.

use std::fmt;
use std::sync::Arc;

use drivescope_diagnoser::bank::{
    BankDesign, Cause, Event, Judgement, Limits, Mechanism, Row, Statistics, Symptom,
};
use drivescope_diagnoser::{Memory, MemoryError, Walk};
use drivescope_plant::drive::Drive;
use serde::Serialize;

use crate::bank::{AnyProcess, AnyWatch, Columns, process, with_noise};
use crate::declaration::Declaration;
use crate::error::MonitorError;
use crate::found::{Found, Machine};
use crate::method::Method;
use crate::outside::Outside;
use crate::state::State;

/// Share of healthy values outside their band.
const SHARE_OUTSIDE: f64 = 0.05;
/// What sensors that are stuck are declared as, in the order of the sensors.
pub const STUCK: [&str; 3] = ["tacho_freeze", "current_freeze", "voltage_freeze"];

/// Where a bank stands.
#[derive(Clone)]
enum Mode {
    /// The machine is being learned from the recording's own first rows.
    Learning(Vec<Row>),
    /// It is watched.
    Watching(Box<dyn AnyWatch>),
    /// The first rows make no baseline.
    Refused(String),
}

/// A decision, as it is made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decision {
    /// Time of the row that brought it, s.
    pub time: f64,
    /// `alarm`, `judged`, `retracted` or `ended`.
    pub decision: &'static str,
    /// What the alarm rests on.
    pub symptom: Option<String>,
    /// What is declared, or was until now.
    #[serde(flatten)]
    pub declaration: Declaration,
}

/// The bank and what it declared.
#[derive(Clone)]
pub(crate) struct OfBank {
    process: Arc<dyn AnyProcess>,
    design: Arc<BankDesign>,
    limits: Limits,
    columns: Columns,
    mode: Mode,
    /// A row after a baseline of another recording, or after a gap, begins anew.
    anew: bool,
    rows: usize,
    /// Rows that were learned from.
    learned: usize,
    /// Rows before the first of the watch.
    base: usize,
    counted: Outside,
    found: Found,
    /// An alarm that is not judged yet.
    alarm: Option<Declaration>,
    symptom: Option<String>,
}

impl OfBank {
    /// The bank of a design over rows of those columns; `baseline` rows are another recording's.
    ///
    /// # Errors
    /// A drive that cannot be read, or a baseline that shows no healthy machine.
    pub(crate) fn new(
        design: &BankDesign,
        columns: Columns,
        baseline: Option<(&str, &[Row])>,
    ) -> Result<Self, MonitorError> {
        let known = Drive::parse(&design.drive, "the drive of the diagnoser")?;
        let known = with_noise(&known, &design.noise);
        let process = process(&known, design.period_s, &[])?;
        let without = design.limits_without_current.filter(|_| !columns.has_current());
        let limits = without.unwrap_or(design.limits);
        let mode = match baseline {
            None => Mode::Learning(Vec::with_capacity(design.baseline)),
            Some((name, rows)) => {
                let watch = process.learn(rows, limits, design.horizon);
                Mode::Watching(watch.map_err(|source| MonitorError::Machine {
                    baseline: name.to_owned(),
                    source,
                })?)
            }
        };
        Ok(Self {
            process: process.into(),
            design: Arc::new(design.clone()),
            limits,
            columns,
            mode,
            anew: baseline.is_some(),
            rows: 0,
            learned: 0,
            base: 0,
            counted: Outside::default(),
            found: Found::new(Method::Bank, Some(SHARE_OUTSIDE)),
            alarm: None,
            symptom: None,
        })
    }

    /// Where it finds its signals.
    pub(crate) fn columns(&self) -> &Columns {
        &self.columns
    }

    /// A new segment begins.
    pub(crate) fn begin(&mut self) {
        match &mut self.mode {
            // A baseline is a run without gaps.
            Mode::Learning(rows) => {
                self.learned -= rows.len();
                rows.clear();
            }
            Mode::Watching(_) | Mode::Refused(_) => self.anew = true,
        }
    }

    /// Takes a row.
    pub(crate) fn step(&mut self, row: &Row, time: f64) -> Option<Decision> {
        self.rows += 1;
        let watch = match &mut self.mode {
            Mode::Refused(_) => return None,
            Mode::Learning(rows) => {
                rows.push(*row);
                self.learned += 1;
                if rows.len() >= self.design.baseline {
                    let made = self.process.learn(rows, self.limits, self.design.horizon);
                    self.base = self.rows;
                    self.mode =
                        made.map_or_else(|error| Mode::Refused(error.to_string()), Mode::Watching);
                }
                return None;
            }
            Mode::Watching(watch) => watch,
        };
        if !row.control.is_finite() && !row.shown[2].is_finite() {
            // Nothing tells what drives: a gap, which the watch does not count.
            (self.base, self.anew) = (self.base + 1, true);
            return None;
        }
        if std::mem::take(&mut self.anew) {
            watch.resume(row);
        }
        let event = watch.step(row);
        let statistics = watch.statistics();
        self.counted.step(statistics.measured, statistics.outside);
        self.happened(event?, time)
    }

    /// The time of a sample of the watch, s.
    fn time(&self, sample: usize, now: f64) -> f64 {
        /// Times are told to a microsecond.
        const FINEST_S: f64 = 1e-6;
        let ago = (self.rows - 1).saturating_sub(self.base + sample) as f64;
        ((now - ago * self.design.period_s) / FINEST_S).round() * FINEST_S
    }

    fn happened(&mut self, event: Event, time: f64) -> Option<Decision> {
        match event {
            Event::Alarm(alarm) => {
                let from = self.time(alarm.onset, time);
                let symptom = match alarm.symptom {
                    Symptom::Mechanism(j) => self.id(j),
                    Symptom::Frozen(sensor) => STUCK[sensor].to_owned(),
                    Symptom::Excess => "excess".to_owned(),
                };
                self.symptom = Some(symptom.clone());
                let declaration =
                    Declaration { sample: self.rows, ..Declaration::unknown(from, time) };
                self.alarm = Some(declaration.clone());
                Some(Decision { time, decision: "alarm", symptom: Some(symptom), declaration })
            }
            Event::Judged(judgement) => self.judged(&judgement, time),
            Event::Ended(last) => {
                let to = self.time(last, time);
                self.close(to, time, "ended")
            }
        }
    }

    /// Ends what stands.
    fn close(&mut self, to: f64, time: f64, decision: &'static str) -> Option<Decision> {
        let standing = self.found.declarations.last_mut().filter(|last| last.to.is_none())?;
        standing.to = Some(to.max(standing.from));
        let declaration = standing.clone();
        Some(Decision { time, decision, symptom: self.symptom.take(), declaration })
    }

    fn judged(&mut self, judgement: &Judgement, time: f64) -> Option<Decision> {
        let from = self.time(judgement.onset, time);
        let alarm = self.alarm.take().unwrap_or_else(|| Declaration::unknown(from, time));
        let mut declaration = Declaration { from, ..alarm };
        match judgement.cause {
            Cause::Healthy => {
                let closed = self.close(from, time, "ended");
                let symptom = self.symptom.take();
                let decision = Decision { time, decision: "retracted", symptom, declaration };
                return Some(closed.unwrap_or(decision));
            }
            Cause::Unknown => {}
            Cause::Frozen(sensor) => {
                STUCK[sensor].clone_into(&mut declaration.mechanism);
                declaration.set.push(declaration.mechanism.clone());
            }
            Cause::Mechanism(j) => {
                declaration.mechanism = self.id(j);
                let confused = judgement.confusion_set().iter();
                declaration.set = confused.map(|it| self.id(it.mechanism)).collect();
                let named = judgement.named();
                declaration.size = named.map(|it| it.size);
                declaration.interval = named.map(|it| it.interval());
                declaration.unit = Some(self.about(j).unit.clone());
                let per_second = 1.0 / self.design.period_s;
                declaration.growth =
                    judgement.growth.map(|(rate, sd)| [rate * per_second, sd * per_second]);
            }
        }
        let standing = self.found.declarations.last_mut().filter(|last| last.to.is_none());
        match standing {
            // It was estimated anew, or it grew: one fault.
            Some(standing) if standing.mechanism == declaration.mechanism => {
                declaration = Declaration {
                    from: standing.from,
                    noticed: standing.noticed,
                    sample: standing.sample,
                    ..declaration
                };
                *standing = declaration.clone();
            }
            standing => {
                if let Some(standing) = standing {
                    standing.to = Some(from.max(standing.from));
                }
                self.found.declare(declaration.clone());
            }
        }
        Some(Decision { time, decision: "judged", symptom: self.symptom.take(), declaration })
    }

    fn about(&self, j: usize) -> &Mechanism {
        &self.process.mechanisms()[j]
    }

    fn id(&self, j: usize) -> String {
        self.about(j).id.clone()
    }

    /// Statistics of the last row, and their limits; none before a machine is known.
    pub(crate) fn statistics(&self) -> Option<(Statistics, Limits)> {
        match &self.mode {
            Mode::Watching(watch) => Some((watch.statistics(), self.limits)),
            _ => None,
        }
    }

    /// The mechanisms that it knows.
    pub(crate) fn mechanisms(&self) -> &[Mechanism] {
        self.process.mechanisms()
    }

    /// Where it stands, and what it found.
    pub(crate) fn standing(&self) -> (State, &Found) {
        let stands = self.found.declarations.last().is_some_and(|last| last.to.is_none());
        let state = match &self.mode {
            Mode::Learning(_) => State::NotYet,
            Mode::Refused(_) => State::NotJudged,
            Mode::Watching(_) if self.alarm.is_some() => State::Alarm,
            Mode::Watching(_) if stands => State::Fault,
            Mode::Watching(_) => State::Healthy,
        };
        (state, &self.found)
    }

    /// What was found until now.
    pub(crate) fn finish(mut self) -> (Machine, Found) {
        // The rows end before they tell what it is.
        if let Some(alarm) = self.alarm.take() {
            self.found.declare(alarm);
        }
        let why = match &self.mode {
            Mode::Watching(_) => None,
            Mode::Refused(error) => Some(error.clone()),
            Mode::Learning(rows) => Some(format!(
                "a machine is learned from {} samples of it, there are {}: give a longer recording \
                 or a --baseline",
                self.design.baseline,
                rows.len()
            )),
        };
        let changes = match &self.mode {
            Mode::Watching(watch) => watch.machine(),
            _ => Vec::new(),
        };
        let Self { mut found, counted, learned, .. } = self;
        found.verdict = if why.is_some() {
            "not_judged"
        } else if !found.declarations.is_empty() {
            "fault"
        } else if counted.is_abnormal(SHARE_OUTSIDE) {
            "abnormal"
        } else {
            "healthy"
        };
        found.judged = counted.judged;
        found.outside = counted.outside;
        found.exceedance_rate = counted.share();
        (Machine { learned, changes, why }, found)
    }
}

impl Memory for OfBank {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let mut mode = match self.mode {
            Mode::Learning(_) => 0,
            Mode::Watching(_) => 1,
            Mode::Refused(_) => 2,
        };
        walk.below(&mut mode, 3)?;
        if walk.restores() {
            self.mode = match mode {
                0 => Mode::Learning(Vec::with_capacity(self.design.baseline)),
                1 => Mode::Watching(self.process.unlearned(self.limits, self.design.horizon)),
                _ => Mode::Refused(String::new()),
            };
        }
        match &mut self.mode {
            Mode::Learning(rows) => {
                let mut walked = std::mem::take(rows).into();
                walk.list(&mut walked, self.design.baseline, || Row::NOTHING)?;
                rows.extend(walked);
            }
            Mode::Watching(watch) => watch.walk(walk)?,
            Mode::Refused(why) => why.walk(walk)?,
        }
        self.anew.walk(walk)?;
        walk.each([&mut self.rows, &mut self.learned, &mut self.base])?;
        self.counted.walk(walk)?;
        self.found.walk(walk)?;
        walk.maybe(&mut self.alarm, Declaration::blank)?;
        walk.maybe(&mut self.symptom, String::new)
    }
}

impl fmt::Debug for OfBank {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.debug_struct("OfBank").field("rows", &self.rows).finish_non_exhaustive()
    }
}
