//! What the figures of the bank must reach.

use drivescope_diagnoser::bank::Verified;
use drivescope_scenarios::parity::Share;
use drivescope_scenarios::trials::{ARL_0, HealthyRow, Sizes, Trials};

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

/// False alarms of all courses under all designs at each of the designed times between them.
pub(super) fn alarms(
    found: &[Trials],
    of: fn(&HealthyRow) -> &[usize; ARL_0.len()],
) -> [Verified; ARL_0.len()] {
    let rows = || found.iter().flat_map(|it| &it.healthy.rows);
    let samples = rows().map(|row| row.samples).sum();
    std::array::from_fn(|k| Verified { samples, alarms: rows().map(|row| of(row)[k]).sum() })
}

/// The least designed time between false alarms at which enough of it was proven, else the longest.
pub(super) fn proven(found: &[Trials]) -> usize {
    let counted = alarms(found, |row| &row.alarms);
    let enough = |verified: &Verified| verified.arl_0_at_least() >= PROVEN;
    counted.iter().position(enough).unwrap_or(ARL_0.len() - 1)
}

/// The same share over all designs.
fn pooled<'a>(shares: impl Iterator<Item = &'a Share>) -> Option<f64> {
    let all = Share::pooled(shares);
    (all.of > 0).then_some(all.share)
}

/// The same root mean square over all designs, each from its value and the number it rests on.
fn pooled_rms(each: impl Iterator<Item = (f64, usize)>) -> Option<f64> {
    let (sum, count) = each.fold((0.0, 0), |(sum, count), (rms, of)| {
        (rms.powi(2).mul_add(of as f64, sum), count + of)
    });
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// A delay in the mean over all designs, beside the known model's.
fn delays(found: &[Trials], mechanism: &str, size: f64, at: usize) -> Option<(f64, f64)> {
    let row = |it: &Trials| -> Option<(f64, f64)> {
        let row = it.delays.iter().find(|it| it.mechanism == mechanism && it.size == size)?;
        Some((row.delays[at].samples.mean, row.delays[at].known.mean))
    };
    let all: Option<Vec<(f64, f64)>> = found.iter().map(row).collect();
    let all = all.filter(|it| !it.is_empty())?;
    let mean = |of: fn(&(f64, f64)) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    Some((mean(|it| it.0), mean(|it| it.1)))
}

/// Bars over all designs together: a figure of one design rests on what its two machines told of the
/// noise.
pub(super) fn bars(found: &[Trials]) -> Vec<Bar> {
    let mut bars = Vec::new();
    let Some(first) = found.first() else { return bars };
    let mut at_least = |what: String, share: Option<f64>, bar: f64| {
        bars.extend(share.map(|share| Bar::at_least(what, share, bar)));
    };
    let twelve = "twelve faults in one window";
    at_least(
        twelve.to_owned(),
        pooled(found.iter().map(|it| &it.classes.with_current.among_twelve)),
        0.999,
    );
    let class = |k: usize| {
        let rows = found.iter().filter_map(move |it| it.classes.with_current.rows.get(k));
        pooled(rows.map(|row| &row.among_twelve))
    };
    let each = (0..first.classes.with_current.rows.len()).filter_map(class);
    at_least(format!("{twelve}, the worst of them"), each.reduce(f64::min), 0.995);
    let all = found.iter().filter_map(|it| it.mechanisms.rows.first());
    let in_set = pooled(all.map(|row| &row.in_set));
    at_least("ten mechanisms, truth within the printed set".to_owned(), in_set, 0.95);
    for Sizes { what, .. } in &first.mechanisms.sizes {
        let rows = found.iter().flat_map(|it| &it.mechanisms.sizes).filter(|it| it.what == *what);
        if what == "all" {
            let Some(covered) = pooled(rows.map(|it| &it.covered)) else { continue };
            let what = "true sizes within their 95 % intervals";
            bars.push(Bar::at_least(format!("{what}, at least"), covered, COVERED.0));
            bars.push(Bar::at_most(format!("{what}, at most"), covered, COVERED.1));
        } else {
            let each = rows.filter_map(|it| Some((it.rms_points?, it.covered.of)));
            let what = format!("size of {what}, rms error in percentage points");
            bars.extend(pooled_rms(each).map(|rms| Bar::at_most(what, rms, MOST_RMS)));
        }
    }
    let at = proven(found);
    for (mechanism, size, most) in DELAYS {
        let Some((samples, known)) = delays(found, mechanism, size, at) else { continue };
        let what = format!("delay of {mechanism} {:.0} %", 100.0 * size);
        bars.push(Bar::at_most(format!("{what}, samples"), samples, most));
        let limit = 1.5 * known + 1.0;
        bars.push(Bar::at_most(format!("{what}, against the known model"), samples, limit));
    }
    // Other mechanisms are shown without a bar.
    for mechanism in ["tacho", "flux"] {
        let rows = found.iter().flat_map(|it| &it.incipient).filter(|it| it.mechanism == mechanism);
        let in_time = pooled(rows.map(|row| &row.in_time));
        let what = format!("{mechanism} that grows: share of machines in time");
        bars.extend(in_time.map(|share| Bar::at_least(what, share, 0.95)));
    }
    let unknown = pooled(found.iter().map(|it| &it.unknown.unknown));
    bars.extend(unknown.map(|it| Bar::at_least("\"unknown\" to kinds left out", it, 0.95)));
    let named = pooled(found.iter().map(|it| &it.unknown.named));
    bars.extend(named.map(|it| Bar::at_most("a wrong name for them", it, 0.02)));
    let counted = alarms(found, |row| &row.alarms)[at];
    let proven = counted.arl_0_at_least();
    bars.push(Bar::at_least("samples between false alarms there, 95 % limit", proven, PROVEN));
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn designs_count_by_what_they_rest_on() {
        let shares = [Share::new(1, 2), Share::new(0, 6)];
        assert_eq!(pooled(shares.iter()), Some(0.125));
        assert_eq!(pooled([].iter()), None);
        assert_eq!(pooled_rms([(2.0, 1), (0.0, 3)].into_iter()), Some(1.0));
        assert_eq!(pooled_rms([].into_iter()), None);
    }
}
