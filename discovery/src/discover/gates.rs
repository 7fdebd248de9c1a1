//! The rule by which an effect is named. Frozen: the thresholds were set on other seeds than any
//! table that reports rates.

/// Least gain in BIC (a factor of 150 in evidence; Kass and Raftery, 1995: "very strong").
pub(crate) const DELTA_BIC: f64 = 10.0;
/// Greatest p value of the block-robust test, after the number of hypotheses is counted.
pub(crate) const P_VALUE: f64 = 0.05;
/// Least share of what the best curve over an own variable removes that the law must remove.
pub(crate) const SHAPE: f64 = 0.8;
/// The same where that law is the only one that is named, and something that nobody knows is left:
/// a resemblance. Right laws had 0.96 and more in all of 110 recordings of the tuning seeds 5402
/// and 5403, half of them under a random load; of a resistance that depends on the current the
/// heating of the winding had 0.90 and less (seed 5401).
pub(crate) const WHOLE: f64 = 0.93;
/// The same against curves over any variable: a law that removes less than half of what could be
/// removed at once is not the first thing that is missing.
pub(crate) const MAIN: f64 = 0.5;
/// Least share of the first excess that a further effect must remove: below, it may be what a
/// named law's own formula leaves.
pub(crate) const FURTHER: f64 = 0.1;
/// The same of an effect that shows over other variables than any named law.
pub(crate) const APART: f64 = 0.003;
/// Share of the variance of an output that its past does not foretell, below which the errors as
/// they are may judge where innovations do not: no random load of a bench foretells that much.
pub(crate) const REMEMBERS: f64 = 0.05;
/// Least share of the excess, on estimation and on validation data, that an effect must remove to
/// be named by the errors as they are, whatever the innovations say.
pub(crate) const PLAIN: f64 = 0.2;
/// Least cosine between the phases in estimation and validation data.
pub(crate) const PHASE: f64 = 0.7;
/// Candidates that are refitted.
pub(crate) const REFITTED: usize = 5;
/// Share of the best screened worth from which on candidates are refitted at once; the others of
/// [`REFITTED`] follow where none of these passes. A refit gains more than the screen where a law
/// is far from linear, but not five times.
pub(crate) const AT_ONCE: f64 = 0.2;
/// Effects that are added at most.
pub(crate) const ROUNDS: usize = 4;
/// Laws whose gains are this close are not told apart by these recordings.
pub(crate) const CLOSE: f64 = 10.0;
/// Blocks of the tests of curves, s.
pub(crate) const BLOCK_S: f64 = 0.25;
/// Least share of the excess that a curve over time must remove to count as something unknown:
/// time does not repeat, so no other recording can confirm it, and a slow random load looks alike.
pub(crate) const OVER_TIME: f64 = 0.7;
/// Squared innovations on the validation data, to which nothing of it was fitted, beyond which a
/// curve is no chance: a useless curve c takes away 2 c e - c^2 of innovations e, more than g with
/// at most the probability of a normal value above the root of g. This is 7 standard deviations,
/// and 3.5 of innovations whose variance is four times the supposed one.
pub(crate) const REPEATS: f64 = 50.0;
/// Share of all squared error that such a curve must remove too: the error falls by 2.5 %.
pub(crate) const PLAINLY: f64 = 0.05;
/// Least share of what the best curve removes that one must remove which the effect `learned` can
/// hold, to be shown in its place.
pub(crate) const ADDABLE: f64 = 0.8;
/// Least cosine between what two laws change for them to be one confusion set.
pub(crate) const ALIKE: f64 = 0.98;
