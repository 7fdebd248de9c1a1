//! Decisions over lanes of scenarios, and what is counted of them: no verdict is stored.

/// Sample of a declaration that has not come.
const NEVER: u64 = u64::MAX;

/// Where in a sample each lane stands, 1 or 0: before its faults, and within them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Phase<const N: usize> {
    pub(super) healthy: [u64; N],
    pub(super) faulty: [u64; N],
}

/// What one method found of one scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::campaign) struct Found {
    /// Healthy samples outside.
    pub(in crate::campaign) outside_healthy: u64,
    /// Faulty samples outside.
    pub(in crate::campaign) outside_fault: u64,
    /// Detection time, samples from the start.
    pub(in crate::campaign) t_dt: Option<u64>,
    /// Declarations before it.
    pub(in crate::campaign) false_alarms: u64,
}

/// The rule of [`drivescope_diagnoser::RunRule`] over lanes, and its counts.
#[derive(Debug, Clone)]
pub(super) struct Tally<const N: usize> {
    window: [u64; N],
    onset: [u64; N],
    consecutive: [u64; N],
    inside: [u64; N],
    standing: [u64; N],
    outside_healthy: [u64; N],
    outside_fault: [u64; N],
    t_dt: [u64; N],
    false_alarms: [u64; N],
}

impl<const N: usize> Tally<N> {
    /// Declares after `window` exceedances in a row; faults begin at `onset`, or never.
    pub(super) fn new(window: [u64; N], onset: [u64; N]) -> Self {
        let zero = [0; N];
        Self {
            window,
            onset,
            consecutive: zero,
            inside: zero,
            standing: zero,
            outside_healthy: zero,
            outside_fault: zero,
            t_dt: [NEVER; N],
            false_alarms: zero,
        }
    }

    /// Takes sample `k`: 1 where the residual exceeds.
    #[inline(always)]
    pub(super) fn step(&mut self, k: u64, exceeds: &[u64; N], phase: &Phase<N>) {
        let mut rises = [0; N];
        let mut any = 0;
        for l in 0..N {
            self.outside_healthy[l] += exceeds[l] & phase.healthy[l];
            self.outside_fault[l] += exceeds[l] & phase.faulty[l];
            self.consecutive[l] = if exceeds[l] == 1 { self.consecutive[l] + 1 } else { 0 };
            self.inside[l] = if exceeds[l] == 1 { 0 } else { self.inside[l] + 1 };
            let holds = u64::from(2 * self.inside[l] < self.window[l]);
            let begins = u64::from(self.consecutive[l] >= self.window[l]);
            let now = if self.standing[l] == 1 { holds } else { begins };
            rises[l] = now & (1 - self.standing[l]);
            any |= rises[l];
            self.standing[l] = now;
        }
        if any != 0 {
            self.declared(k + 1, &rises);
        }
    }

    /// Counts declarations at time `t_dt` as [`drivescope_diagnoser::Trace::detection`] does.
    #[cold]
    #[inline(never)]
    fn declared(&mut self, t_dt: u64, rises: &[u64; N]) {
        for l in 0..N {
            if rises[l] == 0 || self.t_dt[l] != NEVER {
                continue;
            }
            let onset = self.onset[l];
            if t_dt > onset && 2 * (t_dt - onset) > self.window[l] {
                self.t_dt[l] = t_dt;
            } else {
                self.false_alarms[l] += 1;
            }
        }
    }

    pub(super) fn found(&self, l: usize) -> Found {
        Found {
            outside_healthy: self.outside_healthy[l],
            outside_fault: self.outside_fault[l],
            t_dt: Some(self.t_dt[l]).filter(|it| *it != NEVER),
            false_alarms: self.false_alarms[l],
        }
    }
}

#[cfg(test)]
mod tests {
    use drivescope_diagnoser::{Detection, RunRule, Trace, Verdict};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    /// Random runs of exceedances, judged by the stored trace and as they come.
    #[test]
    fn it_finds_what_a_stored_trace_tells() {
        const LANES: usize = 4;
        const SAMPLES: usize = 3000;
        for seed in 0..20 {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let onset: [u64; LANES] = std::array::from_fn(|_| random.random_range(1000..2900));
            let window: [u64; LANES] = [50, 10, 1, 7];
            let mut exceeds = vec![[0u64; LANES]; SAMPLES];
            for l in 0..LANES {
                let mut k = 0;
                while k < SAMPLES {
                    let (run, gap) = (random.random_range(1..90), random.random_range(1..300));
                    exceeds.iter_mut().skip(k).take(run).for_each(|row| row[l] = 1);
                    k += run + gap;
                }
            }
            let mut tally = Tally::new(window, onset);
            for (k, exceeds) in exceeds.iter().enumerate() {
                let k = k as u64;
                let healthy = onset.map(|onset| u64::from(k < onset));
                tally.step(k, exceeds, &Phase { healthy, faulty: healthy.map(|it| 1 - it) });
            }
            for l in 0..LANES {
                let mut rule = RunRule::new(window[l] as usize);
                let verdict = |row: &[u64; LANES]| Verdict {
                    residual: 0.0,
                    lower: -1.0,
                    upper: 1.0,
                    exceeds: row[l] == 1,
                    declared: rule.step(row[l] == 1),
                };
                let verdicts: Vec<Verdict> = exceeds.iter().map(verdict).collect();
                let trace = Trace { verdicts, run_up: 0, window: window[l] as usize };
                let Detection { t_dt, false_alarms } = trace.detection(onset[l] as usize);
                let found = tally.found(l);
                assert_eq!(found.t_dt, t_dt.map(|it| it as u64));
                assert_eq!(found.false_alarms, false_alarms as u64);
                let outside = trace.exceedance_rate(0..onset[l] as usize).expect("a span");
                assert!((found.outside_healthy as f64 / onset[l] as f64 - outside).abs() < 1e-12);
            }
        }
    }
}
