//! The bank of a diagnoser at work on rows.

use drivescope_diagnoser::bank::{
    BankDesign, BaselineError, Cause, Event, Judgement, Limits, Mechanism, Row, Symptom,
};
use drivescope_plant::drive::Drive;
use drivescope_scenarios::bank::{AnyProcess, AnyWatch, Columns, process, with_noise};
use serde::Serialize;

use super::declaration::Declaration;
use super::outside::Outside;
use crate::failure::{Failure, told};

/// Share of healthy values outside their band.
pub(super) const SHARE_OUTSIDE: f64 = 0.05;
/// Names of what sensors that are stuck are declared as, in the order of the sensors.
const STUCK: [&str; 3] = ["tacho_freeze", "current_freeze", "voltage_freeze"];

/// Where a bank stands.
enum Mode {
    /// The machine is being learned from the recording's own first rows.
    Learning(Vec<Row>),
    /// It is watched.
    Watching(Box<dyn AnyWatch>),
    /// The first rows make no baseline.
    Refused(BaselineError),
}

/// A decision, as it is made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Decision {
    /// Time of the row that brought it, s.
    pub(super) time: f64,
    /// `alarm`, `judged`, `retracted` or `ended`.
    pub(super) decision: &'static str,
    /// What the alarm rests on.
    pub(super) symptom: Option<String>,
    #[serde(flatten)]
    pub(super) declaration: Declaration,
}

/// The bank and what it declared.
pub(super) struct Bank {
    process: Box<dyn AnyProcess>,
    design: BankDesign,
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
    declarations: Vec<Declaration>,
    /// An alarm that is not judged yet.
    alarm: Option<Declaration>,
    symptom: Option<String>,
}

impl Bank {
    /// The bank of a design over rows of those columns; `baseline` rows are another recording's.
    ///
    /// # Errors
    /// Columns that a bank cannot use, or a baseline that shows no healthy machine, in words.
    pub(super) fn new(
        design: &BankDesign,
        columns: Columns,
        baseline: Option<(&str, &[Row])>,
    ) -> miette::Result<Self> {
        let known = Drive::parse(&design.drive, "the drive of the diagnoser").map_err(told)?;
        let known = with_noise(&known, &design.noise);
        let process = process(&known, design.period_s, &[]).map_err(told)?;
        let without = design.limits_without_current.filter(|_| !columns.has_current());
        let limits = without.unwrap_or(design.limits);
        let mode = match baseline {
            None => Mode::Learning(Vec::with_capacity(design.baseline)),
            Some((name, rows)) => {
                let watch = process.learn(rows, limits, design.horizon);
                Mode::Watching(watch.map_err(|error| {
                    Failure::Usage {
                        what: format!("{name}: {error}"),
                        instead:
                            "give a --baseline of this machine that runs healthily, some seconds \
                              of it; for another kind of machine train a diagnoser with its drive"
                                .to_owned(),
                    }
                })?)
            }
        };
        Ok(Self {
            process,
            design: design.clone(),
            limits,
            columns,
            mode,
            anew: baseline.is_some(),
            rows: 0,
            learned: 0,
            base: 0,
            counted: Outside::default(),
            declarations: Vec::new(),
            alarm: None,
            symptom: None,
        })
    }

    /// Where it finds its signals.
    pub(super) fn columns(&self) -> &Columns {
        &self.columns
    }

    /// A new segment begins.
    pub(super) fn begin(&mut self) {
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
    pub(super) fn step(&mut self, row: &Row, time: f64) -> Option<Decision> {
        self.rows += 1;
        let watch = match &mut self.mode {
            Mode::Refused(_) => return None,
            Mode::Learning(rows) => {
                rows.push(*row);
                self.learned += 1;
                if rows.len() >= self.design.baseline {
                    let made = self.process.learn(rows, self.limits, self.design.horizon);
                    self.base = self.rows;
                    self.mode = made.map_or_else(Mode::Refused, Mode::Watching);
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
        let standing = self.declarations.last_mut().filter(|last| last.to.is_none())?;
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
                let candidates = &judgement.candidates;
                let confused = &candidates[..judgement.confused.clamp(1, candidates.len())];
                declaration.set = confused.iter().map(|it| self.id(it.mechanism)).collect();
                let named = candidates.iter().find(|it| it.mechanism == j);
                declaration.size = named.map(|it| it.size);
                declaration.interval = named.map(|it| it.interval());
                declaration.unit = Some(self.about(j).unit.clone());
                let per_second = 1.0 / self.design.period_s;
                declaration.growth =
                    judgement.growth.map(|(rate, sd)| [rate * per_second, sd * per_second]);
            }
        }
        let standing = self.declarations.last_mut().filter(|last| last.to.is_none());
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
                self.declarations.push(declaration.clone());
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

    /// What was found until now.
    pub(super) fn found(mut self) -> BankFound {
        // The rows end before they tell what it is.
        self.declarations.extend(self.alarm);
        let why = match &self.mode {
            Mode::Watching(_) => None,
            Mode::Refused(error) => Some(error.to_string()),
            Mode::Learning(rows) => Some(format!(
                "a machine is learned from {} samples of it, there are {}: give a longer recording \
                 or a --baseline",
                self.design.baseline,
                rows.len()
            )),
        };
        let machine = match &self.mode {
            Mode::Watching(watch) => watch.machine(),
            _ => Vec::new(),
        };
        BankFound {
            learned: self.learned,
            counted: self.counted,
            machine,
            why,
            declarations: self.declarations,
        }
    }
}

/// What a bank found.
pub(super) struct BankFound {
    /// Rows of the recording that the machine was learned from.
    pub(super) learned: usize,
    /// Values shown, and those of them outside their 95 % band.
    pub(super) counted: Outside,
    /// What the machine differs by from the drive.
    pub(super) machine: Vec<(String, f64)>,
    /// Why nothing was judged.
    pub(super) why: Option<String>,
    pub(super) declarations: Vec<Declaration>,
}

impl Decision {
    /// One line of it.
    pub(super) fn text(&self) -> String {
        let Self { time, decision, symptom, declaration } = self;
        let symptom = symptom.as_deref().unwrap_or("excess");
        match *decision {
            "alarm" => {
                format!("at {time:.3} s: alarm ({symptom}), since {:.3} s", declaration.from)
            }
            "retracted" => format!("at {time:.3} s: healthy, the alarm is taken back"),
            "ended" => format!(
                "at {time:.3} s: {} ended at {:.3} s",
                declaration.mechanism,
                declaration.to.unwrap_or(*time)
            ),
            _ => format!("at {time:.3} s: since {:.3} s {}", declaration.from, declaration.what()),
        }
    }
}
