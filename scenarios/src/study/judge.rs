//! Detectors that follow a run, and what they found.

use std::ops::Range;

use drivescope_diagnoser::{
    Detection, Detector, DetectorError, DetectorRun, Diagnoser, ModelRun, Trace, Verdict,
    fault_size,
};
use drivescope_recording::Recording;

use super::signals::values;
use super::{SAMPLES, StudyError};
use crate::cosimulated::Follower;
use crate::faults::Fault;
use crate::results::{ByDetector, DetectionRow, DetectorKind, Pictures};

/// All detectors at work on one run.
pub struct Watch {
    /// One a detector of the registry, in its order, with its verdicts.
    each: Vec<(Detector<ModelRun, DetectorRun>, Trace)>,
}

impl Watch {
    /// The detectors of a diagnoser at the start of a run.
    ///
    /// # Errors
    /// A diagnoser that lacks one.
    pub fn new(diagnoser: &Diagnoser) -> Result<Self, DetectorError> {
        let run_up = diagnoser.run_up;
        let each = DetectorKind::ALL.into_iter().map(|kind| {
            let (verdicts, window) = (Vec::with_capacity(SAMPLES), diagnoser.window_of(kind));
            Ok((diagnoser.detector(kind)?, Trace { verdicts, run_up, window }))
        });
        Ok(Self { each: each.collect::<Result<_, _>>()? })
    }

    /// What was found over the run.
    pub fn judgement(self) -> Judgement {
        let mut traces = self.each.into_iter().map(|(_, trace)| trace);
        Judgement { traces: ByDetector::from_fn(|_| traces.next().expect("one a detector")) }
    }
}

impl Follower for Watch {
    fn sample(&mut self, c_m: f64, t: f64) -> Result<(), DetectorError> {
        for (detector, trace) in &mut self.each {
            trace.verdicts.push(detector.step(&[c_m], t)?);
        }
        Ok(())
    }
}

/// The verdicts over one run.
#[derive(Debug, Clone)]
pub struct Judgement {
    traces: ByDetector<Trace>,
}

impl Judgement {
    /// The verdicts of one method.
    pub fn trace(&self, method: DetectorKind) -> &Trace {
        self.traces.get(method)
    }

    /// The same run at another significance level, its quantile `factor` times the own one; what
    /// knows no such level stays.
    pub(super) fn at_level(&self, factor: f64) -> Self {
        let scaled = |kind: DetectorKind| match kind.info().instead_of_level {
            Some(_) => self.trace(kind).clone(),
            None => self.trace(kind).with_bands_scaled(factor),
        };
        Self { traces: ByDetector::from_fn(scaled) }
    }

    /// Share of samples outside the threshold after the run-up.
    pub fn false_rate(&self, method: DetectorKind) -> f64 {
        false_rate_of(self.trace(method))
    }

    /// Faults declared over the run: a declaration that stands counts once.
    pub fn alarms(&self, method: DetectorKind) -> usize {
        self.trace(method).declarations().len()
    }

    /// The row of the detection table.
    pub fn row(&self, method: DetectorKind, fault: &Fault) -> DetectionRow {
        row_of(self.trace(method), method, fault)
    }

    /// The size of the symptom (27) in constant thresholds.
    pub(super) fn symptom(&self, fault: &Fault) -> Result<f64, StudyError> {
        Ok(fault_size(self.trace(DetectorKind::Constant), fault.from..fault.until)?)
    }

    /// The traces for the report.
    pub(super) fn picture(&self, fault: Option<&Fault>, signals: &Recording) -> Pictures {
        let verdicts = &self.trace(DetectorKind::Mem).verdicts;
        let of = |get: fn(&Verdict) -> f64| verdicts.iter().map(get).collect();
        Pictures {
            fault: fault.map(|fault| fault.name.clone()),
            c_m: values(signals, "C_m").to_vec(),
            t: values(signals, "T").to_vec(),
            residual: of(|v| v.residual),
            lower: of(|v| v.lower),
            upper: of(|v| v.upper),
            declared: fault.and_then(|fault| self.row(DetectorKind::Mem, fault).t_dt),
        }
    }
}

/// The row of the detection table that a run of verdicts gives.
pub fn row_of(trace: &Trace, method: DetectorKind, fault: &Fault) -> DetectionRow {
    let Detection { t_dt, false_alarms } = trace.detection(fault.from);
    DetectionRow {
        fault: fault.name.clone(),
        method,
        r_td: rate(trace, fault.from..fault.until),
        t_dt,
        delay: t_dt.map(|t_dt| t_dt - fault.from),
        false_alarms,
    }
}

/// Share of samples of a run outside the threshold after the run-up.
pub fn false_rate_of(trace: &Trace) -> f64 {
    rate(trace, trace.run_up..trace.verdicts.len())
}

/// Share of exceeding samples; the spans of the study lie after the run-up and within the run.
fn rate(trace: &Trace, span: Range<usize>) -> f64 {
    let outside = trace.verdicts[span.clone()].iter().filter(|verdict| verdict.exceeds).count();
    outside as f64 / span.len() as f64
}
