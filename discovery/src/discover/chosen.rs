//! One effect that the user, or a benchmark, chose: added or weighed, whatever speaks for it.

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::grid::Spans;
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::file::LEARNED;

use super::candidate::Candidate;
use super::candidates::candidate;
use super::decision::Rule;
use super::ladder::begin;
use super::learned::LearnedCurve;
use super::not_judged::NotJudged;
use super::refit::Model;
use super::report::{Discovery, Unwatched, Verdict, Watch, seen_by};
use super::round::Round;
use super::spans::spans;
use super::typed;
use crate::error::Error;
use crate::estimate::Evidence;

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
    let turn = first_round(&model, (&chosen, &spans), (estimation, validation), watch);
    let ground = turn.ground().ok_or_else(|| cannot(OVERFLOWS.to_owned()))?;
    if let Some(untold) = chosen.iter().find(|it| !ground.tells(it)) {
        return Err(cannot(NotJudged::untold(untold).reason));
    }
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
            return Err(cannot(NotJudged::imitated(&chosen[0]).reason));
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
    let turn = first_round(&model, (&all, &spans), (estimation, validation), &Unwatched);
    let evidence = || {
        let ground = turn.ground()?;
        let weights = turn.weights(&ground)?;
        let laws: Vec<_> = weights.laws.iter().collect();
        turn.at_their_best(&ground, &laws).first().map(|one| 2.0 * one.weighed.evidence)
    };
    Ok(evidence().unwrap_or(0.0))
}

/// The first round beside a base, of those candidates alone.
fn first_round<'a>(
    model: &'a Model,
    (all, spans): (&'a [Candidate], &'a Spans),
    (estimation, validation): (&'a Evidence, &'a Evidence),
    watch: &'a dyn Watch,
) -> Round<'a> {
    Round {
        rule: &Rule::NAMING,
        model,
        all,
        spans,
        estimation,
        validation,
        watch,
        named: &[],
        formulas: &[],
        randomness: None,
    }
}
