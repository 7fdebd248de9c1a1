//! Rows from standard input.

use drivescope_diagnoser::Diagnoser;
use drivescope_monitor::{Feed, Happened, Method, Monitor, Options};
use drivescope_recording::{CsvStream, Mapping, ReadOptions, Recording, rounded};

use super::pace::{Arrival, Pace};
use super::regrid::Regrid;
use super::stdin::Stdin;
use super::stream::Stream;
use super::{Diagnose, refused};
use crate::answer::diagnose::words;
use crate::failure::{Failure, into_report};
use crate::session::Session;
use crate::{interrupt, output};

/// Whether rows are wanted still.
#[derive(PartialEq)]
enum Wanted {
    Yes,
    No,
}

impl Diagnose {
    /// Takes rows as they come in: a decision is said at once. Rows that are lost, late, repeated or
    /// no rows are said and counted.
    pub(super) fn live(
        &self,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        asked: Method,
        session: &Session,
    ) -> miette::Result<(Monitor, Stream)> {
        interrupt::answers();
        let columns = self.reading.columns().map(Mapping::parse_list).transpose();
        let options = ReadOptions {
            columns: columns.map_err(into_report)?.unwrap_or_default(),
            ..ReadOptions::default()
        };
        let mut rows =
            CsvStream::new(Stdin::open(), "standard input", &options).map_err(into_report)?;
        let names = rows.columns().iter();
        let names: Vec<(String, String)> =
            names.map(|it| (it.signal.clone(), it.unit.clone())).collect();
        let named: Vec<(&str, &str)> = names.iter().map(|it| (&*it.0, &*it.1)).collect();
        let options = Options { asked, beta: self.beta };
        let feed = Feed::new(diagnoser, &named, options, baseline);
        let mut feed = feed.map_err(|error| refused(&self.diagnoser, &error))?;
        self.remark_on(feed.monitor(), diagnoser, baseline, session);
        let period_s = diagnoser.interface.period_s;
        let mut stream = Stream::default();
        let mut pace = Pace::new(period_s);
        let mut regrid = self.regrid(period_s, &named)?;
        loop {
            let row = match rows.next_row() {
                Ok(Some(row)) => row,
                Ok(None) => break,
                Err(error) if error.is_of_row() => {
                    stream.malformed(&error, session);
                    continue;
                }
                Err(error) => return Err(into_report(error)),
            };
            let line = row.line;
            if !feed.is_complete(row.values) {
                stream.incomplete(line, session);
                continue;
            }
            if let Some(regrid) = &mut regrid {
                if let Some(problem) = regrid.push(row.time_s, row.values) {
                    stream.arrived(line, problem, period_s, session);
                }
                while let Some((time, values, lost)) = regrid.next_row() {
                    stream.rows += 1;
                    let happened = feed.take(&values, time, lost).map_err(into_report)?;
                    if self.say(happened, line, asked, session)? == Wanted::No {
                        return Ok((feed.into_monitor(), stream));
                    }
                }
                continue;
            }
            let arrival = pace.arrives(row.time_s);
            let (lost, time) = match arrival {
                Arrival::Row { lost, time } => (lost, time),
                // No rows are between two clocks: a new segment begins.
                Arrival::SetBack { time } => (usize::MAX, time),
                Arrival::OtherPeriod(found) => return Err(other_period(found, line, period_s)),
                Arrival::Repeated | Arrival::Late | Arrival::Between => {
                    stream.arrived(line, arrival, period_s, session);
                    continue;
                }
            };
            stream.arrived(line, arrival, period_s, session);
            stream.rows += 1;
            let happened = feed.take(row.values, time, lost).map_err(into_report)?;
            if self.say(happened, line, asked, session)? == Wanted::No {
                break;
            }
        }
        stream.ended(session);
        Ok((feed.into_monitor(), stream))
    }

    /// What puts rows of any rate on the grid of the diagnoser, where that was asked for.
    fn regrid(&self, period_s: f64, columns: &[(&str, &str)]) -> miette::Result<Option<Regrid>> {
        /// Departure that is none: printed times are rounded.
        const SAME: f64 = 1e-4;
        let Some(asked_s) = self.reading.resample() else { return Ok(None) };
        // Written so that NaN is refused.
        let same = (asked_s - period_s).abs() <= SAME * period_s;
        if !same {
            return Err(Failure::Usage {
                what: format!(
                    "--resample {}: the diagnoser takes a row every {} s",
                    rounded(asked_s),
                    rounded(period_s)
                ),
                instead: format!("give --resample {}", rounded(period_s)),
            }
            .into());
        }
        let held = columns.iter().map(|(name, _)| *name == "u").collect();
        Ok(Some(Regrid::new(period_s, held)))
    }

    /// Says what rows brought.
    fn say(
        &self,
        happened: Vec<(f64, Happened)>,
        line: u64,
        asked: Method,
        session: &Session,
    ) -> miette::Result<Wanted> {
        for (time, happened) in happened {
            let json = asked == Method::Bank && session.prints_json();
            let (said, of_asked) = match happened {
                Happened::Decision(decision) if json => (output::json_line(&decision)?, true),
                Happened::Decision(decision) => (words::decision(&decision), asked == Method::Bank),
                Happened::Declared(method) if method == asked => {
                    (format!("fault declared at {} s (line {line})", rounded(time)), true)
                }
                Happened::Declared(method) => {
                    (format!("{}: declared at {} s", method.label(), rounded(time)), false)
                }
                Happened::Named(fault) => {
                    (format!("at {} s: {}", rounded(time), words::fault(&fault)), true)
                }
            };
            if !of_asked || (session.prints_json() && !json) {
                session.remark(said);
                continue;
            }
            match output::print(&format!("{said}\n")) {
                // Nobody reads any more. An exit code and a file are answers still, and rest
                // on all rows.
                Err(Failure::Unread) if self.check || session.writes_json() => {}
                Err(Failure::Unread) => return Ok(Wanted::No),
                printed => printed?,
            }
        }
        Ok(Wanted::Yes)
    }
}

fn other_period(found: f64, line: u64, period_s: f64) -> miette::Report {
    let expected = rounded(period_s);
    Failure::Usage {
        what: format!(
            "standard input, up to line {line}: a row every {} s, the diagnoser was trained on \
             {expected} s",
            rounded(found)
        ),
        instead: format!("give rows at that sampling time, or --resample {expected}"),
    }
    .into()
}
