//! The loop: weigh, fit, decide, add, until nothing is left or nobody knows.

use drivescope_plant::drive::{Drive, EffectData};

use super::candidate::Candidate;
use super::candidates::candidates;
use super::decision::{self, Rule};
use super::ground::Ground;
use super::judged::Judged;
use super::needless::{Added, needless};
use super::not_judged::NotJudged;
use super::other_machine;
use super::refit::Model;
use super::report::{Discovery, Step, Unfitted, Verdict, Watch, seen_by};
use super::round::{Formula, Outcome, Round};
use super::spans::{are_possible, spans};
use super::typed;
use super::unusable;
use super::withdrawn::{explains_little, withdrawn};
use crate::case::Setting;
use crate::compare::{self, Finding, Load};
use crate::error::Error;
use crate::estimate::{AS_WELL, Evidence, Options};
use crate::likelihood::Filtered;
use crate::signals::{SignalFinding, What, is_coarse};

/// Samples from which on a search and a comparison run one after the other: both hold hundreds of bytes a
/// sample.
const LONG: usize = 250_000;
/// Starts of the base fit: the file's values may be far off.
const STARTS: usize = 2;

/// Finds what the drive's model lacks.
///
/// # Errors
/// Those of a fit of the base drive.
pub fn discover(
    drive: &Drive,
    estimation: &Evidence,
    validation: &Evidence,
    watch: &dyn Watch,
) -> Result<Discovery, Error> {
    discover_by(&Rule::NAMING, drive, (estimation, validation), watch)
}

/// The same by another rule of naming.
///
/// # Errors
/// As of [`discover`].
pub fn discover_by(
    rule: &Rule,
    drive: &Drive,
    (estimation, validation): (&Evidence, &Evidence),
    watch: &dyn Watch,
) -> Result<Discovery, Error> {
    let wrong = unusable::signals(drive, estimation, validation);
    if wrong.iter().any(SignalFinding::forbids) {
        return Ok(unusable::discovery(drive, estimation, wrong));
    }
    let both = (estimation, validation);
    let (drive_alone, typed) = &typed::apart(drive);
    let (model, begun) = begin(drive_alone, both, watch)?;
    let search = |model, begun| searched(rule, drive, typed, both, (model, begun), watch);
    let seen = |error| seen_by(watch, error);
    let left = |of: &Discovery| of.ladder.last()?.validation_unexplained.torque;
    let explains = |of: &Discovery| left(of).is_none_or(|torque| torque.share <= 1.0);
    // Beside a base that follows the motion and explains less torque than another, every column may be
    // that of another machine.
    let balanced = || {
        let other = model.by_balances(estimation, validation, &seen)?;
        let begun = first_step(&other, both, watch);
        Some((other, begun))
    };
    let observed = model.setting.observer.follows();
    let mut other = if observed { balanced() } else { None };
    // Behind an observer the torque is what tells, where any of it is explained.
    if let Some((other, begun)) = other.take_if(|(_, begun)| explains(begun)) {
        return Ok(with_signals(search(other, begun), wrong));
    }
    let found = search(model.clone(), begun);
    // Where no name comes of it, or none that explains torque, what is missing is asked once more beside
    // the base that explains most, and the answer that leaves less of it counts.
    let convinces = found.verdict == Verdict::Named && explains(&found);
    if convinces || watch.stopped() {
        return Ok(with_signals(found, wrong));
    }
    if !observed {
        other = balanced();
    }
    let Some((other, begun)) = other else {
        return Ok(with_signals(found, wrong));
    };
    let mut again = search(other, begun);
    if again.verdict == Verdict::None && found.verdict != Verdict::None {
        // Two bases that contradict each other do not say that nothing is missing.
        (again.verdict, again.remaining) = (Verdict::Unknown, Verdict::Unknown);
    }
    let better = left(&again)
        .zip(left(&found))
        .is_some_and(|(again, found)| AS_WELL * again.rms < found.rms);
    Ok(with_signals(if better { again } else { found }, wrong))
}

/// The loop, from a base and the first step of its ladder.
fn searched(
    rule: &Rule,
    of_user: &Drive,
    typed: &[EffectData],
    (estimation, validation): (&Evidence, &Evidence),
    (mut model, mut found): (Model, Discovery),
    watch: &dyn Watch,
) -> Discovery {
    let base = model.clone();
    let mut added: Vec<Added> = Vec::new();
    let mut randomness = None;
    let mut rebased = false;
    let seen = |error| seen_by(watch, error);
    for round in 0..decision::ROUNDS {
        if watch.stopped() {
            break;
        }
        let spans = spans(&model.fitted.drive, estimation);
        let (all, not) = candidates(&model.fitted.drive, estimation, &spans, typed);
        let formulas: Vec<Formula> = added.iter().map(|it| it.formula.clone()).collect();
        let balanced = |model: &Model, added: &[Added]| {
            let named = |id: &str| added.iter().any(|it| it.id == id);
            let better = model.by_balances(estimation, validation, &seen)?;
            are_possible(&better.fitted.drive, named, &spans).then_some(better)
        };
        let turn = Round {
            rule,
            model: &model,
            all: &all,
            spans: &spans,
            estimation,
            validation,
            watch,
            named: &found.named.clone(),
            formulas: &formulas,
            randomness,
        };
        let ground = turn.ground();
        let run = || ground.as_ref().map_or_else(Outcome::default, |ground| turn.run(ground));
        let fails = || fails(&model, estimation, ground.as_ref().and_then(Ground::filtered));
        let outcome = if round == 0 && watch.compares() {
            let (outcome, fails) = match estimation.samples() > LONG {
                true => (run(), fails()),
                false => rayon::join(run, fails),
            };
            found.fails = fails;
            outcome
        } else {
            run()
        };
        if round == 0 {
            let unfitted = outcome.unfitted.iter().map(|(candidate, evidence)| Unfitted {
                effect: all[*candidate].name.clone(),
                delta_bic: 2.0 * evidence,
            });
            found.unfitted = unfitted.collect();
            found.not_judged = not;
            let of = |which: &[usize], why: fn(&Candidate) -> NotJudged| -> Vec<NotJudged> {
                which.iter().map(|it| why(&all[*it])).collect()
            };
            found.not_judged.extend(of(&outcome.untold, NotJudged::untold));
            found.not_judged.extend(of(&outcome.imitated, NotJudged::imitated));
            found.not_judged.extend(of(&outcome.overflowing, NotJudged::overflowing));
        }
        found.load = outcome.load.or(found.load);
        randomness = outcome.randomness;
        let passed = outcome.judged.iter().position(|one| one.refused.is_none());
        found.note(&turn, &outcome, passed);
        let Outcome { mut judged, unknown, proposed, formulas_fail, .. } = outcome;
        let Some(best) = passed else {
            // What is left beside a fit that follows the motion may be torque that it explains worse than
            // the balances do.
            if !rebased && let Some(last) = added.last() {
                rebased = true;
                if let Some(better) = balanced(&model, &added) {
                    found.ladder.pop();
                    let kind = Some(last.kind.clone());
                    found.climb(kind, &better, (estimation, validation), watch);
                    model = better;
                    continue;
                }
            }
            let observer = model.setting.observer;
            let lost = found.ladder.last().is_some_and(|it| explains_little(it, observer));
            let missing = unknown.is_some() || !proposed.is_empty() || lost;
            found.formulas = proposed;
            found.remaining = if missing { Verdict::Unknown } else { Verdict::None };
            found.learned = unknown.map(|curve| turn.drawn(&curve, &found.formulas));
            // Along a known motion the input answers what disturbs it, and a comparison with it too; what
            // it finds in few levels may be the converter's.
            let tells = randomness.is_some() && !is_coarse(estimation);
            if round == 0 && found.remaining == Verdict::None && tells && !watch.stopped() {
                let convicts = |it: &Finding| convicts(rule, it);
                let contradicted = match watch.compares() {
                    true => found.fails.iter().any(convicts),
                    false => fails().iter().any(convicts),
                };
                if contradicted {
                    found.remaining = Verdict::Unknown;
                }
            }
            if formulas_fail || missing {
                let mut remainder = model.clone();
                while let Some(it) =
                    (Round { model: &remainder, ..turn }).formulas_instead(&added, &found.formulas)
                {
                    let of_kind = it.refused.is_none();
                    remainder =
                        found.put(it, &mut added, remainder, (estimation, validation), watch);
                    if of_kind {
                        break;
                    }
                }
                model = remainder;
            }
            break;
        };
        let kind = all[judged[best].candidate].name.clone();
        if !found.named.contains(&kind) && !turn.refines(&all[judged[best].candidate]) {
            found.named.push(kind.clone());
        }
        let Judged { candidate, model: named, weighed, .. } = judged.swap_remove(best);
        added.push(Added {
            kind: kind.clone(),
            id: all[candidate].id.clone(),
            estimated: all[candidate].estimated(),
            coefficients: all[candidate].coefficients.clone(),
            by_error: !weighed.by_balance,
            formula: Formula::of(&all[candidate], weighed.size),
        });
        // The minimum of the estimation data may lie where those held out deny it, or behind an observer
        // where less of the torque is explained.
        let error = |of: &Model| of.validation.squares.error();
        let left = || turn.torque_left(&named.fitted.drive);
        let still = |it: &Model| {
            error(it) <= error(&model).max(error(&named)) && !turn.raises_torque(left(), it)
        };
        let polished = (!weighed.by_balance)
            .then(|| named.polished(estimation, validation, &seen).ok().filter(still))
            .flatten();
        let named = polished.unwrap_or(named);
        // Behind an observer, what comes next is asked beside what explains most torque.
        let observed = named.setting.observer.follows();
        model = observed.then(|| balanced(&named, &added)).flatten().unwrap_or(named);
        found.climb(Some(kind), &model, (estimation, validation), watch);
        while let Some((place, fewer)) = needless(&model, &added, (estimation, validation), watch) {
            let it = added.remove(place);
            found.take_back(&it.kind, &added);
            model = fewer.polished(estimation, validation, &seen).unwrap_or(fewer);
            let last = added.last().map(|it| it.kind.clone());
            found.climb(last, &model, (estimation, validation), watch);
        }
    }
    if let Some(why) = withdrawn(rule, &found, (&model.fitted.drive, estimation)) {
        found.take_all_back(&base, why);
        model = base;
    }
    found.end(model.fitted.drive, of_user);
    found.verdict = if found.named.is_empty() { found.remaining } else { Verdict::Named };
    found
}

/// The base, fitted to the motion, with the first step of its ladder.
pub(super) fn begin(
    drive: &Drive,
    (estimation, validation): (&Evidence, &Evidence),
    watch: &dyn Watch,
) -> Result<(Model, Discovery), Error> {
    let setting = Setting::of_fit(drive, estimation);
    watch.step(&Step::Doing("fitting the base drive"));
    let options = Options { starts: STARTS, balanced: false, ..Options::default() };
    let seen = |error| seen_by(watch, error);
    let model = Model::fit(drive, estimation, validation, setting, &options, &seen)?;
    let found = first_step(&model, (estimation, validation), watch);
    Ok((model, found))
}

/// The first step of a ladder.
fn first_step(
    base: &Model,
    (estimation, validation): (&Evidence, &Evidence),
    watch: &dyn Watch,
) -> Discovery {
    let mut found = Discovery {
        doubts: other_machine::doubt(base, validation).into_iter().collect(),
        ..Discovery::of(&base.fitted.drive, Verdict::None, base.setting.observer)
    };
    found.climb(None, base, (estimation, validation), watch);
    found
}

/// Two sensors that show one motion at different times are something that the model lacks.
fn with_signals(mut found: Discovery, signals: Vec<SignalFinding>) -> Discovery {
    let late = signals.iter().any(|it| it.what == What::Late);
    if late && found.verdict == Verdict::None {
        (found.verdict, found.remaining) = (Verdict::Unknown, Verdict::Unknown);
    }
    Discovery { signals, ..found }
}

/// Whether a comparison of the base shows that something is missing, whatever the library says of it:
/// "nothing" beside a dependence as improbable as a name is asked to be, and of more of the error than
/// formulas that are right in their kind may leave, would contradict it.
fn convicts(rule: &Rule, finding: &Finding) -> bool {
    let asked = rule.evidence - rule.law_odds.ln();
    finding.p_value < (-asked).exp() && finding.share >= rule.formula
}

/// Where the base fails, which that filter has brought to its best; nothing where its recordings cannot be
/// compared together.
fn fails(model: &Model, estimation: &Evidence, filtered: Option<&Filtered>) -> Vec<Finding> {
    let options = compare::Options { curves: false, seed: 0, fit: false };
    let (load, drive) = (Load::Known(filtered), &model.fitted.drive);
    let compared = compare::compare_under(load, drive, estimation, &model.setting, &options);
    compared.map_or_else(|_| Vec::new(), |compared| compared.findings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::Observer;
    use crate::signals::{Consequence, Size};
    use crate::testing::dr300;

    #[test]
    fn nothing_is_missing_only_where_the_sensors_agree() {
        let finding = |what: What| SignalFinding {
            recording: "run".to_owned(),
            channel: "omega".to_owned(),
            what,
            at: None,
            size: Size { value: 0.05, of: "s late" },
            consequence: Consequence::Limits,
            sentence: String::new(),
            next: String::new(),
        };
        let answer = |what: What, verdict: Verdict| {
            let found = Discovery::of(&dr300(), verdict, Observer::NONE);
            let found = with_signals(found, vec![finding(what)]);
            (found.verdict, found.signals.len())
        };
        assert_eq!(answer(What::Late, Verdict::None), (Verdict::Unknown, 1));
        assert_eq!(answer(What::Coarse, Verdict::None), (Verdict::None, 1));
        assert_eq!(answer(What::Late, Verdict::Named), (Verdict::Named, 1));
    }
}
