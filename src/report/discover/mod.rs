//! What a discovery found, as a page shows it and a report keeps it: cards of missing effects, the
//! ladder of errors, parameters.

mod cards;
mod ladder;
mod parameters;

use drivescope_discovery::compare::Comparison;
use drivescope_discovery::{
    Discovery, Estimate, Formula, LearnedCurve, NextExperiment, Ranked, Verdict,
};
use drivescope_plant::drive::{EffectData, LawData, Motion};
use drivescope_plant::effects::info::Variable;
use drivescope_plant::file::target_key;
use maud::html;

pub(crate) use cards::cards;
pub(crate) use ladder::{Step, ladder};
pub(crate) use parameters::parameters;

use super::compare::{self, Setting};
use super::page::{page, section};

/// What was found to be missing, without what it was found with.
#[derive(Debug, Clone)]
pub(crate) struct Missing {
    /// The answer.
    pub(crate) verdict: Verdict,
    /// The effects that are named.
    pub(crate) named: Vec<String>,
    /// Candidates, best first.
    pub(crate) ranking: Vec<Ranked>,
    /// The curve that describes what nobody knows.
    pub(crate) learned: Option<LearnedCurve>,
    /// Formulas for it, the most probable first.
    pub(crate) formulas: Vec<Formula>,
    /// The named effect in whose place they stand.
    pub(crate) closer_than: Option<String>,
    /// What to record to tell apart what these recordings do not.
    pub(crate) next: Option<NextExperiment>,
    /// The laws that the user typed.
    pub(crate) typed: Vec<OwnLaw>,
    /// What these recordings could not show, and why.
    pub(crate) not_shown: Vec<(String, String)>,
}

/// A law of the drive file, for its card.
#[derive(Debug, Clone)]
pub(crate) struct OwnLaw {
    id: String,
    /// As it stands there.
    text: String,
    fails_over: Vec<Variable>,
}

impl OwnLaw {
    /// Of an effect of a drive that moves so; nothing of one of the library or a curve.
    fn of(effect: &EffectData, motion: Motion) -> Option<Self> {
        let Some(LawData::Typed { target, text }) = &effect.law else { return None };
        let text = format!("{} = {text}", target_key(*target, motion));
        Some(Self { id: effect.id.clone(), text, fails_over: effect.fails_over() })
    }
}

impl Missing {
    /// Of a discovery.
    pub(crate) fn of(found: &Discovery) -> Self {
        let mut ranking = found.ranking.clone();
        let effects = found.drive.effects.iter();
        let not_shown = |(effects, reason): (Vec<&str>, &str)| {
            (effects.join(", ").replace('_', " "), reason.to_owned())
        };
        // Signals that let nothing be judged.
        let unusable = found.signals.iter().filter(|it| it.forbids());
        let unusable = unusable.map(|it| ("anything".to_owned(), it.to_string()));
        // What may be named stands before what was refused, however much that explains.
        ranking.sort_by_key(|one| one.refused.is_some());
        Self {
            verdict: found.verdict,
            named: found.named.clone(),
            ranking,
            learned: found.learned.clone(),
            formulas: found.formulas.clone(),
            closer_than: found.closer_than.clone(),
            next: found.next_experiment.clone(),
            typed: effects.filter_map(|effect| OwnLaw::of(effect, found.drive.motion)).collect(),
            not_shown: unusable.chain(found.not_shown().into_iter().map(not_shown)).collect(),
        }
    }
}

/// What a report of a discovery holds beside what is missing.
pub(crate) struct Found<'a> {
    /// The drive at the end, compared.
    pub(crate) compared: &'a Comparison,
    /// What the comparison rests on.
    pub(crate) setting: &'a Setting,
    /// The drive that the cards speak of, compared: before anything was added.
    pub(crate) before: &'a Comparison,
    /// What was missing in it, if that was asked.
    pub(crate) missing: Option<&'a Missing>,
    /// Motion of the drive.
    pub(crate) motion: Motion,
    /// The ladder.
    pub(crate) steps: &'a [Step],
    /// Parameters of the drive at the end.
    pub(crate) parameters: &'a [Estimate],
}

/// One self-contained HTML page.
pub(crate) fn discover_html(found: &Found<'_>) -> String {
    let title = format!("What the model lacks: {}", found.setting.drive);
    let none = |_: &str| html! {};
    let about =
        html! { "A drive's model compared with recordings of the drive, and what it lacks." };
    let sections = html! {
        @if let Some(missing) = found.missing {
            (section("missing", "What is missing", &cards(missing, &found.before.curves, &none)))
        }
        (section("ladder", "The error, step by step", &ladder(found.motion, found.steps, &|_| html! {})))
        (section("parameters", "Parameters", &parameters(found.parameters, &|it| {
            html! { (super::words::number(it.value)) }
        })))
        (section("after", "The model at the end", &compare::body(found.compared, found.setting)))
    };
    let made = html! {
        "drivescope discover, seed " (found.setting.seed) ". The same files and seed give the \
         same figures."
    };
    page(&title, &about, &sections, &made)
}
