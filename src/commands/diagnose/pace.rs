//! When rows arrive against when they should: what was lost, came late or twice.

/// Departure from the grid, in sampling times, that is rounding of printed times.
const ROUNDING: f64 = 1e-4;
/// Share of a departure that the grid follows: clocks of senders drift.
const FOLLOWED: f64 = 0.05;
/// Rows from which the sampling time of a stream is known, and by what it may differ.
const KNOWN: usize = 20;
const SAME: f64 = 0.1;
/// Rows in a row that are late, each after the one before, from which the clock was set back.
const SET_BACK: usize = 20;

/// What a row is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arrival {
    /// The next one, before which so many were lost, at that time, s.
    Row { lost: usize, time: f64 },
    /// The first of a stream whose clock was set back.
    SetBack { time: f64 },
    /// Of a time that was there already.
    Repeated,
    /// Of a time before the last row's.
    Late,
    /// Between two samples.
    Between,
    /// The stream has another sampling time, s.
    OtherPeriod(f64),
}

/// Rows whose time goes back.
#[derive(Debug, Clone)]
pub(super) struct Backwards {
    /// Time of the last of them, and how many there were in a row, each after the one before.
    last: f64,
    in_a_row: usize,
}

impl Default for Backwards {
    fn default() -> Self {
        Self { last: f64::NEG_INFINITY, in_a_row: 0 }
    }
}

impl Backwards {
    /// What a row is that does not come after the last one taken; nothing if it does. Once the clock
    /// was set back, the stream begins anew.
    pub(super) fn arrives(&mut self, time: f64, last: f64) -> Option<Arrival> {
        if time > last {
            *self = Self::default();
            return None;
        }
        self.in_a_row = if time > self.last { self.in_a_row + 1 } else { 1 };
        self.last = time;
        Some(if self.in_a_row >= SET_BACK {
            Arrival::SetBack { time }
        } else if time == last {
            Arrival::Repeated
        } else {
            Arrival::Late
        })
    }
}

/// The grid on which rows arrive.
#[derive(Debug, Clone)]
pub(super) struct Pace {
    period_s: f64,
    start: f64,
    /// Place of the last row from the start.
    place: usize,
    /// What the clock has drifted by, s.
    drift: f64,
    last: Option<f64>,
    backwards: Backwards,
    /// Time of the last row, whatever it was, and the first steps from row to row.
    before: f64,
    steps: Vec<f64>,
}

impl Pace {
    pub(super) fn new(period_s: f64) -> Self {
        let (backwards, steps) = (Backwards::default(), Vec::with_capacity(KNOWN));
        let (start, place, drift, before) = (0.0, 0, 0.0, 0.0);
        Self { period_s, start, place, drift, last: None, backwards, before, steps }
    }

    fn begin(&mut self, time: f64) {
        (self.start, self.place, self.drift, self.last) = (time, 0, 0.0, Some(time));
        self.backwards = Backwards::default();
    }

    /// Mean of the middle half of the first steps, s: neither lost rows nor a jitter from row to row
    /// change it.
    fn usual_step(&self) -> f64 {
        let mut sorted = self.steps.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = &sorted[sorted.len() / 4..sorted.len() - sorted.len() / 4];
        middle.iter().sum::<f64>() / middle.len() as f64
    }

    /// Takes the time of a row, s.
    pub(super) fn arrives(&mut self, time: f64) -> Arrival {
        let before = std::mem::replace(&mut self.before, time);
        let Some(last) = self.last else {
            self.begin(time);
            return Arrival::Row { lost: 0, time };
        };
        if self.steps.len() < KNOWN {
            self.steps.push((time - before).abs());
            if self.steps.len() == KNOWN {
                let usual = self.usual_step();
                if (usual - self.period_s).abs() > SAME * self.period_s {
                    return Arrival::OtherPeriod(usual);
                }
            }
        }
        if let Some(back) = self.backwards.arrives(time, last) {
            if matches!(back, Arrival::SetBack { .. }) {
                self.begin(time);
            }
            return back;
        }
        let grid = |place: usize| self.start + place as f64 * self.period_s;
        let steps = ((time - grid(self.place) - self.drift) / self.period_s).round();
        if steps < 1.0 {
            return Arrival::Between;
        }
        // A step of centuries is a gap as any other.
        let steps = steps.min(1e15) as usize;
        let place = self.place + steps;
        let off = time - grid(place);
        let on_grid = off.abs() <= ROUNDING * self.period_s;
        let time_s = if on_grid { grid(place) } else { time };
        self.drift += FOLLOWED * (off - self.drift);
        (self.place, self.last) = (place, Some(time));
        Arrival::Row { lost: steps - 1, time: time_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrivals(times: &[f64]) -> Vec<Arrival> {
        let mut pace = Pace::new(0.01);
        times.iter().map(|time| pace.arrives(*time)).collect()
    }

    #[test]
    fn lost_late_and_repeated_rows_are_told_apart() {
        let row = |lost, time| Arrival::Row { lost, time };
        let found = arrivals(&[5.0, 5.01, 5.01, 5.04, 5.02, 5.043, 5.0499, 60.0]);
        assert_eq!(found[..2], [row(0, 5.0), row(0, 5.01)]);
        assert_eq!(found[2], Arrival::Repeated);
        assert!(matches!(found[3], Arrival::Row { lost: 2, .. }), "{found:?}");
        assert_eq!((found[4], found[5]), (Arrival::Late, Arrival::Between));
        assert!(matches!(found[6], Arrival::Row { lost: 0, time } if time == 5.0499), "{found:?}");
        assert!(matches!(found[7], Arrival::Row { lost: 5494, .. }), "{found:?}");
    }

    #[test]
    fn a_clock_may_jitter_drift_and_be_set_back() {
        let drifting: Vec<f64> =
            (0..5000).map(|k| 0.01003 * f64::from(k) + 0.003 * f64::from(k % 2)).collect();
        let lost = |it: &Arrival| !matches!(it, Arrival::Row { lost: 0, .. });
        assert_eq!(arrivals(&drifting).iter().filter(|it| lost(it)).count(), 0);
        let set_back: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k % 30)).collect();
        let found = arrivals(&set_back);
        assert!(matches!(found[49], Arrival::SetBack { .. }), "{found:?}");
        assert!(matches!(found[50], Arrival::Row { lost: 0, .. }), "{found:?}");
    }

    #[test]
    fn another_rate_is_noticed() {
        let fast: Vec<f64> = (0..40).map(|k| 0.002 * f64::from(k)).collect();
        let found = arrivals(&fast);
        assert!(
            found
                .iter()
                .any(|it| matches!(it, Arrival::OtherPeriod(s) if (s - 0.002).abs() < 1e-9))
        );
    }
}
