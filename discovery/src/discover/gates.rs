//! The rule by which an effect is named. Frozen: the thresholds were set on other seeds than any
//! table that reports rates.

/// Least gain in BIC (a factor of 150 in evidence; Kass and Raftery, 1995: "very strong").
pub(crate) const DELTA_BIC: f64 = 10.0;
/// Greatest p value of the block-robust test, after the number of hypotheses is counted.
pub(crate) const P_VALUE: f64 = 0.05;
/// Least share of what the best curve over an own variable removes that the law must remove.
pub(crate) const SHAPE: f64 = 0.8;
/// The same against curves over any variable: a law that removes less than half of what could be
/// removed at once is not the first thing that is missing.
pub(crate) const MAIN: f64 = 0.5;
/// Least share of the first excess that a further effect must remove: below, it may be what a
/// named law's own formula leaves.
pub(crate) const FURTHER: f64 = 0.1;
/// Least cosine between the phases in estimation and validation data.
pub(crate) const PHASE: f64 = 0.7;
/// Candidates that are refitted.
pub(crate) const REFITTED: usize = 5;
/// Effects that are added at most.
pub(crate) const ROUNDS: usize = 4;
/// Laws whose gains are this close are not told apart by these recordings.
pub(crate) const CLOSE: f64 = 10.0;
/// Blocks of the tests of curves, s.
pub(crate) const BLOCK_S: f64 = 0.25;
/// Least share of the excess that a curve over time must remove to count as something unknown:
/// time does not repeat, so no other recording can confirm it, and a slow random load looks alike.
pub(crate) const OVER_TIME: f64 = 0.7;
/// Least cosine between what two laws change for them to be one confusion set.
pub(crate) const ALIKE: f64 = 0.98;
