//! How probable each candidate is as what is missing, after the rule of naming has spoken.

use super::decision::Rule;
use super::judged::Judged;

/// How often a law of the library imitates one of another form so well that neither curve nor formula
/// tells it from that: a fifth of the laws nobody programmed, in simulations. However great the
/// evidence, what is named may be such a one.
const IMITATED: f64 = 0.2;

/// Tells the candidates how probable they are. Beside them stand that nothing is missing, at the odds
/// of 1, and something that no library has: by the evidence of its curve, or imitated by a candidate.
pub(super) fn tell(judged: &mut [Judged], rule: &Rule, unknown: Option<f64>) {
    let known = |one: &Judged| (one.weighed.evidence, one.refused.is_some());
    let all: Vec<_> = judged.iter().map(known).collect();
    for (one, probability) in judged.iter_mut().zip(probabilities(rule, &all, unknown)) {
        one.weighed.probability = probability;
    }
}

/// Of candidates by their evidence and whether they were refused, those that are preferred first.
fn probabilities(rule: &Rule, candidates: &[(f64, bool)], unknown: Option<f64>) -> Vec<f64> {
    let preferred = candidates.iter().find(|(_, refused)| !refused).map(|it| it.0);
    let ln_odds = |it: &(f64, bool)| counted(rule, *it, preferred) + rule.law_odds.ln();
    let ln_odds: Vec<f64> = candidates.iter().map(ln_odds).collect();
    let ln_curve = unknown.map(|evidence| evidence + rule.curve_odds.ln());
    // Counted from the greatest, whose exponential would overflow.
    let most = ln_odds.iter().copied().chain(ln_curve).fold(0.0, f64::max);
    let odds = |ln_odds: f64| (ln_odds - most).exp();
    let laws = ln_odds.iter().copied().map(odds).sum::<f64>();
    let imitated = IMITATED * rule.curve_odds / rule.law_odds * laws;
    let all = odds(0.0) + ln_curve.map_or(0.0, odds) + imitated + laws;
    ln_odds.into_iter().map(|it| odds(it) / all).collect()
}

/// The evidence that counts for a candidate. What has enough and is refused nonetheless imitates
/// something: its evidence is another's, and it keeps the odds that it had before. What is preferred
/// for its simplicity is not told from what has more evidence: they count the same.
fn counted(rule: &Rule, (own, refused): (f64, bool), preferred: Option<f64>) -> f64 {
    match (refused, preferred) {
        (true, _) if own > rule.evidence - rule.law_odds.ln() => 0.0,
        (false, Some(preferred)) => own.min(preferred),
        _ => own,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of what has all the evidence there may be: a law of another form has a fifth of 0.15 of its odds.
    const CERTAIN: f64 = 1.0 / 1.03;

    #[test]
    fn what_is_named_is_the_most_probable() {
        // Refused for its size, with more evidence than what is named; evidence too small; named.
        let found =
            probabilities(&Rule::NAMING, &[(900.0, true), (691.0, false), (7.4, true)], None);
        assert!((found[1] - CERTAIN).abs() < 1e-12, "{found:?}");
        assert!(found[0] < 1e-9 && found[2] < 1e-9, "{found:?}");
        // Preferred for its simplicity, beside what has more evidence: the same, and the sum is that.
        let found = probabilities(&Rule::NAMING, &[(691.0, false), (700.0, false)], None);
        assert!(found.iter().all(|it| (it - 0.5 * CERTAIN).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn where_nothing_is_named_nothing_or_the_unknown_is_probable() {
        // Odds of 0.04 e^3 = 0.8 to 1, though not enough to be named; one that imitates: 0.04 to 1.
        let found = probabilities(&Rule::NAMING, &[(40.0, true), (3.0, true)], None);
        let odds = [0.04, 0.04 * 3.0_f64.exp()];
        let all = 1.0 + (odds[0] + odds[1]) / CERTAIN;
        assert!((found[0] - odds[0] / all).abs() < 1e-12, "{found:?}");
        assert!((found[1] - odds[1] / all).abs() < 1e-12, "{found:?}");
        // A curve that stands takes it all.
        let found = probabilities(&Rule::NAMING, &[(40.0, true), (3.0, true)], Some(60.0));
        assert!(found.iter().sum::<f64>() < 1e-9, "{found:?}");
    }
}
