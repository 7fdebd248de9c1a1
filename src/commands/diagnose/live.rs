//! Rows from standard input.

use std::io;

use drivescope_diagnoser::Diagnoser;
use drivescope_recording::{CsvStream, Mapping, ReadOptions, Recording, rounded};

use super::method::Method;
use super::watch::Event;
use super::{Diagnose, Happened, Working};
use crate::failure::{Failure, told};
use crate::session::Session;
use crate::{interrupt, output};

impl Diagnose {
    /// Takes rows as they come in: a declaration is said at once.
    pub(super) fn live(
        &self,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        asked: Method,
        session: &Session,
    ) -> miette::Result<Working> {
        /// Departure of the mean sampling time from the diagnoser's that is taken for jitter.
        const SAME_PERIOD: f64 = 0.01;
        let columns = self.reading.columns().map(Mapping::parse_list).transpose();
        let options = ReadOptions {
            columns: columns.map_err(told)?.unwrap_or_default(),
            ..ReadOptions::default()
        };
        let stdin = io::stdin().lock();
        let mut rows = CsvStream::new(stdin, "standard input", &options).map_err(told)?;
        let interface = &diagnoser.interface;
        let place = |channel: &drivescope_diagnoser::Channel| -> miette::Result<usize> {
            let columns = rows.columns();
            let found = columns.iter().position(|column| column.signal == channel.name);
            let at = found.ok_or_else(|| Failure::Usage {
                what: format!("standard input: there is no signal `{}`", channel.name),
                instead: "name its column with --columns".to_owned(),
            })?;
            if columns[at].unit != channel.unit {
                return Err(Failure::Usage {
                    what: format!(
                        "standard input: `{}` is in {}, the diagnoser was trained on {}",
                        channel.name, columns[at].unit, channel.unit
                    ),
                    instead: "give the unit of the column with --columns".to_owned(),
                }
                .into());
            }
            Ok(at)
        };
        let inputs = interface.inputs.iter().map(place).collect::<miette::Result<Vec<_>>>()?;
        let watched = place(&interface.output)?;
        let columns = rows.columns().iter();
        let columns: Vec<(&str, &str)> = columns.map(|it| (&*it.signal, &*it.unit)).collect();
        let mut working = self.working(diagnoser, baseline, (asked, &columns), session)?;
        let mut u = vec![0.0; inputs.len()];
        let mut last = None;
        loop {
            interrupt::check()?;
            let Some(row) = rows.next_row().map_err(told)? else { break };
            let (line, time) = (row.line, row.time_s);
            u.iter_mut().zip(&inputs).for_each(|(u, at)| *u = row.values[*at]);
            let y = row.values[watched];
            if let Some(before) = last.replace(time) {
                let (expected, found) = (interface.period_s, time - before);
                if (found - expected).abs() > SAME_PERIOD * expected {
                    return Err(Failure::Usage {
                        what: format!(
                            "standard input, line {line}: {} s after the row before, the \
                             diagnoser was trained on {} s",
                            rounded(found),
                            rounded(expected)
                        ),
                        instead: "give rows at that sampling time".to_owned(),
                    }
                    .into());
                }
            }
            for happened in working.step((&u, y), |at| row.values[at], time)? {
                let (said, of_asked) = match happened {
                    Happened::Decision(decision) => {
                        let of_asked = asked == Method::Bank;
                        match of_asked && session.prints_json() {
                            true => (output::json_line(&decision)?, true),
                            false => (decision.text(), of_asked),
                        }
                    }
                    Happened::Event(Event::Declared(method)) if method == asked => {
                        (format!("fault declared at {} s (line {line})", rounded(time)), true)
                    }
                    Happened::Event(Event::Declared(method)) => {
                        (format!("{}: declared at {} s", method.label(), rounded(time)), false)
                    }
                    Happened::Event(Event::Named(fault)) => {
                        (format!("at {} s: {}", rounded(time), fault.text()), true)
                    }
                };
                let printed = of_asked && (asked == Method::Bank || !session.prints_json());
                if printed {
                    match output::print(&format!("{said}\n")) {
                        // Nobody reads any more. An exit code and a file are answers still, and rest
                        // on all rows.
                        Err(Failure::Unread) if self.check || session.writes_json() => {}
                        Err(Failure::Unread) => return Ok(working),
                        printed => printed?,
                    }
                } else {
                    session.remark(said);
                }
            }
        }
        Ok(working)
    }
}
