//! A diagnoser as an FMI model, for Co-Simulation.
//!
//! It samples its inputs at the beginning of the communication step in which a sample is due,
//! every sampling time of its training from the start of the run on, and its outputs are those of
//! the last row until the next: `rows` and `row_time` say which that is.

mod description;
mod error;
mod files;
mod layout;
mod stored;

use std::path::Path;
use std::sync::Arc;

use drivescope_diagnoser::{Diagnoser, Memory, MemoryError, Walk, recall, remember};
use drivescope_fmu::description::ModelDescription;
use drivescope_fmu::export::Model;
use drivescope_monitor::{Feed, Method, Options};
use drivescope_recording::Recording;

pub use self::error::DiagnoserError;
pub use self::files::{BASELINE_FILE, DIAGNOSER_FILE};
use self::layout::{Layout, Of};
pub use self::stored::baseline_text;

/// Departure of times, in sampling times, that is rounding.
const ROUNDING: f64 = 1e-6;

/// A diagnoser as an FMI model. Value reference k + 1 is variable k of its layout.
#[derive(Debug, Clone)]
pub struct DiagnoserModel {
    diagnoser: Arc<Diagnoser>,
    baseline: Option<Arc<Recording>>,
    layout: Arc<Layout>,
    /// The signals, in the order of the layout.
    signals: Vec<f64>,
    /// Whether the next row is one.
    valid: bool,
    beta: f64,
    /// Whether the current is measured, where the diagnoser was trained with it.
    has_current: bool,
    /// At work from the initialisation on.
    feed: Option<Feed>,
    start: f64,
    /// Samples that were due.
    due: usize,
    /// Rows that were taken.
    rows: usize,
    row_time: f64,
    /// Samples lost since the last row.
    lost: usize,
}

impl DiagnoserModel {
    /// The FMI model of a diagnoser; with a baseline the machine is known from the start, without
    /// one a bank learns it from the first seconds of a run.
    ///
    /// # Errors
    /// A baseline that does not serve, or signals that the FMU would not have.
    pub fn new(diagnoser: Diagnoser, baseline: Option<Recording>) -> Result<Self, DiagnoserError> {
        let layout = Layout::new(&diagnoser, baseline.is_some());
        let model = Self {
            signals: vec![0.0; layout.signals.len()],
            valid: true,
            beta: diagnoser.confidence.beta(),
            has_current: true,
            feed: None,
            start: 0.0,
            due: 0,
            rows: 0,
            row_time: 0.0,
            lost: 0,
            layout: Arc::new(layout),
            baseline: baseline.map(Arc::new),
            diagnoser: Arc::new(diagnoser),
        };
        model.feed()?;
        Ok(model)
    }

    /// The diagnoser before the first row, with these parameters.
    fn feed(&self) -> Result<Feed, DiagnoserError> {
        let asked = Method::best(&self.diagnoser, self.baseline.is_some());
        let options = Options { asked, beta: Some(self.beta) };
        let current = self.layout.current.filter(|_| !self.has_current);
        let columns: Vec<(&str, &str)> = self
            .layout
            .signals
            .iter()
            .enumerate()
            // A column of another name is none of the bank's.
            .map(|(k, (name, unit))| if Some(k) == current { ("", "") } else { (&**name, &**unit) })
            .collect();
        Ok(Feed::new(&self.diagnoser, &columns, options, self.baseline.as_deref())?)
    }

    /// Length of the baseline and sampling time, s, or nothing where the machine is known.
    pub fn learns_for(&self) -> Option<f64> {
        let bank = self.diagnoser.bank.as_ref().filter(|_| self.baseline.is_none())?;
        Some(bank.baseline as f64 * bank.period_s)
    }

    fn of(&self, reference: u32) -> Option<Of> {
        self.layout.of.get((reference as usize).wrapping_sub(1)).copied()
    }

    /// The row that is due now.
    fn sample(&mut self, time: f64) -> Result<(), DiagnoserError> {
        self.due += 1;
        let Some(feed) = &mut self.feed else { return Ok(()) };
        if !self.valid {
            self.lost += 1;
            return Ok(());
        }
        feed.take(&self.signals, time, std::mem::take(&mut self.lost))?;
        self.rows += 1;
        self.row_time = time;
        Ok(())
    }
}

impl Model for DiagnoserModel {
    type Error = DiagnoserError;

    fn instantiate(resources: Option<&Path>) -> Result<Self, DiagnoserError> {
        let resources = resources.ok_or(DiagnoserError::NoResources)?;
        let diagnoser = Diagnoser::load(&resources.join(DIAGNOSER_FILE))?;
        Self::new(diagnoser, stored::read_baseline(resources)?)
    }

    fn description(&self) -> ModelDescription {
        description::describe(&self.diagnoser, &self.layout, self.learns_for())
    }

    fn get(&self, reference: u32) -> Option<f64> {
        Some(match self.of(reference)? {
            Of::Signal(k) => self.signals[k],
            Of::Valid => f64::from(u8::from(self.valid)),
            Of::Beta => self.beta,
            Of::HasCurrent => f64::from(u8::from(self.has_current)),
            Of::Rows => self.rows as f64,
            Of::RowTime => self.row_time,
            other => self.layout.value(other, self.feed.as_ref().map(Feed::monitor)),
        })
    }

    fn set(&mut self, reference: u32, value: f64) -> Result<(), DiagnoserError> {
        match self.of(reference) {
            Some(Of::Signal(k)) => self.signals[k] = value,
            Some(Of::Valid) => self.valid = value != 0.0,
            Some(Of::Beta) => self.beta = value,
            Some(Of::HasCurrent) => self.has_current = value != 0.0,
            _ => {}
        }
        Ok(())
    }

    fn initialize(&mut self, start: f64) -> Result<(), DiagnoserError> {
        self.feed = Some(self.feed()?);
        (self.start, self.due, self.rows, self.row_time, self.lost) = (start, 0, 0, start, 0);
        Ok(())
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), DiagnoserError> {
        let period_s = self.diagnoser.interface.period_s;
        if h > (1.0 + ROUNDING) * period_s {
            return Err(DiagnoserError::Step { step_s: h, period_s });
        }
        // Times are rounded where they are added up.
        let slack = ROUNDING * period_s;
        let due = self.start + self.due as f64 * period_s;
        if due < t + h - slack {
            self.sample(due)?;
        }
        Ok(())
    }

    fn serialize(&self) -> Vec<u8> {
        remember(&mut self.clone())
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), DiagnoserError> {
        Ok(recall(self, bytes)?)
    }
}

impl Memory for DiagnoserModel {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(&mut self.signals)?;
        walk.each([&mut self.valid, &mut self.has_current])?;
        walk.each([&mut self.beta, &mut self.start, &mut self.row_time])?;
        walk.each([&mut self.due, &mut self.rows, &mut self.lost])?;
        let mut at_work = self.feed.is_some();
        at_work.walk(walk)?;
        if walk.restores() {
            let feed = at_work.then(|| self.feed()).transpose();
            self.feed = feed.map_err(|_| MemoryError)?;
        }
        walk.each(&mut self.feed)
    }
}
