//! What was found to be missing: the answer of `discover` without the recordings that it rests on.

use drivescope_discovery::{
    Discovery, Formula, LadderStep, LearnedCurve, NextExperiment, NotJudged, RandomLoad, Ranked,
    Unfitted, Verdict,
};
use drivescope_plant::drive::{EffectData, LawData, Motion};
use drivescope_plant::effects::info::Variable;
use drivescope_plant::file::target_key;
use drivescope_plant::parameters::NamedParameter;
use drivescope_plant::units::for_motion;
use serde::Serialize;

use super::ladder::{Step, has_errors};
use crate::answer::block::{Block, Fact, TERMINAL};
use crate::report::words::{error, estimated, given, number, significant};

/// Error over its floor from which on it is said what is left.
const ABOVE_FLOOR: f64 = 1.1;
/// Digits of a value that was found.
const DIGITS: i32 = 4;

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Missing {
    pub(super) verdict: Verdict,
    pub(super) named: Vec<String>,
    pub(super) remaining: Verdict,
    pub(super) ranking: Vec<Ranked>,
    /// What was weighed and promised too little for a fit.
    pub(super) unfitted: Vec<Unfitted>,
    pub(super) ladder: Vec<LadderStep>,
    pub(super) not_judged: Vec<NotJudged>,
    pub(super) load: Option<RandomLoad>,
    /// The curve that describes what nobody knows.
    pub(super) learned: Option<LearnedCurve>,
    /// Formulas for it, the most probable first.
    pub(super) formulas: Vec<Formula>,
    /// The named effect in whose place the formulas stand.
    pub(super) closer_than: Option<String>,
    pub(super) next_experiment: Option<NextExperiment>,
    /// What these recordings could not show, and why.
    #[serde(skip)]
    pub(super) not_shown: Vec<(String, String)>,
    /// Signals that let nothing be judged.
    #[serde(skip)]
    pub(super) unusable: Vec<String>,
    /// The laws that the user typed.
    #[serde(skip)]
    pub(super) typed: Vec<OwnLaw>,
    /// What was found, with its values in the drive that is written.
    #[serde(skip)]
    pub(super) values: Vec<(String, String)>,
    #[serde(skip)]
    pub(super) motion: Motion,
    /// Whether the effects were asked for, and not whether any is missing.
    #[serde(skip)]
    pub(super) added: bool,
}

/// A law of the drive file, for its card.
#[derive(Debug, Clone)]
pub(super) struct OwnLaw {
    pub(super) id: String,
    /// As it stands there.
    pub(super) text: String,
    pub(super) fails_over: Vec<Variable>,
}

impl OwnLaw {
    /// Of an effect of a drive that moves so; nothing of one of the library or a curve.
    fn of(effect: &EffectData, motion: Motion) -> Option<Self> {
        let Some(LawData::Typed { target, text }) = &effect.law else { return None };
        let text = format!("{} = {text}", target_key(*target, motion));
        Some(Self { id: effect.id.clone(), text, fails_over: effect.fails_over() })
    }
}

/// An effect that was found with its parameters, and their standard errors where they were fitted; a
/// curve has a picture.
fn values(found: &Discovery, id: &str) -> Option<(String, String)> {
    let ranked = found.ranking.iter().find(|it| it.effect == id && it.refused.is_none());
    let effect = found.drive.effects.iter().find(|it| it.kind == id || it.id == id)?;
    if matches!(effect.law, Some(LawData::Learned { .. })) {
        return None;
    }
    let own = format!("{}.", effect.id);
    let value = |it: NamedParameter| {
        let name = it.name.strip_prefix(&own)?;
        let fitted = ranked.and_then(|ranked| ranked.parameters.get(&it.name));
        let error = fitted.map_or(f64::NAN, |fitted| fitted.std_error);
        let is_whole = it.value.fract() == 0.0;
        let value = if is_whole { given(it.value) } else { significant(it.value, DIGITS) };
        Some(format!("{name} = {}", estimated(&value, error, &it.unit)))
    };
    let all: Vec<String> = found.drive.parameters().into_iter().filter_map(value).collect();
    Some((id.to_owned(), all.join(", ")))
}

impl Missing {
    /// Of a discovery; or of the addition of an effect that the user wished.
    pub(crate) fn of(found: &Discovery, added: bool) -> Self {
        let motion = found.drive.motion;
        let effects = found.drive.effects.iter();
        let not_shown = found.not_shown().into_iter();
        let unusable = found.signals.iter().filter(|it| it.forbids());
        Self {
            verdict: found.verdict,
            named: found.named.clone(),
            remaining: found.remaining,
            ranking: found.ranking.clone(),
            unfitted: found.unfitted.clone(),
            ladder: found.ladder.clone(),
            not_judged: found.not_judged.clone(),
            load: found.load,
            learned: found.learned.clone(),
            formulas: found.formulas.clone(),
            closer_than: found.closer_than.clone(),
            next_experiment: found.next_experiment.clone(),
            not_shown: not_shown
                .map(|(effects, reason)| (effects.join(", "), reason.to_owned()))
                .collect(),
            unusable: unusable.map(ToString::to_string).collect(),
            typed: effects.filter_map(|effect| OwnLaw::of(effect, motion)).collect(),
            values: found.named.iter().filter_map(|id| values(found, id)).collect(),
            motion,
            added,
        }
    }

    /// The answer in a sentence.
    pub(super) fn verdict_in_words(&self, about: &str) -> Block {
        let words = match self.verdict {
            Verdict::Named => {
                let remainder = match self.remaining {
                    Verdict::Unknown => "; something is left that no known effect explains",
                    _ => "",
                };
                let sets: Vec<String> = self.named.iter().map(|id| self.with_set(id)).collect();
                let are = if self.added { "added" } else { "missing" };
                format!("{are}: {}{remainder}", sets.join(", "))
            }
            Verdict::None => "nothing is missing that these recordings could show".to_owned(),
            Verdict::Unknown => "something is missing, and it is none of the effects that the \
                                 library knows"
                .to_owned(),
            Verdict::NotJudged => "not judged: the signals of the recordings do not allow it, and \
                                   no drive is written"
                .to_owned(),
        };
        Block::Verdict { about: about.to_owned(), words, remark: String::new() }
    }

    /// The values of what was found.
    pub(super) fn values(&self) -> Block {
        let fact = |(id, values): &(String, String)| Fact::new(TERMINAL, id, values);
        Block::Facts(self.values.iter().map(fact).collect())
    }

    fn with_set(&self, id: &str) -> String {
        let set = self.ranking.iter().find(|it| it.effect == *id && it.refused.is_none());
        match set.map(|it| it.confusion_set.join(" or ")) {
            Some(others) if !others.is_empty() => {
                format!("{id} (not told from {others} by these recordings)")
            }
            _ => id.to_owned(),
        }
    }

    /// What is left, and what would tell more.
    pub(super) fn what_is_left(&self) -> Vec<Block> {
        let unit = for_motion(self.motion, "N m");
        let oscillates = self.load.and_then(|load| load.oscillation).map(|it| {
            format!("the load oscillates at {:.2} Hz ({} {unit} rms)", it.hz, number(it.sd))
        });
        let next = self.next_experiment.as_ref().map(|next| {
            format!("to tell {} apart, record {}", next.separates.join(" and "), next.description)
        });
        [self.left_to_a_load(), oscillates, next].into_iter().flatten().map(Block::Note).collect()
    }

    /// What an error above its floor is taken for, where nothing is said to be left.
    fn left_to_a_load(&self) -> Option<String> {
        let (load, last) = self.load.zip(self.ladder.last())?;
        let remainder = last.error.max(last.validation_error);
        let said = self.remaining != Verdict::None || self.closer_than.is_some();
        if said || !has_errors(self.motion, &[Step::from(last)]) || remainder < ABOVE_FLOOR {
            return None;
        }
        let (remainder, sd) = (error(remainder), number(load.sd));
        let (time, unit) = (significant(load.time, 2), for_motion(self.motion, "N m"));
        let beside = if load.oscillation.is_some() { " beside its oscillation" } else { "" };
        Some(format!(
            "the error that is left, {remainder} times its floor, is taken for a random load of {sd} \
             {unit} rms that lasts {time} s{beside}"
        ))
    }
}
