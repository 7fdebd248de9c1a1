//! The rule by which an effect is named: every number of it, and why.
//!
//! Evidence is the logarithm of how much more probable the recordings are with a law than without,
//! its coefficients and shapes averaged over what they may be ([`crate::likelihood`]): all recordings
//! together, and those held out, given the others, must speak for the law too.

/// The numbers by which an effect is named. `drivescope benchmark rule` tells what becomes of the
/// answers when one of them is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    /// How often a law of the library is missing, before anything is known, over how often nothing
    /// is: there are some 25 laws, of which about one in two drives lacks one that its recordings
    /// show.
    pub law_odds: f64,
    /// The same of something that no library has: one in seven of those that lack something. The
    /// curves share their part.
    pub curve_odds: f64,
    /// Evidence, beside those odds, that a name needs: 3,000 to 1, for a wrong name sends a person to
    /// the wrong part.
    pub evidence: f64,
    /// The same of a further name, for what the first law's formula leaves looks like more.
    pub further_evidence: f64,
    /// Least share that counts: of what the balance holds, below which a law may be what the base's
    /// own formulas leave, which no amount of data tells from an effect; and of the squared error
    /// above its floor, in the recordings held out, that a name must take away, for what takes less
    /// and has evidence nonetheless imitates a corner of something else.
    pub size: f64,
    /// Least share of the balance of a further name.
    pub further_size: f64,
    /// Least share of the evidence of the best free curve, in the recordings of the fit, that a law
    /// must have: a law with less only resembles what is missing. A curve follows what any formula
    /// leaves of a real machine too.
    pub share: f64,
    /// Laws whose evidence is that close are not told apart: 150 to 1.
    pub confused: f64,
    /// Share of its evidence that a law may have less than a richer one that excludes it and still be
    /// preferred: the richer one holds it as a case, and a part of what its formula leaves.
    pub nested: f64,
    /// What a formula that is right in its kind may leave: of the law's own size, over its own
    /// variables; of the error above its floor, beside which a law smaller than [`Self::size`] still
    /// explains all there is to explain.
    pub formula: f64,
}

/// A number of the rule, by its name.
pub type RuleNumber = (&'static str, fn(&mut Rule) -> &mut f64);

impl Rule {
    /// The rule of every command.
    pub const NAMING: Self = Self {
        law_odds: 0.04,
        curve_odds: 0.006,
        evidence: 8.0,
        further_evidence: 10.0,
        size: 0.02,
        further_size: 0.04,
        share: 0.5,
        confused: 5.0,
        nested: 0.03,
        formula: 0.1,
    };

    /// All of its numbers.
    pub const NUMBERS: [RuleNumber; 10] = [
        ("law_odds", |it| &mut it.law_odds),
        ("curve_odds", |it| &mut it.curve_odds),
        ("evidence", |it| &mut it.evidence),
        ("further_evidence", |it| &mut it.further_evidence),
        ("size", |it| &mut it.size),
        ("further_size", |it| &mut it.further_size),
        ("share", |it| &mut it.share),
        ("confused", |it| &mut it.confused),
        ("nested", |it| &mut it.nested),
        ("formula", |it| &mut it.formula),
    ];
}

/// Laws that are fitted in a round: how far one looks, not how one judges.
pub(crate) const REFITTED: usize = 5;
/// Rounds at most, each of which adds one effect.
pub(crate) const ROUNDS: usize = 4;
