//! Limits of a bank for a designed mean time between false alarms, and their verification.
//!
//! Machines are drawn from the tolerance of what is learned of each, a bank is learned on each from
//! a baseline, and its statistics over healthy rows at other set points and through steps and
//! reversals make the tails. Verification draws other machines and counts alarms.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::baseline::{BaselineError, learn};
use super::design::{ONE_SIDED_95, Tail, TailError};
use super::process::{Process, Row};
use super::simulated::{Driving, simulated};
use super::watch::{Event, Limits, Watch};

/// Rows that each machine is watched over.
const WATCHED: usize = 20_000;
/// Statistics of a bank that can raise an alarm: each has its share of the false ones.
const STATISTICS: f64 = 2.0;
/// A limit that is never reached.
const NEVER: Limits = Limits { ratio: f64::INFINITY, squares: f64::INFINITY };
/// Share of the machines that may be refused by their own baselines.
const REFUSED: f64 = 0.1;

/// How limits are designed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// What drives the simulated runs.
    pub driving: Driving,
    /// Rows that each machine is learned from.
    pub baseline: usize,
    /// Rows that a judgement rests on.
    pub horizon: usize,
    /// Healthy samples to simulate.
    pub samples: usize,
    /// Seed of machines and noise.
    pub seed: u64,
}

/// The tails of a bank's statistics on healthy samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tails {
    ratio: Tail,
    squares: Tail,
}

impl Tails {
    /// The limits that are exceeded once in `arl_0` samples on average.
    pub fn limits(&self, arl_0: f64) -> Limits {
        let limit = |tail: &Tail| tail.limit(STATISTICS * arl_0);
        Limits { ratio: limit(&self.ratio), squares: limit(&self.squares) }
    }
}

/// Why there are no limits.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrationError {
    /// Too few samples.
    #[error(transparent)]
    Tail(#[from] TailError),
    /// Simulated healthy machines are refused.
    #[error("{refused} of {machines} simulated healthy machines are not learned: {first}")]
    Refused {
        /// Machines that were refused.
        refused: usize,
        /// Machines that were drawn.
        machines: usize,
        /// Why the first was.
        first: BaselineError,
    },
}

/// What a verification counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Verified {
    /// Healthy samples.
    pub samples: usize,
    pub alarms: usize,
}

impl Verified {
    /// Lower 95 % limit of the mean samples between alarms: over the upper limit of a Poisson
    /// count (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931), 684-688).
    pub fn arl_0_at_least(&self) -> f64 {
        let n = self.alarms as f64 + 1.0;
        let most = n * (1.0 - 1.0 / (9.0 * n) + ONE_SIDED_95 / (3.0 * n.sqrt())).powi(3);
        self.samples as f64 / most
    }
}

impl Calibration {
    /// Draws the machines and gives each, with its watch and the rows after its baseline, to
    /// `each`; in parallel, the results in the order of the machines.
    fn machines<const N: usize, P: Process<N> + Sync, R: Send>(
        &self,
        process: &P,
        limits: Limits,
        each: impl Fn(Watch<N, P>, &[Row]) -> R + Sync,
    ) -> Result<Vec<R>, CalibrationError> {
        let machines = self.samples.div_ceil(WATCHED) as u64;
        let silent = Row { control: 0.0, shown: [f64::NAN; super::SENSORS] };
        let nominal = process.begin(&silent);
        let moving = N - process.learned().len();
        let made = (0..machines).into_par_iter().map(|number| {
            let mut random = Pcg64Mcg::seed_from_u64(self.seed ^ (number << 20));
            let tolerance = |n: usize| {
                let normal: f64 = StandardNormal.sample(&mut random);
                nominal.covariance[n][n].sqrt() * normal
            };
            let machine: Vec<f64> = (moving..N).map(tolerance).collect();
            let lengths = (self.baseline, WATCHED);
            let seed = (self.seed << 1) ^ (number << 20) ^ 1;
            let rows = simulated(process, &self.driving, lengths, &machine, seed);
            let (baseline, rows) = rows.split_at(self.baseline);
            let watch = learn(process.clone(), baseline, limits, self.horizon)?;
            Ok(each(watch, rows))
        });
        let made: Vec<Result<R, BaselineError>> = made.collect();
        let refused = made.iter().filter(|it| it.is_err()).count();
        if refused as f64 > REFUSED * machines as f64
            && let Some(first) = made.iter().find_map(|it| it.as_ref().err()).cloned()
        {
            let machines = machines as usize;
            return Err(CalibrationError::Refused { refused, machines, first });
        }
        Ok(made.into_iter().flatten().collect())
    }
}

/// The tails of the statistics of a process.
///
/// # Errors
/// Too few samples for a tail; simulated machines that their own baselines refuse.
pub fn calibrate<const N: usize, P: Process<N> + Sync>(
    process: &P,
    how: &Calibration,
) -> Result<Tails, CalibrationError> {
    let statistics = how.machines(process, NEVER, |mut watch, rows| {
        let of_row = |row| {
            watch.step(row);
            let statistics = watch.statistics();
            [statistics.ratio, statistics.squares]
        };
        rows.iter().map(of_row).collect::<Vec<_>>()
    })?;
    let tail = |which: usize| Tail::of(statistics.iter().flatten().map(|of_row| of_row[which]));
    Ok(Tails { ratio: tail(0)?, squares: tail(1)? })
}

/// Alarms of a process with those limits over healthy samples.
///
/// # Errors
/// Simulated machines that their own baselines refuse.
pub fn verify<const N: usize, P: Process<N> + Sync>(
    process: &P,
    limits: Limits,
    how: &Calibration,
) -> Result<Verified, CalibrationError> {
    let counts = how.machines(process, limits, |mut watch, rows| {
        let alarms = rows.iter().filter(|row| matches!(watch.step(row), Some(Event::Alarm(_))));
        (alarms.count(), rows.len())
    })?;
    let (alarms, samples) = counts.into_iter().fold((0, 0), |(a, s), of| (a + of.0, s + of.1));
    Ok(Verified { samples, alarms })
}
