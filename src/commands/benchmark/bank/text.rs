//! The tables for a person.

use std::fmt::Write;
use std::slice::from_ref;

use drivescope_scenarios::trials::{ARL_0, ClassTable, Course, Trials};

use super::super::bar::{Bar, share};
use super::bars::{alarms, proven};
use crate::report::words::{fault, number, percent};

pub(super) fn text(all: &[Trials], bars: &[Bar]) -> String {
    let mut text: String = all.iter().map(of_design).collect();
    text.push_str(if all.len() > 1 { "\nover all designs:\n" } else { "\n" });
    text.extend(bars.iter().map(Bar::line));
    text
}

fn of_design(found: &Trials) -> String {
    let mut text = format!(
        "designed with seed {} for {:e} samples between false alarms, judged with seed {}; a baseline \
         has {} samples, a judgement {}; intervals: 95 %, Wilson\n",
        found.design_seed, found.arl_0, found.judged_seed, found.baseline, found.horizon
    );
    classes(&mut text, "C_m, T, I_m", &found.classes.with_current);
    classes(&mut text, "C_m, T", &found.classes.without_current);
    mechanisms(&mut text, found);
    delays(&mut text, found);
    unknown(&mut text, found);
    healthy(&mut text, found);
    text
}

fn classes(text: &mut String, signals: &str, table: &ClassTable) {
    let _ = writeln!(
        text,
        "\nthe twelve faults in one window, with {signals}: among the twelve {}, of all mechanisms {}",
        share(&table.among_twelve),
        share(&table.named)
    );
    for row in &table.rows {
        let _ = writeln!(
            text,
            "  {:<14} {:<26} {}",
            fault(&row.fault),
            share(&row.among_twelve),
            share(&row.named)
        );
    }
    let _ = writeln!(text, "  held against the next fault: {}", share(&table.shuffled));
}

fn mechanisms(text: &mut String, found: &Trials) {
    let _ = writeln!(
        text,
        "\nten mechanisms of random size\n  {:<28} {:<26} {:<26} {:<26} {:<26} {:<5} from",
        "", "declared", "truth in the set", "of all, undeclared too", "named first", "set"
    );
    for row in &found.mechanisms.rows {
        let _ = writeln!(
            text,
            "  {:<28} {:<26} {:<26} {:<26} {:<26} {:<5.1} {}",
            row.what.replace('_', " "),
            share(&row.detected),
            share(&row.in_set),
            share(&row.in_set_of_all),
            share(&row.named),
            row.set_size,
            row.declared_from.map_or("none".to_owned(), |size| format!("{} %", percent(size, 1)))
        );
    }
    text.push_str("  from: the size from which on nine in ten are declared\n");
    let shuffled = share(&found.mechanisms.shuffled);
    let _ = writeln!(text, "  another mechanism in the set: {shuffled}");
    for sizes in &found.mechanisms.sizes {
        let rms = sizes.rms_points.map_or("none".to_owned(), number);
        let covered = share(&sizes.covered);
        let _ = writeln!(
            text,
            "  size, {}: rms error {rms} points; intervals cover {covered}",
            sizes.what
        );
    }
}

fn delays(text: &mut String, found: &Trials) {
    let _ = write!(
        text,
        "\nmean delay in samples, beside that of a detector that knows machine and mechanism; \
         designed samples between false alarms:\n  {:<18}",
        ""
    );
    for arl_0 in ARL_0 {
        let _ = write!(text, " {:>14}", format!("{arl_0:e}"));
    }
    text.push('\n');
    for row in &found.delays {
        let _ = write!(text, "  {:<11} {:>4} %", row.mechanism, number(100.0 * row.size));
        for delay in &row.delays {
            let both = format!("{:.1} / {:.1}", delay.samples.mean, delay.known.mean);
            let _ = write!(text, " {both:>14}");
        }
        text.push('\n');
    }
    for row in &found.incipient {
        let _ = writeln!(
            text,
            "  {} that grows: detected at {} % on average (95 %: {} %) at {:e}; by {} % {}; \
             in the first printed set {}; a detector that always alarms {}",
            row.mechanism,
            percent(row.size.mean, 2),
            percent(row.size.range[1], 2),
            row.arl_0,
            number(100.0 * row.by),
            share(&row.in_time),
            share(&row.in_set),
            share(&row.always)
        );
    }
}

fn unknown(text: &mut String, found: &Trials) {
    let unknown = &found.unknown;
    let _ = writeln!(
        text,
        "\nkinds that the bank does not hold: \"unknown\" {}, a name {}",
        share(&unknown.unknown),
        share(&unknown.named)
    );
    for row in &unknown.rows {
        let names: Vec<String> =
            row.names.iter().map(|(name, count)| format!("{name} {count}")).collect();
        let _ = writeln!(
            text,
            "  {:<34} {:<26} {:<26} {}",
            row.what.replace('_', " "),
            share(&row.unknown),
            share(&row.named),
            names.join(", ")
        );
    }
}

fn healthy(text: &mut String, found: &Trials) {
    let healthy = &found.healthy;
    let _ = writeln!(
        text,
        "\nfalse alarms, limits designed for {}; baselines refused: {} of {}",
        ARL_0.map(|arl_0| format!("{arl_0:e}")).join(", "),
        healthy.refused,
        healthy.machines
    );
    for row in &healthy.rows {
        let course = match row.course {
            Course::SetPoint => "other set points",
            Course::Steps => "steps",
            Course::Reversals => "reversals",
            Course::SteppedReversals => "steps through rest",
        };
        let counts = |of: &[usize]| of.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        let _ = writeln!(
            text,
            "  {course:<20} {:>9} samples: {}; without I_m {}",
            row.samples,
            counts(&row.alarms),
            counts(&row.alarms_without_current)
        );
    }
    let at = proven(from_ref(found));
    let counted = alarms(from_ref(found), |row| &row.alarms)[at];
    let _ = writeln!(
        text,
        "  limits for {:e}: at least {:.2e} samples between false alarms (95 %): delays are held \
         against their bars there",
        ARL_0[at],
        counted.arl_0_at_least()
    );
}
