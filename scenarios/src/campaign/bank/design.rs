//! The bank of a plan, designed once: noise and tails of its statistics.

use drivescope_diagnoser::bank::{LearnedNoise, Row, Tails};
use drivescope_monitor::bank::{DesignError, Designed, design_for, usual_baseline};
use drivescope_recording::Recording;
use serde::{Deserialize, Serialize};

use super::super::plan::Plan;
use crate::seen::rows;

/// Samples that noise is learned from, over all set points: each evaluation of a likelihood runs through
/// them some times.
const SAMPLES: usize = 12_000;

/// What the bank of a plan was designed with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignedBank {
    /// Samples at the end of the run-up that each machine is learned from.
    pub baseline: usize,
    /// Samples that a judgement rests on.
    pub horizon: usize,
    /// Noise, as it was learned from healthy runs.
    pub noise: LearnedNoise,
    /// Tails of the statistics on simulated healthy machines: limits for any mean time between
    /// false alarms.
    pub tails: Tails,
}

impl DesignedBank {
    /// The bank of a plan, from healthy runs of its nominal drive, which begin with C_m, T and I_m.
    ///
    /// # Errors
    /// As [`drivescope_monitor::bank::design`].
    pub(in crate::campaign) fn new(plan: &Plan, runs: &[Recording]) -> Result<Self, DesignError> {
        let period_s = plan.experiment.period_s;
        let per_si = plan.drive().sensors.tacho_unit.per_si();
        let most = SAMPLES.div_ceil(runs.len().max(1));
        let some = |run: &Recording| {
            let mut rows = rows(run, per_si);
            rows.truncate(most);
            rows
        };
        let healthy: Vec<Vec<Row>> = runs.iter().map(some).collect();
        let baseline = plan.run_up.min(usual_baseline(period_s));
        let how = (baseline, plan.design_seed);
        let Designed { noise, tails, how, .. } = design_for(plan.drive(), period_s, &healthy, how)?;
        Ok(Self { baseline: how.baseline, horizon: how.horizon, noise, tails })
    }
}
