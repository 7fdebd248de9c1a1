//! Windows of the residual at work.

use drivescope_diagnoser::{LagRun, Memory, MemoryError, Standstill, Walk, WindowWatch};

use crate::declaration::Declaration;
use crate::found::Found;
use crate::method::Method;
use crate::outside::Outside;
use crate::state::Shown;

/// Windows of the residual at work.
#[derive(Debug, Clone)]
pub(crate) struct OfWindows {
    watch: WindowWatch,
    model: LagRun,
    rest: Standstill,
    /// Time of the last window outside.
    last_outside: f64,
    pub(crate) counted: Outside,
    pub(crate) found: Found,
    pub(crate) standing: bool,
}

impl OfWindows {
    pub(crate) fn new(watch: WindowWatch, model: LagRun) -> Self {
        Self {
            watch,
            model,
            rest: Standstill::default(),
            last_outside: 0.0,
            counted: Outside::default(),
            found: Found::new(Method::Windows, None),
            standing: false,
        }
    }

    /// Takes a sample, of that number. Whether a fault is declared with it.
    pub(crate) fn step(
        &mut self,
        (u, y, time): (&[f64], f64, f64),
        (sample, beyond): (usize, bool),
    ) -> bool {
        let residual = y - self.model.step(u);
        let rests = self.rest.step(self.model.model(), u.iter().copied(), y, self.watch.samples());
        let Some(outside) = self.watch.step(residual, rests || beyond) else {
            self.found.end(self.last_outside, &mut self.standing);
            return false;
        };
        self.counted.step(1, usize::from(outside));
        let mut was_standing = std::mem::replace(&mut self.standing, outside);
        let is_onset = outside && !was_standing;
        if is_onset {
            self.found.declare(Declaration { sample, ..Declaration::unknown(time, time) });
        }
        if outside {
            self.last_outside = time;
        } else {
            self.found.end(self.last_outside, &mut was_standing);
        }
        is_onset
    }

    /// A new segment begins.
    pub(crate) fn begin(&mut self) {
        self.watch.reset();
        self.model.reset();
        self.rest = Standstill::default();
        self.found.end(self.last_outside, &mut self.standing);
    }

    /// Whether a window is full.
    pub(crate) fn judges(&self) -> bool {
        self.watch.departure().is_some()
    }

    /// The mean of the last window, less that of the baseline.
    pub(crate) fn shown(&self) -> Shown {
        let (residual, limit) = self.watch.departure().unwrap_or((0.0, 0.0));
        Shown {
            residual,
            lower: -limit,
            upper: limit,
            outside: self.standing,
            standing: self.standing,
        }
    }
}

impl Memory for OfWindows {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.watch.walk(walk)?;
        self.model.walk(walk)?;
        self.rest.walk(walk)?;
        self.last_outside.walk(walk)?;
        self.counted.walk(walk)?;
        self.found.walk(walk)?;
        self.standing.walk(walk)
    }
}
