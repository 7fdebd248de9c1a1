//! What a method found.

use drivescope_diagnoser::{Isolated, KnownFaults, Memory, MemoryError, Named, Size, Walk};
use serde::Serialize;

use crate::declaration::{Declaration, UNKNOWN};
use crate::method::Method;

/// Declarations of a method that are kept: of a run that flickers for months the latest.
pub(crate) const MOST_KEPT: usize = 10_000;

/// What a method found until now.
#[derive(Debug, Clone, Serialize)]
pub struct Found {
    pub method: Method,
    /// `healthy`, `fault`, `abnormal` or `not_judged`.
    pub verdict: &'static str,
    /// Share of healthy values outside; none for a method that knows no such level.
    pub beta: Option<f64>,
    /// Values judged.
    pub judged: usize,
    /// Of these, outside.
    pub outside: usize,
    /// Their share; none if nothing was judged.
    pub exceedance_rate: Option<f64>,
    /// When a fault was declared.
    pub declared: Vec<Declared>,
    /// What was declared.
    pub declarations: Vec<Declaration>,
    /// Earlier declarations that were dropped, so that memory stays bounded.
    #[serde(skip_serializing_if = "is_none")]
    pub dropped: usize,
}

fn is_none(count: &usize) -> bool {
    *count == 0
}

/// A fault was declared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Declared {
    /// Samples from the start of the recording, the one that completes the window included.
    pub sample: usize,
    /// Its time, s.
    pub time: f64,
    /// What was declared, where faults are known by name and the method is the one asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<Fault>,
}

/// A fault by its name and size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// The known faults that it may be, or `unknown`.
    pub class: String,
    /// Samples at which it stood declared.
    pub samples: usize,
    /// Share of these samples that were answered so.
    pub share: f64,
    /// Its size (27).
    #[serde(rename = "S")]
    pub s: f64,
    /// Its size relative to the known faults.
    pub group: Size,
}

/// Between the faults of a class.
const BETWEEN: &str = " | ";

impl Fault {
    /// What the symptoms of a standing fault came to.
    pub(crate) fn new(known: &KnownFaults, named: &Named) -> Self {
        let unknown = named.shares.len() - 1;
        let (class, place) = match named.answer {
            Isolated::Class(class) => (known.class(class).join(BETWEEN), class),
            Isolated::Unknown => (UNKNOWN.to_owned(), unknown),
        };
        let Named { samples, size, group, .. } = *named;
        Self { class, samples, share: named.shares[place], s: size, group }
    }

    /// The known faults that it may be.
    pub(crate) fn names(&self) -> Vec<String> {
        let known = (self.class != UNKNOWN).then(|| self.class.split(BETWEEN));
        known.into_iter().flatten().map(str::to_owned).collect()
    }
}

impl Found {
    pub(crate) fn new(method: Method, beta: Option<f64>) -> Self {
        Self {
            method,
            beta,
            verdict: "not_judged",
            judged: 0,
            outside: 0,
            exceedance_rate: None,
            declared: Vec::new(),
            declarations: Vec::new(),
            dropped: 0,
        }
    }

    /// A fault is declared with this sample.
    pub(crate) fn declare(&mut self, declaration: Declaration) {
        if self.declarations.len() >= MOST_KEPT {
            // Half of them at once, or every further one would move all.
            self.dropped += MOST_KEPT / 2;
            self.declarations.drain(..MOST_KEPT / 2);
            self.declared.drain(..self.declared.len().min(MOST_KEPT / 2));
        }
        let Declaration { sample, noticed: time, .. } = declaration;
        self.declared.push(Declared { sample, time, fault: None });
        self.declarations.push(declaration);
    }

    /// Ends the declaration that stands, if one does, with its last sample outside.
    pub(crate) fn end(&mut self, last_outside: f64, standing: &mut bool) {
        if std::mem::take(standing)
            && let Some(last) = self.declarations.last_mut()
        {
            last.to = Some(last_outside.max(last.from));
        }
    }

    /// How often a fault was declared.
    pub(crate) fn count(&self) -> usize {
        self.dropped + self.declarations.len()
    }
}

/// The last declaration and how many there were: what goes on depends on no other.
impl Memory for Found {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let mut count = self.count();
        count.walk(walk)?;
        let mut last = self.declarations.last().cloned();
        walk.maybe(&mut last, Declaration::blank)?;
        if walk.restores() {
            let declared =
                |it: &Declaration| Declared { sample: it.sample, time: it.noticed, fault: None };
            self.declared = last.iter().map(declared).collect();
            self.declarations = last.into_iter().collect();
            self.dropped = count.checked_sub(self.declarations.len()).ok_or(MemoryError)?;
        }
        Ok(())
    }
}

/// What a bank learned of the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Rows of the run itself that it was learned from; none with a baseline.
    pub learned: usize,
    /// What it differs by from the drive, as fractions.
    pub changes: Vec<(String, f64)>,
    /// Why nothing was judged.
    pub why: Option<String>,
}

/// What every method found over a run.
#[derive(Debug, Clone)]
pub struct Finished {
    pub samples: usize,
    /// Of these, only settling the models.
    pub run_up: usize,
    /// Of these, at operating points that the detectors of the residual were not designed on.
    pub beyond: usize,
    /// What the bank learned of the machine.
    pub machine: Option<Machine>,
    pub methods: Vec<Found>,
}
