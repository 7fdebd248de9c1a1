//! All methods of a diagnoser at work on one machine.

use drivescope_diagnoser::bank::{Limits, Mechanism, Row, Statistics};
use drivescope_diagnoser::{Diagnoser, Memory, MemoryError, Walk};
use drivescope_recording::Recording;

use crate::bank::Columns;
use crate::detectors::Detectors;
use crate::error::MonitorError;
use crate::found::Finished;
use crate::happened::Happened;
use crate::method::Method;
use crate::of_bank::OfBank;
use crate::state::{Shown, Standing};

/// How a machine is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The method whose declarations are the verdict.
    pub asked: Method,
    /// Another share of healthy samples outside the bands than the diagnoser's.
    pub beta: Option<f64>,
}

/// A healthy run of the machine or day, at the sampling time of the diagnoser.
pub type Baseline<'a> = Option<&'a Recording>;

/// All methods at work on one machine.
#[derive(Debug, Clone)]
pub struct Monitor {
    detectors: Detectors,
    bank: Option<OfBank>,
    asked: Method,
}

impl Monitor {
    /// All methods before the first row, whose columns have these names and units.
    ///
    /// # Errors
    /// A method that is not there, signals or a baseline that do not serve.
    pub fn new(
        diagnoser: &Diagnoser,
        columns: &[(&str, &str)],
        options: Options,
        baseline: Baseline,
    ) -> Result<Self, MonitorError> {
        let Options { asked, beta } = options;
        let data = baseline.map(|baseline| {
            let data = diagnoser.interface.select(baseline)?;
            Ok::<_, MonitorError>((baseline.name.as_str(), data))
        });
        let data = data.transpose()?;
        let of_baseline = data.as_ref().map(|(name, data)| (*name, data));
        let detectors = Detectors::new(diagnoser, asked, beta, of_baseline)?;
        let bank = diagnoser.bank.as_ref().map(|design| {
            let columns = Columns::find(columns)?;
            let Some(baseline) = baseline else { return OfBank::new(design, columns, None) };
            // A machine is learned from a run without gaps.
            let parts = baseline.parts();
            let longest = parts.iter().max_by_key(|part| part.len()).unwrap_or(baseline);
            let (_, rows) = Columns::of(longest)?;
            OfBank::new(design, columns, Some((&baseline.name, &rows)))
        });
        let bank = bank.transpose()?;
        if asked == Method::Bank && bank.is_none() {
            return Err(MonitorError::Missing { method: asked });
        }
        Ok(Self { detectors, bank, asked })
    }

    /// The method whose declarations are the verdict.
    pub fn asked(&self) -> Method {
        self.asked
    }

    /// Whether the bank lacks the current.
    pub fn is_without_current(&self) -> bool {
        self.bank.as_ref().is_some_and(|bank| !bank.columns().has_current())
    }

    /// A gap: what follows is a new segment.
    pub fn begin(&mut self) {
        self.detectors.begin();
        self.bank.iter_mut().for_each(OfBank::begin);
    }

    /// Takes a row: inputs and output of the detectors, the value of each column, and its time, s.
    ///
    /// # Errors
    /// Values that are not finite.
    pub fn step(
        &mut self,
        (u, y): (&[f64], f64),
        value: impl Fn(usize) -> f64,
        time: f64,
    ) -> Result<Vec<Happened>, MonitorError> {
        let mut happened = self.detectors.step(u, y, time)?;
        let decision = self.bank.as_mut().and_then(|bank| {
            let row: Row = bank.columns().row(value);
            bank.step(&row, time)
        });
        happened.extend(decision.map(Happened::Decision));
        Ok(happened)
    }

    /// Takes a whole recording of the signals of the training; every row is shown to `each`.
    ///
    /// # Errors
    /// Other signals, or values that are not finite.
    pub fn run(
        &mut self,
        diagnoser: &Diagnoser,
        recording: &Recording,
        mut each: impl FnMut(&Self, usize, &[Happened]),
    ) -> Result<(), MonitorError> {
        let data = diagnoser.interface.select(recording)?;
        let mut u = vec![0.0; data.inputs().len()];
        let mut breaks = recording.breaks.iter().map(|it| it.at).peekable();
        for (k, y) in data.output().values.iter().enumerate() {
            if breaks.next_if_eq(&k).is_some() {
                self.begin();
            }
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            let value = |at: usize| recording.signals[at].values[k];
            let happened = self.step((&u, *y), value, recording.time(k))?;
            each(self, k, &happened);
        }
        Ok(())
    }

    /// Residual and band of a detector of the residual; none if the diagnoser does not hold it.
    pub fn shown(&self, method: Method) -> Option<Shown> {
        self.detectors.shown(method)
    }

    /// Statistics of the bank at the last row, and their limits; none before a machine is known.
    pub fn statistics(&self) -> Option<(Statistics, Limits)> {
        self.bank.as_ref()?.statistics()
    }

    /// The mechanisms of the bank.
    pub fn mechanisms(&self) -> &[Mechanism] {
        self.bank.as_ref().map_or(&[], OfBank::mechanisms)
    }

    /// Where a method stands; none if the diagnoser does not hold it.
    pub fn standing(&self, method: Method) -> Option<Standing<'_>> {
        let (state, found) = match method {
            Method::Bank => self.bank.as_ref()?.standing(),
            _ => self.detectors.standing(method)?,
        };
        let declaration = found.declarations.last().filter(|last| last.to.is_none());
        Some(Standing { state, declared: found.count(), declaration })
    }

    /// What every method found.
    pub fn finish(self) -> Finished {
        let found = self.detectors.finish();
        let mut methods = found.methods;
        let machine = self.bank.map(|bank| {
            let (machine, of_bank) = bank.finish();
            methods.insert(0, of_bank);
            machine
        });
        let (samples, run_up, beyond) = (found.samples, found.run_up, found.beyond);
        Finished { samples, run_up, beyond, machine, methods }
    }
}

impl Memory for Monitor {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.detectors.walk(walk)?;
        walk.each(&mut self.bank)
    }
}
