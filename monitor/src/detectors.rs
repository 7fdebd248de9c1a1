//! The detectors of a diagnoser over rows of one signal set, in fixed memory.

use std::sync::Arc;

use drivescope_diagnoser::{
    Band, Confidence, Data, DetectorError, DetectorKind, Diagnoser, KnownFaults, LagRun, Memory,
    MemoryError, Naming, OperatingRange, RangeWatch, Walk,
};

use crate::declaration::Declaration;
use crate::error::MonitorError;
use crate::found::{Fault, Found};
use crate::happened::Happened;
use crate::method::Method;
use crate::of_residual::{OfResidual, starts_up};
use crate::of_windows::OfWindows;
use crate::state::{Shown, State};

/// The methods at work, and the naming of what the one that was asked for declares.
#[derive(Debug, Clone)]
pub(crate) struct Detectors {
    each: Vec<OfResidual>,
    windows: Option<OfWindows>,
    range: Option<RangeWatch>,
    asked: Method,
    known: Option<Arc<KnownFaults>>,
    /// T of (27).
    threshold: Band,
    /// Symptoms of the fault that stands declared.
    naming: Option<Naming>,
    window: usize,
    period_s: f64,
    /// Samples that settle the models of a segment.
    settling: usize,
    /// Samples that settle the models, of all segments.
    run_up: usize,
    samples: usize,
    /// Samples beyond the operating range, run-up excluded.
    beyond: usize,
    /// Whether the last sample was.
    is_beyond: bool,
    /// Samples of the segment at hand.
    of_segment: usize,
}

/// What the detectors found.
pub(crate) struct DetectorsFound {
    pub(crate) samples: usize,
    pub(crate) run_up: usize,
    pub(crate) beyond: usize,
    pub(crate) methods: Vec<Found>,
}

impl Detectors {
    /// The methods of a diagnoser; `baseline` is a healthy run of the machine or day, and its name.
    pub(crate) fn new(
        diagnoser: &Diagnoser,
        asked: Method,
        beta: Option<f64>,
        baseline: Option<(&str, &Data)>,
    ) -> Result<Self, MonitorError> {
        let confidence = beta.map(Confidence::new).transpose()?.unwrap_or(diagnoser.confidence);
        let held = DetectorKind::ALL.into_iter().filter(|kind| diagnoser.holds(*kind));
        let healthy = baseline.map(|(_, data)| data);
        let each = held.map(|kind| OfResidual::new(diagnoser, kind, (asked, confidence), healthy));
        let each = each.collect::<Result<_, DetectorError>>()?;
        let windows = diagnoser.windows.as_ref().zip(baseline).map(|(windows, (name, data))| {
            match windows.baseline_of(data) {
                Ok(of) => {
                    let model = LagRun::new(windows.model.clone());
                    Ok(Some(OfWindows::new(windows.watch(of), model)))
                }
                // What others are asked for may begin from rest.
                Err(_) if asked != Method::Windows => Ok(None),
                Err(source) => Err(MonitorError::Windows { baseline: name.to_owned(), source }),
            }
        });
        let windows = windows.transpose()?.flatten();
        // A bank is not looked for here.
        let is_there = match asked {
            Method::Bank => true,
            Method::Windows => windows.is_some(),
            Method::Residual(kind) => diagnoser.holds(kind),
        };
        if !is_there {
            return Err(MonitorError::Missing { method: asked });
        }
        let window = diagnoser.window;
        let of_baseline = baseline.and_then(|(_, data)| {
            let begun = if starts_up(data.len(), diagnoser.run_up) { diagnoser.run_up } else { 0 };
            OperatingRange::of(&[&data.settled(begun)], window)
        });
        let range = diagnoser.range.as_ref().map(|range| match &of_baseline {
            Some(other) => range.and(other),
            None => range.clone(),
        });
        Ok(Self {
            each,
            windows,
            range: range.map(OperatingRange::watch),
            asked,
            known: diagnoser.faults.clone(),
            threshold: diagnoser.constant.band(diagnoser.confidence),
            naming: None,
            window,
            period_s: diagnoser.interface.period_s,
            settling: diagnoser.run_up,
            run_up: 0,
            samples: 0,
            beyond: 0,
            is_beyond: false,
            of_segment: 0,
        })
    }

    /// A new segment begins: the models settle anew, what was found stays.
    pub(crate) fn begin(&mut self) {
        self.close();
        self.each.iter_mut().for_each(OfResidual::begin);
        self.windows.iter_mut().for_each(OfWindows::begin);
        self.range.iter_mut().for_each(RangeWatch::reset);
        self.naming = None;
    }

    fn close(&mut self) {
        self.run_up += self.settling.min(self.of_segment);
        self.of_segment = 0;
    }

    /// Takes a sample.
    pub(crate) fn step(
        &mut self,
        u: &[f64],
        y: f64,
        time: f64,
    ) -> Result<Vec<Happened>, MonitorError> {
        let mut happened = Vec::new();
        let (mut residual, mut stands) = (f64::NAN, false);
        let settled = self.of_segment >= self.settling;
        let beyond = self.range.as_mut().is_some_and(|range| range.step(u, y));
        self.is_beyond = beyond;
        self.beyond += usize::from(beyond && settled);
        for one in self.each.iter_mut().filter(|one| !one.refused) {
            let (declared, verdict) = one.step((u, y, time), (self.of_segment, beyond))?;
            let of_asked = one.found.method == self.asked;
            if declared && !one.standing {
                let from = time - (one.window as f64 - 1.0) * self.period_s;
                let sample = self.samples + 1;
                one.found.declare(Declaration { sample, ..Declaration::unknown(from, time) });
                happened.push(Happened::Declared(one.found.method));
                if of_asked {
                    self.naming =
                        self.known.clone().map(|known| Naming::new(known, self.threshold));
                }
            }
            if declared {
                one.standing = true;
            } else {
                one.found.end(one.last_outside, &mut one.standing);
            }
            // Symptoms are residuals of the process model; a GMDH network has others.
            if one.found.method == Method::Residual(DetectorKind::Constant) {
                residual = verdict.residual;
            }
            stands |= declared && verdict.exceeds && of_asked;
        }
        if let Some(windows) = &mut self.windows {
            let declared = windows.step((u, y, time), (self.samples + 1, beyond));
            happened.extend(declared.then_some(Happened::Declared(Method::Windows)));
        }
        self.samples += 1;
        self.of_segment += 1;
        if stands {
            happened.extend(self.name(u, residual)?);
        }
        Ok(happened)
    }

    /// Takes a symptom of the fault that stands declared.
    fn name(&mut self, u: &[f64], residual: f64) -> Result<Option<Happened>, MonitorError> {
        let (Some(naming), Some(known)) = (&mut self.naming, &self.known) else { return Ok(None) };
        naming.step(u, residual)?;
        let Some(named) = naming.named() else { return Ok(None) };
        let fault = Fault::new(known, &named);
        let of_asked = self.each.iter_mut().find(|one| one.found.method == self.asked);
        if let Some(found) = of_asked.map(|one| &mut one.found) {
            if let Some(declared) = found.declared.last_mut() {
                declared.fault = Some(fault.clone());
            }
            if let Some(declaration) = found.declarations.last_mut() {
                declaration.set = fault.names();
                declaration.mechanism.clone_from(&fault.class);
            }
        }
        Ok((named.samples == self.window).then_some(Happened::Named(fault)))
    }

    /// Residual and band of a method; none if the diagnoser does not hold it.
    pub(crate) fn shown(&self, method: Method) -> Option<Shown> {
        match method {
            Method::Windows => self.windows.as_ref().map(OfWindows::shown),
            _ => self.each.iter().find(|one| one.found.method == method).map(|one| one.shown),
        }
    }

    /// Where a method stands, and what it found.
    pub(crate) fn standing(&self, method: Method) -> Option<(State, &Found)> {
        let (found, standing, judges) = match method {
            Method::Windows => {
                let windows = self.windows.as_ref()?;
                (&windows.found, windows.standing, windows.judges())
            }
            _ => {
                let one = self.each.iter().find(|one| one.found.method == method)?;
                (&one.found, one.standing, self.of_segment > self.settling)
            }
        };
        let state = match (standing, judges) {
            (true, _) => State::Fault,
            (false, _) if self.is_beyond => State::NotJudged,
            (false, true) => State::Healthy,
            (false, false) => State::NotYet,
        };
        Some((state, found))
    }

    /// What every method found.
    pub(crate) fn finish(mut self) -> DetectorsFound {
        self.close();
        let (samples, run_up, beyond) = (self.samples, self.run_up, self.beyond);
        // Most of the run was never shown.
        let unknown = 2 * beyond > samples.saturating_sub(run_up);
        let of_residual = self.each.into_iter().map(|one| (one.found, one.counted));
        let windows = self.windows.into_iter().map(|windows| (windows.found, windows.counted));
        let methods = windows.chain(of_residual).map(|(mut found, counted)| {
            found.judged = counted.judged;
            found.outside = counted.outside;
            found.exceedance_rate = counted.share();
            found.verdict = if !found.declarations.is_empty() {
                "fault"
            } else if unknown || counted.judged == 0 {
                "not_judged"
            } else if found.beta.is_some_and(|beta| counted.is_abnormal(beta)) {
                "abnormal"
            } else {
                "healthy"
            };
            found
        });
        DetectorsFound { samples, run_up, beyond, methods: methods.collect() }
    }
}

impl Memory for Detectors {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(&mut self.each)?;
        walk.each(&mut self.windows)?;
        walk.each(&mut self.range)?;
        let mut naming = self.naming.is_some();
        naming.walk(walk)?;
        if walk.restores() {
            let known = naming.then(|| self.known.clone()).flatten();
            self.naming = known.map(|known| Naming::new(known, self.threshold));
        }
        walk.each(&mut self.naming)?;
        walk.each([&mut self.run_up, &mut self.samples, &mut self.beyond, &mut self.of_segment])?;
        self.is_beyond.walk(walk)
    }
}
