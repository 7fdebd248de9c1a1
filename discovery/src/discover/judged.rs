//! A candidate that was fitted, with the evidence for it.

use super::refit::Model;

/// A fitted candidate.
pub(crate) struct Judged {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// The drive with it.
    pub(crate) model: Model,
    pub(crate) weighed: Weighed,
    /// Why it is not named.
    pub(crate) refused: Option<String>,
    /// Whether the error was found to fall with it.
    pub(crate) lowers: bool,
}

impl Judged {
    /// Not yet judged.
    pub(crate) fn of(candidate: usize, model: Model, weighed: Weighed) -> Self {
        Self { candidate, model, weighed, refused: None, lowers: false }
    }
}

/// The evidence of a fitted candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weighed {
    /// ln of it over that of the base, of all recordings.
    pub(crate) evidence: f64,
    /// The same in the recordings of the fit.
    pub(crate) fitted: f64,
    /// The same in those held out, given the others.
    pub(crate) repeats: f64,
    /// Root of the mean square of what it does, of what the balance holds.
    pub(crate) size: f64,
    /// That it is what is missing, among the candidates and nothing.
    pub(crate) probability: f64,
    /// Whether nothing but its size speaks against it.
    pub(crate) small: bool,
    /// Whether the error of the torque speaks for it, and not that of the motion.
    pub(crate) by_balance: bool,
}

impl Weighed {
    /// From the evidence over that of the base in the recordings of the fit, in all, and in those held
    /// out, not yet among others. What the recordings of the fit deny no others make good.
    pub(crate) fn of([fitted, all, repeats]: [f64; 3], size: f64) -> Self {
        let evidence = if fitted > 0.0 { all } else { all.min(fitted) };
        Self { evidence, fitted, repeats, size, probability: 0.0, small: false, by_balance: false }
    }
}
