//! The bank of a plan, designed once: noise and tails of its statistics.

use drivescope_diagnoser::bank::{LearnedNoise, Row, Tails};
use drivescope_monitor::bank::{DesignError, Designed, design_for, usual_baseline};
use serde::{Deserialize, Serialize};

use super::super::plan::Plan;

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
    /// The bank of a plan, from healthy runs of its nominal drive.
    ///
    /// # Errors
    /// As [`drivescope_monitor::bank::design`].
    pub(in crate::campaign) fn new(plan: &Plan, healthy: &[Vec<Row>]) -> Result<Self, DesignError> {
        let period_s = plan.experiment.period_s;
        let baseline = plan.run_up.min(usual_baseline(period_s));
        let how = (baseline, plan.design_seed);
        let Designed { noise, tails, how, .. } = design_for(plan.drive(), period_s, healthy, how)?;
        Ok(Self { baseline: how.baseline, horizon: how.horizon, noise, tails })
    }
}
