//! The rule by which an effect is named: every number of it, and why.
//!
//! Evidence is the logarithm of how much more probable the recordings are with a law than without,
//! its coefficients and shapes averaged over what they may be ([`crate::likelihood`]): all recordings
//! together, and those held out, given the others, must speak for the law too.

/// How often a law of the library is missing, and something that no library has, before anything
/// is known, over how often nothing is: there are some 25 laws, of which about one in two drives
/// lacks one that its recordings show, and one in seven of these no library has. The curves share
/// their part.
pub(crate) const LAW_ODDS: f64 = 0.04;
pub(crate) const CURVE_ODDS: f64 = 0.006;
/// Evidence that a name needs: 3,000 to 1, for a wrong name sends a person to the wrong part.
pub(crate) const EVIDENCE: f64 = 8.0;
/// The same of a further name, for what the first law's formula leaves looks like more.
pub(crate) const FURTHER_EVIDENCE: f64 = 10.0;
/// Least size of what is named, of what the balance holds: below, it may be what the base's own
/// formulas leave, which no amount of data tells from an effect.
pub(crate) const SIZE: f64 = 0.02;
/// The same of a further name.
pub(crate) const FURTHER_SIZE: f64 = 0.04;
/// Least share of the squared error above its floor, in the recordings held out, that a name must take
/// away: what takes less, and has evidence nonetheless, imitates a corner of something else.
pub(crate) const EXPLAINS: f64 = 0.02;
/// Share of the error above its floor that may stay with a smaller one, in all recordings: with what
/// the base's formulas leave in the way, more would.
pub(crate) const LEFT: f64 = 0.1;
/// Least share of the evidence of the best free curve, in the recordings of the fit, that a law must
/// have: a law with less only resembles what is missing. A curve follows what any formula leaves of
/// a real machine too.
pub(crate) const SHARE: f64 = 0.5;
/// Laws whose evidence is that close are not told apart: 150 to 1.
pub(crate) const CONFUSED: f64 = 5.0;
/// Share of its evidence that a law may have less than a richer one that excludes it and still be
/// preferred: the richer one holds it as a case, and a part of what its formula leaves.
pub(crate) const NESTED: f64 = 0.03;
/// Part of a named law's size that its formula may leave over its own variables.
pub(crate) const FORMULA: f64 = 0.1;
/// Laws that are fitted in a round: how far one looks, not how one judges.
pub(crate) const REFITTED: usize = 5;
/// Rounds at most, each of which adds one effect.
pub(crate) const ROUNDS: usize = 4;
/// Least share of the best curve's evidence that one must have which the effect `learned` can hold, to
/// be shown in its place.
pub(crate) const ADDABLE: f64 = 0.8;
