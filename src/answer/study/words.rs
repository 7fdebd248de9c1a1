//! What the sections of a study share: rows, sentences.

use drivescope_scenarios::results::{
    DetectionRow, DetectorKind, FaultName, PaperRow, Pictures, StudyResults,
};

use crate::answer::block::{Cell, Tone};
use crate::report::page::{label, minus};
use crate::report::words::{count, fault, given, number};

/// The unit of speed and of torque for T in this unit: only axes measure in m/s.
pub(super) fn si_units(tacho_unit: &str) -> (&'static str, &'static str) {
    if tacho_unit == "m/s" { ("m/s", "N") } else { ("rad/s", "N m") }
}

/// What was run.
pub(super) fn name(picture: &Pictures) -> String {
    picture.fault.as_ref().map_or_else(|| "healthy".into(), fault)
}

/// Whether a sample lies outside the bands; where there is no band, it does not.
pub(super) fn outside(picture: &Pictures, k: usize) -> bool {
    let at = |signal: &[f64]| signal.get(k).copied().unwrap_or(f64::NAN);
    let r = at(&picture.residual);
    r < at(&picture.lower) || r > at(&picture.upper)
}

/// A fault with its label, before its marks in a picture.
pub(super) fn labelled(name: &FaultName) -> String {
    format!("{}  {}", minus(&fault(name)), label(&name.label))
}

/// False alarms.
pub(super) fn false_alarms(count: usize) -> Cell {
    Cell::from(count.to_string()).toned(Tone::Alert, count > 0)
}

/// The rows of one method.
pub(super) fn rows_of(rows: &[DetectionRow], method: DetectorKind) -> Vec<&DetectionRow> {
    rows.iter().filter(|row| row.method == method).collect()
}

/// The row of a fault under a method.
pub(super) fn row_of<'a>(
    study: &'a StudyResults,
    name: &FaultName,
    method: DetectorKind,
) -> Option<&'a DetectionRow> {
    study.detection.iter().find(|row| row.method == method && row.fault == *name)
}

/// The paper's row for this fault and method.
pub(super) fn paper_row<'a>(
    study: &'a StudyResults,
    label: &str,
    method: DetectorKind,
) -> Option<&'a PaperRow> {
    study.paper.detection.iter().find(|row| row.label == label && row.method == method)
}

/// Samples from the fault's begin to the paper's declaration; negative where that was a false
/// alarm.
pub(super) fn paper_delay(study: &StudyResults, row: &PaperRow) -> i64 {
    row.t_dt as i64 - study.fault_span.from as i64
}

/// What a method found, in one line: `12 of 12 faults detected by model error modelling, 0 false
/// alarms in 5000 healthy samples`.
pub(super) fn verdict(study: &StudyResults, method: DetectorKind) -> String {
    let rows = rows_of(&study.detection, method);
    let found = rows.iter().filter(|row| row.detected()).count();
    let alarms = study.healthy.alarms.of(method);
    let early: usize = rows.iter().map(|row| row.false_alarms).sum();
    let mut line = format!(
        "{found} of {} faults detected by {}, {} in {} healthy samples",
        rows.len(),
        method.label(),
        count(alarms, "false alarm"),
        study.healthy.samples
    );
    if early > 0 {
        line += &format!(", {} before a fault began", count(early, "declaration"));
    }
    line
}

/// Level below which the tests of the residual reject.
pub(super) const TEST_LEVEL: f64 = 0.01;

/// What the whiteness test says of r - y_e.
pub(super) fn whiteness(p: f64) -> &'static str {
    if p.is_nan() {
        "not tested"
    } else if p < TEST_LEVEL {
        "not white: neighbouring samples resemble each other, while the bands assume independent \
         errors. The share outside the bands still holds on average, but exceedances come in \
         clusters, so runs of them are more frequent than independence would make them"
    } else {
        "no correlation found: in keeping with the independent errors that the bands assume"
    }
}

/// What the normality test says of r - y_e.
pub(super) fn normality(p: f64) -> &'static str {
    if p.is_nan() {
        "not tested"
    } else if p < TEST_LEVEL {
        "not normal: the factor of the bands is that of a normal distribution, so the share \
         outside them may differ from the one designed; compare the measured rate"
    } else {
        "no departure found: in keeping with the normal distribution that the bands assume"
    }
}

/// What lies behind the half-widths of both kinds of threshold.
pub(super) fn lead(study: &StudyResults) -> String {
    let (with, without) = (study.model.v, study.model.residual_sd);
    let unit = &study.drive.tacho_unit;
    let narrower = 100.0 * (1.0 - with / without);
    let change = if !narrower.is_finite() {
        "not comparable with".into()
    } else if narrower >= 0.0 {
        format!("{narrower:.0} % narrower than")
    } else {
        format!("{:.0} % wider than", -narrower)
    };
    format!(
        "Here the error model takes the residual's standard deviation from {} to {} {unit}: its \
         bands are {change} constant thresholds.",
        number(without),
        number(with)
    )
}

/// A significance level, %.
pub(super) fn level(beta: f64) -> String {
    given(100.0 * beta)
}

/// How a sample is told on an axis.
pub(super) fn sampling(study: &StudyResults) -> String {
    format!("{} ms each", given(1e3 * study.drive.period_s))
}
