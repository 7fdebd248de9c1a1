//! All methods of a diagnoser over rows of one signal set, in memory that grows only with declarations.

use std::sync::Arc;

use drivescope_diagnoser::{
    Band, Confidence, Detector, Diagnoser, KnownFaults, ModelRun, Naming, ThresholdRun,
};
use drivescope_scenarios::results::Method;

use super::answer::{Declared, Fault, Found};
use crate::failure::told;

/// A detector with what it found so far.
struct Watching {
    detector: Detector<ModelRun, ThresholdRun>,
    found: Found,
    standing: bool,
}

/// The methods at work, and the naming of what the one that was asked for declares.
pub(super) struct Watch {
    watching: Vec<Watching>,
    asked: Method,
    known: Option<Arc<KnownFaults>>,
    /// T of (27).
    threshold: Band,
    /// Symptoms of the fault that stands declared.
    naming: Option<Naming>,
    window: usize,
    /// Samples that settle the models of a segment.
    settling: usize,
    /// Samples that settle the models, of all segments.
    run_up: usize,
    samples: usize,
    /// Samples of the segment at hand.
    of_segment: usize,
}

/// What a sample brought.
pub(super) enum Event {
    /// A method declares a fault.
    Declared(Method),
    /// A window after the declaration, what the fault is.
    Named(Fault),
}

impl Watch {
    pub(super) fn new(
        diagnoser: &Diagnoser,
        asked: Method,
        beta: Option<f64>,
    ) -> miette::Result<Self> {
        let confidence = match beta {
            Some(beta) => Confidence::new(beta).map_err(told)?,
            None => diagnoser.confidence,
        };
        let has = |method: &Method| match method {
            Method::Mem | Method::Constant => true,
            Method::MemRecurrent => diagnoser.recurrent_error.is_some(),
            Method::Gmdh => diagnoser.gmdh.is_some(),
        };
        let watching = Method::ALL.into_iter().filter(has).map(|method| {
            let detector = diagnoser.detector_at(method.kind(), confidence).map_err(told)?;
            let beta = (method != Method::Gmdh).then_some(confidence.beta());
            let (declared, exceedance_rate) = (Vec::new(), None);
            let found = Found { method, beta, outside: 0, exceedance_rate, declared };
            Ok(Watching { detector, found, standing: false })
        });
        Ok(Self {
            watching: watching.collect::<miette::Result<_>>()?,
            asked,
            known: diagnoser.faults.clone(),
            threshold: diagnoser.constant.band(diagnoser.confidence),
            naming: None,
            window: diagnoser.window,
            settling: diagnoser.run_up,
            run_up: 0,
            samples: 0,
            of_segment: 0,
        })
    }

    /// Whether the method that was asked for is there.
    pub(super) fn has_asked(&self) -> bool {
        self.watching.iter().any(|watching| watching.found.method == self.asked)
    }

    /// A new segment begins: the models settle anew, what was found stays.
    pub(super) fn begin(&mut self) {
        self.close();
        for Watching { detector, standing, .. } in &mut self.watching {
            detector.reset();
            *standing = false;
        }
        self.naming = None;
    }

    fn close(&mut self) {
        self.run_up += self.settling.min(self.of_segment);
        self.of_segment = 0;
    }

    /// Takes a sample.
    pub(super) fn step(&mut self, u: &[f64], y: f64, time: f64) -> miette::Result<Vec<Event>> {
        let mut events = Vec::new();
        let (mut residual, mut stands) = (f64::NAN, false);
        for Watching { detector, found, standing } in &mut self.watching {
            let verdict = detector.step(u, y).map_err(told)?;
            found.outside += usize::from(verdict.exceeds);
            if verdict.declared && !*standing {
                let sample = self.samples + 1;
                found.declared.push(Declared { sample, time, fault: None });
                events.push(Event::Declared(found.method));
                if found.method == self.asked {
                    self.naming =
                        self.known.clone().map(|known| Naming::new(known, self.threshold));
                }
            }
            *standing = verdict.declared;
            // Symptoms are residuals of the process model; a GMDH network has others.
            if found.method == Method::Constant {
                residual = verdict.residual;
            }
            stands |= verdict.declared && found.method == self.asked;
        }
        self.samples += 1;
        self.of_segment += 1;
        if stands {
            events.extend(self.name(u, residual)?);
        }
        Ok(events)
    }

    /// Takes a symptom of the fault that stands declared.
    fn name(&mut self, u: &[f64], residual: f64) -> miette::Result<Option<Event>> {
        let (Some(naming), Some(known)) = (&mut self.naming, &self.known) else { return Ok(None) };
        naming.step(u, residual).map_err(told)?;
        let Some(named) = naming.named() else { return Ok(None) };
        let fault = Fault::new(known, &named);
        let of_asked =
            self.watching.iter_mut().find(|watching| watching.found.method == self.asked);
        if let Some(declared) = of_asked.and_then(|watching| watching.found.declared.last_mut()) {
            declared.fault = Some(fault.clone());
        }
        Ok((named.samples == self.window).then_some(Event::Named(fault)))
    }

    /// Samples taken, those of them that only settle the models, and what every method found.
    pub(super) fn finish(mut self) -> (usize, usize, Vec<Found>) {
        self.close();
        let judged = self.samples.saturating_sub(self.run_up);
        let found = self.watching.into_iter().map(|Watching { mut found, .. }| {
            found.exceedance_rate = (judged > 0).then(|| found.outside as f64 / judged as f64);
            found
        });
        (self.samples, self.run_up, found.collect())
    }
}
