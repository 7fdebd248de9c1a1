//! What was wrong with the rows of a stream: said as it happens, and counted.

use drivescope_monitor::BRIDGED;
use drivescope_recording::{Error, rounded};
use serde::Serialize;

use super::pace::Arrival;
use crate::session::Session;

/// Remarks of a kind that are made; the others are counted.
const SAID: usize = 5;

/// Rows of a stream, and those that were none.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(crate) struct Stream {
    /// Rows taken.
    pub(super) rows: usize,
    /// Rows that were lost and bridged on a straight line.
    pub(super) bridged: usize,
    /// Gaps, after each of which a new segment began.
    pub(super) gaps: usize,
    /// Times at which the clock was set back.
    pub(super) set_back: usize,
    /// Rows of a time that was there already.
    pub(super) repeated: usize,
    /// Rows of a time before that of the last.
    pub(super) late: usize,
    /// Rows between two samples.
    pub(super) between: usize,
    /// Lines that are no row.
    pub(super) malformed: usize,
    /// Rows without a value that is needed.
    pub(super) incomplete: usize,
}

fn remark(count: usize, what: impl FnOnce() -> String, session: &Session) {
    match count {
        0..SAID => session.remark(format_args!("standard input, {}", what())),
        SAID => session.remark(format_args!(
            "standard input, {}; more of the kind are counted, not said",
            what()
        )),
        _ => {}
    }
}

impl Stream {
    /// Says and counts how a row arrived.
    pub(super) fn arrived(
        &mut self,
        line: u64,
        arrival: Arrival,
        period_s: f64,
        session: &Session,
    ) {
        match arrival {
            Arrival::Row { lost: 0, .. } | Arrival::OtherPeriod(_) => {}
            Arrival::Row { lost, .. } if lost <= BRIDGED => {
                self.bridged += lost;
                let what = || format!("before line {line}: {lost} rows are missing: bridged");
                remark(self.bridged, what, session);
            }
            Arrival::Row { lost, time } => {
                self.gaps += 1;
                let what = || {
                    let seconds = rounded(lost as f64 * period_s);
                    format!(
                        "before line {line}: {seconds} s are missing up to {} s: a new segment begins",
                        rounded(time)
                    )
                };
                remark(self.gaps, what, session);
            }
            Arrival::SetBack { time } => {
                self.set_back += 1;
                let what = || {
                    format!(
                        "line {line}: the clock was set back to {} s: a new segment begins",
                        rounded(time)
                    )
                };
                remark(self.set_back, what, session);
            }
            Arrival::Repeated => {
                self.repeated += 1;
                let what = || format!("line {line}: its time was there already: passed over");
                remark(self.repeated, what, session);
            }
            Arrival::Late => {
                self.late += 1;
                let what = || format!("line {line}: later rows came before it: passed over");
                remark(self.late, what, session);
            }
            Arrival::Between => {
                self.between += 1;
                let what = || format!("line {line}: between two samples: passed over");
                remark(self.between, what, session);
            }
        }
    }

    /// A line that is no row.
    pub(super) fn malformed(&mut self, error: &Error, session: &Session) {
        self.malformed += 1;
        let what = || format!("no row, passed over: {error}");
        remark(self.malformed, what, session);
    }

    /// A row without a value that is needed.
    pub(super) fn incomplete(&mut self, line: u64, session: &Session) {
        self.incomplete += 1;
        let what = || format!("line {line}: a value that is needed is missing: passed over");
        remark(self.incomplete, what, session);
    }

    /// Sums up what was passed over.
    pub(super) fn ended(&self, session: &Session) {
        let counts = [
            (self.bridged, "bridged"),
            (self.gaps, "gaps"),
            (self.set_back, "clock set back"),
            (self.repeated, "repeated"),
            (self.late, "late"),
            (self.between, "between two samples"),
            (self.malformed, "no row"),
            (self.incomplete, "incomplete"),
        ];
        let counted = counts.iter().filter(|(count, _)| *count > 0);
        let counted: Vec<String> = counted.map(|(count, what)| format!("{count} {what}")).collect();
        if !counted.is_empty() {
            session.remark(format_args!(
                "standard input: {} rows taken; {}",
                self.rows,
                counted.join(", ")
            ));
        }
    }
}
