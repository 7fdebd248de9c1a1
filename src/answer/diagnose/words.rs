//! Declarations and decisions in words.

use drivescope_monitor::{Decision, Declaration, Fault, UNKNOWN};

use crate::report::words::{number, percent};

/// What a declared fault is, and what it cannot be told from.
pub(super) fn what(declaration: &Declaration) -> String {
    let others = others(declaration);
    let others = match others.as_slice() {
        [] => String::new(),
        some => format!("; it cannot be told from {}", some.join(", ")),
    };
    alone(declaration) + &others
}

/// What else it may be.
pub(super) fn others(declaration: &Declaration) -> Vec<&str> {
    let all = declaration.set.iter().map(String::as_str);
    all.filter(|it| *it != declaration.mechanism).collect()
}

/// A declared fault: mechanism, size, and its 95 % interval.
pub(super) fn alone(declaration: &Declaration) -> String {
    if declaration.mechanism == UNKNOWN {
        return "no known cause".to_owned();
    }
    let mut text = declaration.mechanism.clone();
    if let (Some(size), Some([low, high])) = (declaration.size, declaration.interval) {
        let (per, unit) = match declaration.unit.as_deref() {
            Some("1") | None => (100.0, "%"),
            Some(unit) => (1.0, unit),
        };
        let signed = |x: f64| {
            let x = number(per * x);
            if x.starts_with('-') { x } else { format!("+{x}") }
        };
        text += &format!(" {} {unit} ({} to {})", signed(size), signed(low), signed(high));
        if let Some([rate, _]) = declaration.growth {
            text += &format!(", growing by {} {unit} a second", number(per * rate));
        }
    }
    text
}

/// A decision of the bank in a line.
pub(crate) fn decision(decision: &Decision) -> String {
    let Decision { time, decision, symptom, declaration } = decision;
    let symptom = symptom.as_deref().unwrap_or("excess");
    match *decision {
        "alarm" => format!("at {time:.3} s: alarm ({symptom}), since {:.3} s", declaration.from),
        "retracted" => format!("at {time:.3} s: healthy, the alarm is taken back"),
        "ended" => format!(
            "at {time:.3} s: {} ended at {:.3} s",
            declaration.mechanism,
            declaration.to.unwrap_or(*time)
        ),
        _ => format!("at {time:.3} s: since {:.3} s {}", declaration.from, what(declaration)),
    }
}

/// A fault that was shown in the training, in a line.
pub(crate) fn fault(fault: &Fault) -> String {
    format!(
        "{} ({} % of {} samples), size S = {} thresholds, {} among the known faults",
        fault.class,
        percent(fault.share, 0),
        fault.samples,
        number(fault.s),
        fault.group.label()
    )
}
