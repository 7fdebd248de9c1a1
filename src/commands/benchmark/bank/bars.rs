//! What the figures of the bank must reach.

use drivescope_diagnoser::bank::Verified;
use drivescope_scenarios::trials::{ARL_0, Delay, HealthyRow, Trials};

use super::super::bar::Bar;

/// Mean samples between false alarms that must be proven where delays are compared: the lower 95 %
/// limit of what was counted.
const PROVEN: f64 = 1e6;
/// Mean delays, in samples, by mechanism and size.
const DELAYS: [(&str, f64, f64); 4] =
    [("tacho", 0.05, 3.0), ("flux", 0.05, 3.0), ("actuator", 0.05, 3.0), ("load", 0.05, 25.0)];
/// Error of a size, percentage points.
const MOST_RMS: f64 = 0.05;
/// What 95 % intervals may cover.
const COVERED: (f64, f64) = (0.93, 0.97);

/// False alarms of all courses at each of the designed times between them.
pub(super) fn alarms(
    found: &Trials,
    of: fn(&HealthyRow) -> &[usize; ARL_0.len()],
) -> [Verified; ARL_0.len()] {
    let rows = &found.healthy.rows;
    let samples = rows.iter().map(|row| row.samples).sum();
    std::array::from_fn(|k| Verified { samples, alarms: rows.iter().map(|row| of(row)[k]).sum() })
}

/// The least designed time between false alarms at which enough of it was proven, else the longest.
pub(super) fn proven(found: &Trials) -> usize {
    let counted = alarms(found, |row| &row.alarms);
    let enough = |verified: &Verified| verified.arl_0_at_least() >= PROVEN;
    counted.iter().position(enough).unwrap_or(ARL_0.len() - 1)
}

pub(super) fn bars(found: &Trials) -> Vec<Bar> {
    let mut bars = Vec::new();
    let with = &found.classes.with_current;
    let twelve = "twelve faults in one window";
    bars.push(Bar::at_least(twelve, with.among_twelve.share, 0.999));
    if let Some((_, worst)) = with.worst(|row| row.among_twelve) {
        bars.push(Bar::at_least(format!("{twelve}, the worst of them"), worst.share, 0.995));
    }
    if let Some(all) = found.mechanisms.rows.first() {
        let what = "ten mechanisms, truth within the printed set";
        bars.push(Bar::at_least(what, all.in_set.share, 0.95));
    }
    for sizes in &found.mechanisms.sizes {
        if sizes.what == "all" {
            let what = "true sizes within their 95 % intervals";
            bars.push(Bar::at_least(format!("{what}, at least"), sizes.covered.share, COVERED.0));
            bars.push(Bar::at_most(format!("{what}, at most"), sizes.covered.share, COVERED.1));
        } else if let Some(rms) = sizes.rms_points {
            let what = format!("size of {}, rms error in percentage points", sizes.what);
            bars.push(Bar::at_most(what, rms, MOST_RMS));
        }
    }
    let at = proven(found);
    for (mechanism, size, most) in DELAYS {
        let row = found.delays.iter().find(|it| it.mechanism == mechanism && it.size == size);
        let Some(Delay { samples, known, .. }) = row.map(|row| &row.delays[at]) else { continue };
        let what = format!("delay of {mechanism} {:.0} %", 100.0 * size);
        bars.push(Bar::at_most(format!("{what}, samples"), samples.mean, most));
        let limit = 1.5 * known.mean + 1.0;
        bars.push(Bar::at_most(format!("{what}, against the known model"), samples.mean, limit));
    }
    // Other mechanisms are shown without a bar.
    for row in found.incipient.iter().filter(|row| ["tacho", "flux"].contains(&&*row.mechanism)) {
        let what = format!("{} that grows: share of machines in time", row.mechanism);
        bars.push(Bar::at_least(what, row.in_time.share, 0.95));
    }
    bars.push(Bar::at_least("\"unknown\" to kinds left out", found.unknown.unknown.share, 0.95));
    bars.push(Bar::at_most("a wrong name for them", found.unknown.named.share, 0.02));
    let counted = alarms(found, |row| &row.alarms)[at];
    let proven = counted.arl_0_at_least();
    bars.push(Bar::at_least("samples between false alarms there, 95 % limit", proven, PROVEN));
    bars
}
