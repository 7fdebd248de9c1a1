//! The bank over the rows of one scenario: its machine is learned at the end of the run-up and
//! watched from then on.

use drivescope_diagnoser::bank::{BaselineError, Cause, Event, Judgement, Limits, Row};
use drivescope_monitor::bank::AnyWatch;

use super::Bank;
use super::found::{BankFound, Heard, Named};

/// Rows that are watched at once: the bank's own memory is fetched once for all of them.
const AT_ONCE: usize = 64;

/// How far a scenario is.
enum Stage {
    /// The machine is still to be learned.
    Learning,
    /// It is watched.
    Watching(Box<dyn AnyWatch>),
    /// The baseline shows no healthy machine of this kind.
    Refused(BaselineError),
}

/// One scenario.
pub(super) struct Lane {
    stage: Stage,
    limits: Limits,
    /// First and last faulty sample; past the end where nothing fails.
    from: u64,
    until: u64,
    /// Rows that wait to be learned from, or watched.
    rows: Vec<Row>,
    /// Sample of the first row that waits.
    first: u64,
    found: BankFound,
}

impl Lane {
    /// A scenario with faults between two samples, whose bank waits for that baseline.
    pub(super) fn new(limits: Limits, (from, until): (u64, u64), bank: &Bank<'_>) -> Self {
        Self {
            stage: Stage::Learning,
            limits,
            from,
            until,
            rows: Vec::with_capacity(bank.design.baseline.max(AT_ONCE)),
            first: bank.run_up - bank.design.baseline as u64,
            found: BankFound::default(),
        }
    }

    /// Takes the row of sample `k`.
    pub(super) fn take(&mut self, k: u64, row: Row, bank: &Bank<'_>) {
        let due = match &self.stage {
            Stage::Refused(_) => return,
            Stage::Learning if k < self.first => return,
            Stage::Learning => bank.design.baseline,
            Stage::Watching(_) => AT_ONCE,
        };
        self.rows.push(row);
        if self.rows.len() >= due {
            self.work(bank);
        }
    }

    /// Learns from the rows that wait, or watches them.
    fn work(&mut self, bank: &Bank<'_>) {
        let rows = std::mem::take(&mut self.rows);
        match &mut self.stage {
            Stage::Learning => {
                let learned = bank.process.learn(&rows, self.limits, bank.design.horizon);
                self.stage = learned.map_or_else(Stage::Refused, Stage::Watching);
            }
            Stage::Watching(watch) => {
                for (row, k) in rows.iter().zip(self.first..) {
                    // Where a state has grown without bound nothing is watched any more.
                    if !row.control.is_finite() {
                        continue;
                    }
                    let event = watch.step(row);
                    let statistics = watch.statistics();
                    let values = [statistics.outside as u64, statistics.measured as u64];
                    if k < self.from {
                        self.found.count(values, false);
                    } else if k < self.until {
                        self.found.count(values, true);
                    }
                    if let Some(event) = event {
                        self.found.happened(event, k, self.from, bank);
                    }
                }
            }
            Stage::Refused(_) => {}
        }
        self.first += rows.len() as u64;
        self.rows = rows;
        self.rows.clear();
    }

    /// What was found of the scenario.
    pub(super) fn finish(&mut self, bank: &Bank<'_>) -> BankFound {
        self.work(bank);
        let refused = match &self.stage {
            Stage::Refused(error) => Some(error.clone()),
            Stage::Learning | Stage::Watching(_) => None,
        };
        BankFound { refused, ..self.found.clone() }
    }
}

impl BankFound {
    fn count(&mut self, [outside, measured]: [u64; 2], faulty: bool) {
        self.measured[usize::from(faulty)] += measured;
        let counted = &mut self.counts;
        let sum = if faulty { &mut counted.outside_fault } else { &mut counted.outside_healthy };
        *sum += outside;
    }

    /// Takes what sample `k` brought; faults begin at sample `from`, or never.
    fn happened(&mut self, event: Event, k: u64, from: u64, bank: &Bank<'_>) {
        // Where nothing fails, what a false alarm is taken for is told.
        let told = k >= from || from == u64::MAX;
        match event {
            Event::Alarm(_) => {
                if k >= from {
                    self.counts.t_dt.get_or_insert(k + 1);
                } else {
                    self.counts.false_alarms += 1;
                }
                if told {
                    self.heard = Heard::Alarm;
                }
            }
            Event::Judged(Judgement { cause: Cause::Healthy, .. }) => {
                if self.heard == Heard::Alarm {
                    self.heard = Heard::Retracted;
                }
            }
            Event::Judged(judgement) if told && self.named.is_none() => {
                if k >= from {
                    // Its alarm may have come before the fault.
                    self.counts.t_dt.get_or_insert(k + 1);
                }
                self.named = Some(Named::new(&judgement, k, bank.process.mechanisms()));
            }
            Event::Judged(_) | Event::Ended(_) => {}
        }
    }
}
