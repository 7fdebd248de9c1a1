//! Rows that come one at a time, some of them lost on the way, to a monitor.
//!
//! A few lost rows are bridged on a straight line, as a recording of the same rows is when it is
//! read; after more of them a new segment begins.

use drivescope_diagnoser::{Channel, Diagnoser, Memory, MemoryError, Walk};

use crate::error::MonitorError;
use crate::happened::Happened;
use crate::monitor::{Baseline, Monitor, Options};

/// Lost rows that are bridged.
pub const BRIDGED: usize = 3;

/// A monitor and what it takes to hand it rows.
#[derive(Debug, Clone)]
pub struct Feed {
    monitor: Monitor,
    /// Places of the detectors' inputs and output among the columns.
    inputs: Vec<usize>,
    output: usize,
    period_s: f64,
    u: Vec<f64>,
    /// The row before; none at the start of a segment.
    last: Vec<f64>,
    last_time: f64,
    begun: bool,
}

impl Feed {
    /// As [`Monitor::new`], for rows of those columns.
    ///
    /// # Errors
    /// As there, and a signal of the training that is missing or in another unit.
    pub fn new(
        diagnoser: &Diagnoser,
        columns: &[(&str, &str)],
        options: Options,
        baseline: Baseline,
    ) -> Result<Self, MonitorError> {
        let place = |channel: &Channel| {
            let at = columns.iter().position(|(name, _)| *name == channel.name);
            let at = at.ok_or_else(|| MonitorError::Signal { name: channel.name.clone() })?;
            let (name, unit) = columns[at];
            if unit == channel.unit {
                return Ok(at);
            }
            let (name, unit, trained) = (name.to_owned(), unit.to_owned(), channel.unit.clone());
            Err(MonitorError::Unit { name, unit, trained })
        };
        let interface = &diagnoser.interface;
        let inputs = interface.inputs.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        let output = place(&interface.output)?;
        Ok(Self {
            monitor: Monitor::new(diagnoser, columns, options, baseline)?,
            u: vec![0.0; inputs.len()],
            inputs,
            output,
            period_s: interface.period_s,
            last: vec![0.0; columns.len()],
            last_time: 0.0,
            begun: false,
        })
    }

    /// The monitor.
    pub fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// The monitor, once there are no more rows.
    pub fn into_monitor(self) -> Monitor {
        self.monitor
    }

    /// Whether a row shows what the detectors need; one that does not is a lost one.
    pub fn is_complete(&self, values: &[f64]) -> bool {
        self.inputs.iter().chain([&self.output]).all(|at| values[*at].is_finite())
    }

    /// Takes a complete row of that time, s, before which so many were lost. What it brought, each
    /// with the time of its row.
    ///
    /// # Errors
    /// As [`Monitor::step`].
    pub fn take(
        &mut self,
        values: &[f64],
        time: f64,
        lost: usize,
    ) -> Result<Vec<(f64, Happened)>, MonitorError> {
        let mut happened = Vec::new();
        if self.begun && lost > BRIDGED {
            self.monitor.begin();
        } else if self.begun {
            let last = std::mem::take(&mut self.last);
            let start = self.last_time;
            let mut between = vec![0.0; values.len()];
            for k in 1..=lost {
                let share = k as f64 / (lost + 1) as f64;
                let ends = last.iter().zip(values);
                between.iter_mut().zip(ends).for_each(|(x, (a, b))| *x = a + share * (b - a));
                self.step(&between, start + k as f64 * self.period_s, &mut happened)?;
            }
            self.last = last;
        }
        self.step(values, time, &mut happened)?;
        self.begun = true;
        self.last_time = time;
        self.last.copy_from_slice(values);
        Ok(happened)
    }

    fn step(
        &mut self,
        values: &[f64],
        time: f64,
        happened: &mut Vec<(f64, Happened)>,
    ) -> Result<(), MonitorError> {
        self.u.iter_mut().zip(&self.inputs).for_each(|(u, at)| *u = values[*at]);
        let brought = self.monitor.step((&self.u, values[self.output]), |at| values[at], time)?;
        happened.extend(brought.into_iter().map(|it| (time, it)));
        Ok(())
    }
}

impl Memory for Feed {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.monitor.walk(walk)?;
        walk.each(&mut self.last)?;
        self.last_time.walk(walk)?;
        self.begun.walk(walk)
    }
}
