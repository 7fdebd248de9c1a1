//! A bank as a diagnoser file holds it: the drive as its own text, which an adapter outside reads.

use serde::{Deserialize, Serialize};

use super::watch::Limits;

/// Standard deviations of noise that were learned from healthy recordings, SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearnedNoise {
    /// Of the speed that is shown, rad/s (m/s).
    pub omega: f64,
    /// Of the current that is shown, A.
    pub i: f64,
    /// Of the disturbance torque, N m (N).
    pub torque: f64,
    /// Its correlation time, s.
    pub torque_time: f64,
}

/// What a bank was designed with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BankDesign {
    /// Sampling time, s.
    pub period_s: f64,
    /// Designed mean number of samples between false alarms.
    pub arl_0: f64,
    /// Rows that a judgement rests on.
    pub horizon: usize,
    /// Rows at least that a machine is learned from.
    pub baseline: usize,
    /// The drive file.
    pub drive: String,
    /// Limits with the signals of the training.
    pub limits: Limits,
    /// Limits without the current, where it was among them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits_without_current: Option<Limits>,
    pub noise: LearnedNoise,
}
