//! The loop: weigh, fit, decide, add, until nothing is left or nobody knows.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::file::LEARNED;

use super::candidate::Candidate;
use super::candidates::{NotJudged, candidate, candidates};
use super::decision::{self, Rule};
use super::judged::Judged;
use super::learned::LearnedCurve;
use super::needless::{Added, needless};
use super::other_machine;
use super::refit::Model;
use super::report::{Discovery, LadderStep, Step, Unwatched, Verdict, Watch, seen_by};
use super::round::{Formula, Outcome, Round};
use super::spans::{are_possible, spans};
use super::typed;
use super::unusable;
use crate::case::Setting;
use crate::compare::{self, Finding};
use crate::error::Error;
use crate::estimate::{AS_WELL, Evidence, Options};
use crate::observer::Observer;
use crate::signals::SignalFinding;

/// Why no curve is added.
const NO_CURVE: &str = "no torque or voltage over speed, current, position or time alone lowers the \
                        error on the validation data: see what `discover` shows";
/// Why an effect is not added that nobody knows.
const UNKNOWN: &str = "the library has no effect of that name";
/// Why a typed law is not added whose coefficients are not at their null.
const HAS_IT: &str = "the drive has it already, with coefficients that are not 0: `fit` estimates \
                      them";
/// Why an effect is not added with which nothing can be computed.
const OVERFLOWS: &str = "the model overflows with it";
/// Why an effect is not added with which no fit ends.
const NO_FIT: &str = "no fit with it ends";
/// Why nothing is named where the validation recordings contradict the others more than that explains.
const OUTDONE: &str = "other values of the base explain more of the validation data";
/// The same where most of the torque stays unexplained.
const LEAVES_MOST: &str = "most of the torque stays unexplained with it";
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
        return Ok(Discovery { signals: wrong, ..search(other, begun) });
    }
    let found = search(model.clone(), begun);
    // Where no name comes of it, or none that explains torque, what is missing is asked once more beside
    // the base that explains most, and the answer that leaves less of it counts.
    let convinces = found.verdict == Verdict::Named && explains(&found);
    if convinces || watch.stopped() {
        return Ok(Discovery { signals: wrong, ..found });
    }
    if !observed {
        other = balanced();
    }
    let Some((other, begun)) = other else {
        return Ok(Discovery { signals: wrong, ..found });
    };
    let mut again = search(other, begun);
    if again.verdict == Verdict::None && found.verdict != Verdict::None {
        // Two bases that contradict each other do not say that nothing is missing.
        (again.verdict, again.remaining) = (Verdict::Unknown, Verdict::Unknown);
    }
    let better = left(&again)
        .zip(left(&found))
        .is_some_and(|(again, found)| AS_WELL * again.rms < found.rms);
    Ok(Discovery { signals: wrong, ..if better { again } else { found } })
}

/// Whether a step leaves so much of the applied torque unexplained, in the recordings held out, that it
/// cannot be said of it that nothing is missing: more than there was, and behind an observer, where the
/// torque is what tells, more than a third.
fn explains_little(step: &LadderStep, observer: Observer) -> bool {
    let most = if observer.follows() { 1.0 / 3.0 } else { 1.0 };
    step.validation_unexplained.torque.is_some_and(|it| it.share > most)
}

/// Whether what was named leaves most of the torque unexplained that was, and much: whatever is missing, it
/// is something else. What every machine has is missing all the same.
fn leaves_most(found: &Discovery) -> bool {
    let (Some(first), Some(last)) = (found.ladder.first(), found.ladder.last()) else {
        return false;
    };
    let left = |step: &LadderStep| step.validation_unexplained.torque.map(|it| it.rms * it.rms);
    let most = left(first).zip(left(last)).is_some_and(|(was, is)| is > 0.5 * was);
    let basic = |name: &String| Entry::find(name).is_some_and(|entry| entry.info.basic);
    let special = !found.named.is_empty() && !found.named.iter().any(basic);
    special && most && explains_little(last, found.observer)
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
        let outcome = if round == 0 && watch.compares() {
            let (outcome, fails) = rayon::join(|| turn.run(), || fails(&model, estimation));
            found.fails = fails;
            outcome
        } else {
            turn.run()
        };
        if round == 0 {
            found.not_judged = not;
            found.not_judged.extend(outcome.untold.iter().map(|it| untold(&all[*it])));
            found.not_judged.extend(outcome.imitated.iter().map(|it| imitated(&all[*it])));
            found.not_judged.extend(outcome.overflowing.iter().map(|it| overflowing(&all[*it])));
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
            // What a comparison sees of a motion that an observer follows is the observer's work too.
            let free = !model.setting.observer.follows();
            if round == 0 && found.remaining == Verdict::None && free && !watch.stopped() {
                let convicts = |it: &Finding| convicts(rule, it);
                let contradicted = match watch.compares() {
                    true => found.fails.iter().any(convicts),
                    false => fails(&model, estimation).iter().any(convicts),
                };
                if contradicted {
                    found.remaining = Verdict::Unknown;
                }
            }
            if formulas_fail || missing {
                let mut remainder = model.clone();
                while let Some(it) = (Round { model: &remainder, ..turn }).formulas_instead(&added)
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
        // The minimum of the estimation data may lie where those held out deny it.
        let error = |of: &Model| of.validation.squares.error();
        let still = |it: &Model| error(it) <= error(&model).max(error(&named));
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
    let why = if other_machine::outdoes(&found) {
        Some(OUTDONE)
    } else {
        leaves_most(&found).then_some(LEAVES_MOST)
    };
    if let Some(why) = why {
        found.take_all_back(&base, why);
        model = base;
    }
    found.end(model.fitted.drive, of_user);
    found.verdict = if found.named.is_empty() { found.remaining } else { Verdict::Named };
    found
}

/// Adds one effect that the user chose, whatever speaks for it; `learned` is the curve that
/// describes best what the drive lacks.
///
/// # Errors
/// [`Error::CannotAdd`] if these recordings do not tell it or no fit with it ends, and those of a
/// fit of the base.
pub fn add(
    drive: &Drive,
    kind: &str,
    estimation: &Evidence,
    validation: &Evidence,
    watch: &dyn Watch,
) -> Result<Discovery, Error> {
    let of_user = drive;
    let (drive, typed) = &typed::apart(of_user);
    let (model, mut found) = begin(drive, (estimation, validation), watch)?;
    let seen = |error| seen_by(watch, error);
    let cannot = |reason: String| Error::CannotAdd { effect: kind.to_owned(), reason };
    let spans = spans(&model.fitted.drive, estimation);
    let chosen: Vec<Candidate> = match typed.iter().find(|effect| effect.id == kind) {
        _ if kind == LEARNED => Vec::new(),
        Some(effect) => vec![typed::candidate(effect)],
        None => {
            let has = drive.effects.iter().any(|effect| effect.id == kind);
            let why = if has { HAS_IT } else { UNKNOWN };
            let entry = Entry::find(kind).ok_or_else(|| cannot(why.to_owned()))?;
            if let Some(refusal) = model.fitted.drive.refuses(entry) {
                return Err(cannot(refusal.to_string()));
            }
            vec![candidate(entry, &model.fitted.drive, &spans)]
        }
    };
    let turn = Round {
        rule: &Rule::NAMING,
        model: &model,
        all: &chosen,
        spans: &spans,
        estimation,
        validation,
        watch,
        named: &[],
        formulas: &[],
        randomness: None,
    };
    let ground = turn.ground().ok_or_else(|| cannot(OVERFLOWS.to_owned()))?;
    let weights = turn.weights(&ground).ok_or_else(|| cannot(OVERFLOWS.to_owned()))?;
    let added = if kind == LEARNED {
        let curve = weights.repeating().next().ok_or_else(|| cannot(NO_CURVE.to_owned()))?;
        let with = turn.with_curve(curve).ok_or_else(|| cannot(NO_FIT.to_owned()))?;
        found.learned = Some(LearnedCurve::of(curve, turn.removed(&with), drive, &[]));
        with
    } else {
        let law = weights.laws.first().ok_or_else(|| cannot(OVERFLOWS.to_owned()))?;
        if !law.finite {
            return Err(cannot(OVERFLOWS.to_owned()));
        }
        if law.imitated {
            return Err(cannot(imitated(&chosen[0]).reason));
        }
        turn.added(&ground, law)
            .ok_or_else(|| cannot(NO_FIT.to_owned()))?
            .polished(estimation, validation, &seen)?
    };
    found.named.push(kind.to_owned());
    found.verdict = Verdict::Named;
    found.climb(Some(kind.to_owned()), &added, (estimation, validation), watch);
    found.end(added.fitted.drive, of_user);
    Ok(found)
}

/// Twice the logarithm of the evidence of one effect over the base, fitted, as the loop counts it:
/// what a case is worth whose truth is known, read as a gain in BIC. Nothing gained where no fit with
/// it ends.
///
/// # Errors
/// [`Error::CannotAdd`] for an effect that neither the library has nor the user typed, and those of a
/// fit of the base.
pub fn bic_of(
    drive: &Drive,
    kind: &str,
    estimation: &Evidence,
    validation: &Evidence,
) -> Result<f64, Error> {
    let (drive, typed) = &typed::apart(drive);
    let (model, _) = begin(drive, (estimation, validation), &Unwatched)?;
    let spans = spans(&model.fitted.drive, estimation);
    let all = [match typed.iter().find(|effect| effect.id == kind) {
        Some(effect) => typed::candidate(effect),
        None => {
            let unknown =
                || Error::CannotAdd { effect: kind.to_owned(), reason: UNKNOWN.to_owned() };
            candidate(Entry::find(kind).ok_or_else(unknown)?, &model.fitted.drive, &spans)
        }
    }];
    let turn = Round {
        rule: &Rule::NAMING,
        model: &model,
        all: &all,
        spans: &spans,
        estimation,
        validation,
        watch: &Unwatched,
        named: &[],
        formulas: &[],
        randomness: None,
    };
    let evidence = || {
        let ground = turn.ground()?;
        let weights = turn.weights(&ground)?;
        let laws: Vec<_> = weights.laws.iter().collect();
        turn.at_their_best(&ground, &laws).first().map(|one| 2.0 * one.weighed.evidence)
    };
    Ok(evidence().unwrap_or(0.0))
}

/// The base, fitted to the motion, with the first step of its ladder.
fn begin(
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

/// Whether a comparison of the base shows that something is missing, whatever the library says of it:
/// "nothing" beside a dependence as improbable as a name is asked to be, and of more of the error than
/// formulas that are right in their kind may leave, would contradict it.
fn convicts(rule: &Rule, finding: &Finding) -> bool {
    let asked = rule.evidence - rule.law_odds.ln();
    finding.p_value < (-asked).exp() && finding.share >= rule.formula
}

/// Where the base fails; nothing where its recordings cannot be compared together.
fn fails(model: &Model, estimation: &Evidence) -> Vec<Finding> {
    let options = compare::Options { curves: false, seed: 0 };
    let compared = compare::compare(&model.fitted.drive, estimation, &model.setting, &options);
    compared.map_or_else(|_| Vec::new(), |compared| compared.findings)
}

fn imitated(candidate: &Candidate) -> NotJudged {
    NotJudged {
        effect: candidate.name.clone(),
        reason: "on these recordings it equals other values of the base parameters".to_owned(),
        worth_saying: candidate.is_typed(),
    }
}

fn untold(candidate: &Candidate) -> NotJudged {
    NotJudged {
        effect: candidate.name.clone(),
        reason: "it shows in the motion, and here the torque is judged along the motion that was \
                 measured"
            .to_owned(),
        worth_saying: false,
    }
}

fn overflowing(candidate: &Candidate) -> NotJudged {
    NotJudged {
        effect: candidate.name.clone(),
        reason: "it or its derivative divides by zero or overflows on these recordings".to_owned(),
        worth_saying: true,
    }
}
