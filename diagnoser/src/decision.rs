//! When a fault is declared, and the rates that a detector is judged by.
//!
//! A fault is declared when `window` samples in a row exceed their band (50 samples are 0.25 s).
//! The detection time t_dt of a run that starts at sample s is s + window, as the paper counts
//! (3968 and 4018). r_td and r_fd are raw shares of exceeding samples, over the fault's span and
//! over a healthy span, without the window.

use std::ops::Range;

use thiserror::Error;

use crate::memory::{Memory, MemoryError, Walk};
use crate::verdict::Verdict;

/// Counts exceedances in a row. A declared fault is held until half as many samples in a row lie
/// inside: single ones within a fault do not end it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunRule {
    window: usize,
    consecutive: usize,
    inside: usize,
    standing: bool,
}

impl RunRule {
    /// Declares after `window` exceedances in a row.
    pub fn new(window: usize) -> Self {
        Self { window, consecutive: 0, inside: 0, standing: false }
    }

    /// Forgets the past.
    pub fn reset(&mut self) {
        *self = Self::new(self.window);
    }

    /// Takes the next sample; whether a fault stands declared.
    #[inline]
    pub fn step(&mut self, exceeds: bool) -> bool {
        (self.consecutive, self.inside) =
            if exceeds { (self.consecutive + 1, 0) } else { (0, self.inside + 1) };
        self.standing = if self.standing {
            2 * self.inside < self.window
        } else {
            self.consecutive >= self.window
        };
        self.standing
    }
}

impl Memory for RunRule {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each([&mut self.consecutive, &mut self.inside])?;
        self.standing.walk(walk)
    }
}

/// A span over which no rate can be stated.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SpanError {
    /// It reaches into the run-up, where nothing is judged.
    #[error("samples {} to {} reach into the run-up of {run_up} samples", span.start, span.end)]
    InRunUp {
        /// The span asked for.
        span: Range<usize>,
        /// Samples that are not judged.
        run_up: usize,
    },
    /// It is empty or ends after the run.
    #[error("samples {} to {} are not within a run of {samples} samples", span.start, span.end)]
    OutsideRun {
        /// The span asked for.
        span: Range<usize>,
        /// Samples of the run.
        samples: usize,
    },
}

/// What a run's declarations say of one fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Detection {
    /// Detection time: the first declaration that counts for the fault.
    pub t_dt: Option<usize>,
    /// Declarations before.
    pub false_alarms: usize,
}

/// A detector's verdicts over a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// One a sample.
    pub verdicts: Vec<Verdict>,
    /// Samples at the start that are not judged.
    pub run_up: usize,
    /// Exceedances in a row that declare a fault.
    pub window: usize,
}

impl Trace {
    /// Share of exceeding samples over a span: r_td over a fault's span, r_fd over a healthy one.
    pub fn exceedance_rate(&self, span: Range<usize>) -> Result<f64, SpanError> {
        self.check(&span)?;
        let length = span.len() as f64;
        let exceeding = self.verdicts[span].iter().filter(|verdict| verdict.exceeds).count();
        Ok(exceeding as f64 / length)
    }

    /// The same run judged by bands `factor` times as wide about the same middle: those of another
    /// significance level.
    pub fn with_bands_scaled(&self, factor: f64) -> Self {
        let mut rule = RunRule::new(self.window);
        let scaled = |(k, verdict): (usize, &Verdict)| {
            let middle = 0.5 * (verdict.upper + verdict.lower);
            let half = 0.5 * factor * (verdict.upper - verdict.lower);
            let (lower, upper) = (middle - half, middle + half);
            let inside = lower <= verdict.residual && verdict.residual <= upper;
            let exceeds = k >= self.run_up && !inside;
            Verdict { lower, upper, exceeds, declared: rule.step(exceeds), ..*verdict }
        };
        let verdicts = self.verdicts.iter().enumerate().map(scaled).collect();
        Self { verdicts, ..*self }
    }

    /// Refuses spans over which nothing can be stated.
    pub(crate) fn check(&self, span: &Range<usize>) -> Result<(), SpanError> {
        let samples = self.verdicts.len();
        if span.is_empty() || span.end > samples {
            return Err(SpanError::OutsideRun { span: span.clone(), samples });
        }
        if span.start < self.run_up {
            return Err(SpanError::InRunUp { span: span.clone(), run_up: self.run_up });
        }
        Ok(())
    }

    /// What the declarations say of a fault that begins at sample `onset`.
    ///
    /// Chance exceedances before the onset may begin the run that the fault completes, so that t_dt
    /// may be less than onset + window. A declaration counts for the fault if most of its run lies
    /// in the fault; one before that is a false alarm (as is the paper's 4018, of which 32 of 50
    /// samples lie before the fault).
    pub fn detection(&self, onset: usize) -> Detection {
        let declarations = self.declarations();
        let of_fault = |t_dt: &usize| *t_dt > onset && 2 * (t_dt - onset) > self.window;
        let first = declarations.iter().position(of_fault);
        Detection {
            t_dt: first.map(|first| declarations[first]),
            false_alarms: first.unwrap_or(declarations.len()),
        }
    }

    /// t_dt of every declaration, in order: start of its run of exceedances + window.
    pub fn declarations(&self) -> Vec<usize> {
        let mut times = Vec::new();
        let mut standing = false;
        for (k, verdict) in self.verdicts.iter().enumerate() {
            if verdict.declared && !standing {
                times.push(k + 1);
            }
            standing = verdict.declared;
        }
        times
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(exceeding: impl Fn(usize) -> bool, samples: usize) -> Trace {
        let mut rule = RunRule::new(50);
        let verdicts = (0..samples)
            .map(|k| Verdict {
                residual: 0.0,
                lower: -1.0,
                upper: 1.0,
                exceeds: exceeding(k),
                declared: rule.step(exceeding(k)),
            })
            .collect();
        Trace { verdicts, run_up: 10, window: 50 }
    }

    #[test]
    fn the_detection_time_is_the_start_of_the_run_and_fifty() {
        let trace = trace(|k| k >= 3968, 5000);
        assert_eq!(trace.declarations(), [4018]);
        assert_eq!(trace.exceedance_rate(4000..5000), Ok(1.0));
        assert_eq!(trace.exceedance_rate(3000..4000), Ok(0.032));
    }

    #[test]
    fn a_declaration_counts_for_a_fault_that_most_of_its_run_lies_in() {
        let found = |from: usize| trace(|k| k >= from, 5000).detection(4000);
        let counted = |t_dt| Detection { t_dt: Some(t_dt), false_alarms: 0 };
        let false_alarm = Detection { t_dt: None, false_alarms: 1 };
        assert_eq!((found(4000), found(3999)), (counted(4050), counted(4049)));
        assert_eq!((found(3976), found(3975)), (counted(4026), false_alarm));
        assert_eq!((found(3968), found(3000)), (false_alarm, false_alarm));
        let twice = trace(|k| (2000..2100).contains(&k) || k >= 4003, 5000);
        assert_eq!(twice.detection(4000), Detection { t_dt: Some(4053), false_alarms: 1 });
        assert_eq!(found(5000), Detection { t_dt: None, false_alarms: 0 });
    }

    #[test]
    fn forty_nine_in_a_row_are_not_enough_and_each_run_counts_once() {
        let trace = trace(|k| k % 50 != 49 || (1000..1200).contains(&k), 2000);
        assert_eq!(trace.declarations(), [1050]);
        let twice = super::tests::trace(|k| (100..200).contains(&k) || k >= 300, 400);
        assert_eq!(twice.declarations(), [150, 350]);
    }

    #[test]
    fn rates_break_when_their_meaning_is_broken() {
        // An always-exceeding band has a perfect r_td and shows it by r_fd = 1 ...
        let always = trace(|_| true, 5000);
        assert_eq!(always.exceedance_rate(4000..5000), Ok(1.0));
        assert_eq!(always.exceedance_rate(1000..4000), Ok(1.0));
        assert!(always.declarations()[0] < 4000);
        // ... and with labels shuffled (a healthy span called faulty) r_td is r_fd.
        let fault = trace(|k| k >= 4000 || k % 20 == 0, 5000);
        assert_eq!(fault.exceedance_rate(1000..2000), Ok(0.05));
    }

    #[test]
    fn wider_bands_are_exceeded_less() {
        let mut run = trace(|_| true, 200);
        run.verdicts.iter_mut().enumerate().for_each(|(k, v)| v.residual = 0.02 * k as f64);
        // |r| exceeds 1 from sample 51 on, and 2 from sample 101 on.
        let (once, twice) = (run.with_bands_scaled(1.0), run.with_bands_scaled(2.0));
        assert_eq!((once.declarations(), twice.declarations()), (vec![101], vec![151]));
        assert_eq!((twice.verdicts[0].lower, twice.verdicts[0].upper), (-2.0, 2.0));
        // Nothing exceeds in the run-up, whatever the width.
        assert!(!run.with_bands_scaled(0.0).verdicts[9].exceeds);
    }

    #[test]
    fn spans_without_meaning_are_refused() {
        let trace = trace(|_| false, 100);
        assert_eq!(
            trace.exceedance_rate(5..50),
            Err(SpanError::InRunUp { span: 5..50, run_up: 10 })
        );
        assert!(matches!(trace.exceedance_rate(50..101), Err(SpanError::OutsideRun { .. })));
        assert!(matches!(trace.exceedance_rate(50..50), Err(SpanError::OutsideRun { .. })));
    }
}
