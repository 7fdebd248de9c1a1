//! Detectors that follow a run, and what they found.

use std::ops::Range;

use drivescope_diagnoser::{DetectorError, Trace, Verdict};
use drivescope_recording::Recording;

use super::design::{ConstantDetector, MemDetector, WINDOW, values};
use super::{RUN_UP, SAMPLES, paper};
use crate::cosimulated::Follower;
use crate::faults::Fault;
use crate::results::{ByMethod, DetectionRow, IdentificationRow, Method, Pictures};

/// Both detectors at work on one run.
pub(super) struct Watch {
    mem: MemDetector,
    constant: ConstantDetector,
    verdicts: ByMethod<Vec<Verdict>>,
}

impl Watch {
    pub(super) fn new(mem: MemDetector, constant: ConstantDetector) -> Self {
        let room = || Vec::with_capacity(SAMPLES);
        Self { mem, constant, verdicts: ByMethod { mem: room(), constant: room() } }
    }

    /// What was found over the run.
    pub(super) fn judgement(self) -> Judgement {
        let trace = |verdicts| Trace { verdicts, run_up: RUN_UP, window: WINDOW };
        let ByMethod { mem, constant } = self.verdicts;
        Judgement { traces: ByMethod { mem: trace(mem), constant: trace(constant) } }
    }
}

impl Follower for Watch {
    fn sample(&mut self, c_m: f64, t: f64) -> Result<(), DetectorError> {
        self.verdicts.mem.push(self.mem.step(&[c_m], t)?);
        self.verdicts.constant.push(self.constant.step(&[c_m], t)?);
        Ok(())
    }
}

/// The verdicts over one run.
#[derive(Debug)]
pub(super) struct Judgement {
    traces: ByMethod<Trace>,
}

impl Judgement {
    fn trace(&self, method: Method) -> &Trace {
        match method {
            Method::Mem => &self.traces.mem,
            Method::Constant => &self.traces.constant,
        }
    }

    /// Share of samples outside the threshold after the run-up.
    pub(super) fn false_rate(&self, method: Method) -> f64 {
        rate(self.trace(method), RUN_UP..SAMPLES)
    }

    /// Faults declared within a span: a declaration that stands counts once.
    pub(super) fn alarms(&self, method: Method, span: Range<usize>) -> usize {
        self.trace(method).declarations().iter().filter(|at| span.contains(at)).count()
    }

    /// The row of the detection table.
    pub(super) fn row(&self, method: Method, fault: &Fault) -> DetectionRow {
        let trace = self.trace(method);
        let declared = trace.declarations().into_iter().find(|at| *at >= fault.from);
        DetectionRow {
            fault: fault.name.clone(),
            method,
            r_td: rate(trace, fault.from..fault.until),
            t_dt: declared,
            delay: declared.map(|at| at - fault.from),
            false_alarms: self.alarms(method, 0..fault.from),
        }
    }

    /// The size of the symptom (27) over the constant threshold.
    pub(super) fn symptom(&self, fault: &Fault, threshold: f64) -> IdentificationRow {
        let span = &self.traces.mem.verdicts[fault.from..fault.until];
        let mean = span.iter().map(|v| v.residual.abs()).sum::<f64>() / span.len() as f64;
        IdentificationRow {
            fault: fault.name.clone(),
            s: mean / threshold,
            s_paper: paper::symptom(&fault.name.label),
        }
    }

    /// The traces for the report.
    pub(super) fn picture(&self, fault: Option<&Fault>, signals: &Recording) -> Pictures {
        let verdicts = &self.traces.mem.verdicts;
        let of = |get: fn(&Verdict) -> f64| verdicts.iter().map(get).collect();
        Pictures {
            fault: fault.map(|fault| fault.name.clone()),
            c_m: values(signals, "C_m").to_vec(),
            t: values(signals, "T").to_vec(),
            residual: of(|v| v.residual),
            lower: of(|v| v.lower),
            upper: of(|v| v.upper),
            declared: fault.and_then(|fault| self.row(Method::Mem, fault).t_dt),
        }
    }
}

/// Share of exceeding samples; the spans of the study lie after the run-up and within the run.
fn rate(trace: &Trace, span: Range<usize>) -> f64 {
    let outside = trace.verdicts[span.clone()].iter().filter(|verdict| verdict.exceeds).count();
    outside as f64 / span.len() as f64
}
