//! Delays at equal mean times between false alarms, for a person; and what they must reach.

use std::fmt::Write;

use drivescope_scenarios::parity::Spread;
use drivescope_scenarios::trials::{Curves, DetectorRow, FaultDelays};

use super::super::bar::{Bar, share};
use crate::report::words::number;

/// Mean samples between false alarms at which delays are held against their bars, of those designed.
const AT: usize = 3;
/// Mean delays of the bank, samples.
const MOST: [(&str, f64); 4] = [("tacho", 3.0), ("flux", 3.0), ("actuator", 3.0), ("load", 25.0)];
/// Size of these faults.
const SIZE: f64 = 0.05;

/// The bars of the bank, at the limits designed for a million samples.
pub(super) fn bars(curves: &Curves) -> Vec<Bar> {
    let Some(bank) = curves.detectors.first() else { return Vec::new() };
    let mut bars = Vec::new();
    for (mechanism, most) in MOST {
        let row = bank.faults.iter().find(|it| it.mechanism == mechanism && it.size == SIZE);
        let Some(delay) = row.map(|row| row.delay[AT].mean) else { continue };
        bars.push(Bar::at_most(format!("delay of {mechanism} 5 %, samples"), delay, most));
    }
    let proven = bank.arl_0_at_least[AT];
    bars.push(Bar::at_least(
        "samples between false alarms there, 95 % limit",
        proven,
        curves.arl_0[AT],
    ));
    bars
}

/// `12.3±0.4 (87 %)`: mean delay with the half of its 95 % interval, and the share that was detected
/// where it is not all.
fn delay(row: &FaultDelays, k: usize) -> String {
    let (found, mean) = (&row.detected[k], mean(&row.delay[k]));
    match found.hits {
        0 => "never".to_owned(),
        hits if hits == found.of => mean,
        _ => format!("{mean} ({:.0} %)", 100.0 * found.share),
    }
}

/// A mean with the half of its 95 % interval, where there are several values.
fn mean(of: &Spread) -> String {
    let half = of.interval[1] - of.mean;
    if half.is_nan() { format!("{:.1}", of.mean) } else { format!("{:.1}\u{b1}{half:.1}", of.mean) }
}

fn detector(text: &mut String, row: &DetectorRow) {
    let limits = row.limits.map_or_else(String::new, |limits| {
        let limits = limits.map(|limit| format!("{limit:.2}"));
        format!("; limits {} half widths", limits.join(", "))
    });
    let proven = row.arl_0_at_least.map(|samples| format!("{samples:.1e}"));
    let _ = writeln!(
        text,
        "{}: {} false alarms in {} healthy samples (95 %: at least {} between them){limits}",
        row.detector,
        row.alarms.map(|n| n.to_string()).join(", "),
        row.samples,
        proven.join(", ")
    );
    for fault in &row.faults {
        let _ = write!(text, "  {:<11} {:>4} %", fault.mechanism, number(100.0 * fault.size));
        for k in 0..row.alarms.len() {
            let _ = write!(text, " {:>15}", delay(fault, k));
        }
        text.push('\n');
    }
}

/// The table.
pub(super) fn text(curves: &Curves) -> String {
    let mut text = format!(
        "\nmean delays, samples, with the half of their 95 % intervals, on {} machines drawn anew, each with a baseline; detected within {} (share \
         where not all are); limits designed for these mean samples between false alarms: {}\n",
        curves.machines,
        curves.watched,
        curves.arl_0.map(|arl_0| format!("{arl_0:e}")).join(", ")
    );
    curves.detectors.iter().for_each(|row| detector(&mut text, row));
    text += "known machine and mechanism (limit for any):\n";
    for row in &curves.known {
        let _ = write!(text, "  {:<11} {:>4} %", row.mechanism, number(100.0 * row.size));
        for delay in &row.delays {
            let _ = write!(text, " {:>15}", mean(&delay.known));
        }
        text.push('\n');
    }
    let _ = writeln!(text, "always alarming: detected {}", share(&curves.always.detected[AT]));
    text
}
