//! What a discovery answers: its JSON, the same as text, and the drive file with what was found.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use drivescope_discovery::compare::Finding;
use drivescope_discovery::signals::SignalFinding;
use drivescope_discovery::{
    BothUnexplained, Discovery, Formula, LearnedCurve, NextExperiment, NoiseSource, NotJudged,
    OutputFits, RandomLoad, Ranked, Rung, Verdict,
};
use drivescope_plant::drive::{Drive, Motion};
use drivescope_plant::units::for_motion;
use serde::Serialize;

use super::watch::{has_errors, line};
use crate::evidence::Gathered;
use crate::formula_text::{self, PREFIX};
use crate::read_evidence::unusable;
use crate::report::words::{probability, significant};

/// Formulas that are shown.
const SHOWN: usize = 3;

/// Error over its floor from which on it is said what is left.
const ABOVE_FLOOR: f64 = 1.1;

/// Errors of a drive.
#[derive(Debug, Clone, Serialize)]
struct Errors {
    error: f64,
    validation_error: f64,
    unexplained: BothUnexplained,
    validation_unexplained: BothUnexplained,
    fit_percent: OutputFits,
    validation_fit_percent: OutputFits,
}

impl Errors {
    fn of(rung: &Rung) -> Self {
        Self {
            error: rung.error,
            validation_error: rung.validation_error,
            unexplained: rung.unexplained,
            validation_unexplained: rung.validation_unexplained,
            fit_percent: rung.fit_percent.clone(),
            validation_fit_percent: rung.validation_fit_percent.clone(),
        }
    }
}

/// Noise of one recording: standard deviations by output, and where they come from.
#[derive(Debug, Clone, Serialize)]
struct NoiseOf {
    #[serde(flatten)]
    sd: BTreeMap<&'static str, f64>,
    source: NoiseSource,
}

/// The answer of `discover`.
#[derive(Debug, Serialize)]
pub(super) struct Answer {
    drive: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<PathBuf>,
    /// What is wrong with the signals of the recordings, the gravest first.
    signals: Vec<SignalFinding>,
    /// Nothing where nothing could be judged.
    before: Option<Errors>,
    after: Option<Errors>,
    noise: NoiseOf,
    #[serde(rename = "where")]
    fails: Vec<Finding>,
    verdict: Verdict,
    named: Vec<String>,
    remaining: Verdict,
    ranking: Vec<Ranked>,
    ladder: Vec<Rung>,
    not_judged: Vec<NotJudged>,
    load: Option<RandomLoad>,
    learned: Option<LearnedCurve>,
    formulas: Vec<Formula>,
    /// The named effect in whose place the formulas stand.
    closer_than: Option<String>,
    next_experiment: Option<NextExperiment>,
    observer_hz: f64,
    split: String,
    doubts: Vec<String>,
    /// Doubts that the readers of the recordings have not been told yet.
    #[serde(skip)]
    new_doubts: Vec<String>,
    /// What these recordings could not show, in lines.
    #[serde(skip)]
    not_shown: Vec<String>,
    /// What the effects in `named` are: missing, or added as the user wished.
    #[serde(skip)]
    named_are: &'static str,
    #[serde(skip)]
    motion: Motion,
    seed: u64,
}

impl Answer {
    pub(super) fn new(
        base: &Drive,
        output: Option<PathBuf>,
        gathered: &Gathered,
        found: &Discovery,
        named_are: &'static str,
        seed: u64,
    ) -> Self {
        let new_doubts: Vec<String> = found.doubts.iter().map(ToString::to_string).collect();
        let first = &gathered.noise[0];
        let given = first.iter().all(|it| it.source == NoiseSource::Given);
        let source = if given { NoiseSource::Given } else { NoiseSource::Estimated };
        let mut signals = gathered.signals.clone();
        signals.extend(found.signals.iter().filter(|it| !gathered.signals.contains(it)).cloned());
        signals.sort_by_key(|it| it.consequence);
        Self {
            drive: base.name.clone(),
            output,
            signals,
            before: found.ladder.first().map(Errors::of),
            after: found.ladder.last().map(Errors::of),
            noise: NoiseOf { sd: first.iter().map(|it| (it.name, it.sd)).collect(), source },
            fails: found.fails.clone(),
            verdict: found.verdict,
            named: found.named.clone(),
            remaining: found.remaining,
            ranking: found.ranking.clone(),
            ladder: found.ladder.clone(),
            not_judged: found.not_judged.clone(),
            not_shown: found.not_shown().into_iter().map(not_shown).collect(),
            load: found.load,
            learned: found.learned.clone(),
            formulas: found.formulas.clone(),
            closer_than: found.closer_than.clone(),
            next_experiment: found.next_experiment.clone(),
            observer_hz: found.observer.hz,
            split: gathered.split.clone(),
            doubts: gathered.doubts.iter().chain(&new_doubts).cloned().collect(),
            new_doubts,
            named_are,
            motion: base.motion,
            seed,
        }
    }

    /// The answer for a person.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let name = if self.drive.is_empty() { "the drive" } else { &self.drive };
        if self.verdict == Verdict::NotJudged {
            let _ = writeln!(text, "{name}: not judged, and no drive is written");
            for it in self.signals.iter().filter(|it| it.forbids()) {
                let _ = writeln!(text, "  {it}");
            }
            return text;
        }
        text += &unusable(&self.signals);
        let _ = writeln!(text, "{name}: {}", self.split);
        let how = match self.observer_hz {
            0.0 => "free run from u".to_owned(),
            hz => format!("observer of {hz} Hz, frozen"),
        };
        let unit = match self.ladder.iter().any(has_errors) {
            true => "; errors in units of the noise, floor 1",
            false => "",
        };
        let _ = writeln!(text, "{how}{unit}");
        for doubt in &self.new_doubts {
            let _ = writeln!(text, "{doubt}");
        }
        for one in &self.fails {
            let share = 100.0 * one.share;
            let _ = writeln!(text, "fails over {}: {} ({share:.0} %)", one.variable, one.words);
        }
        text.push('\n');
        for rung in &self.ladder {
            let _ = writeln!(text, "  {}", line(rung, self.motion));
        }
        text.push('\n');
        for one in &self.ranking {
            let _ = writeln!(text, "  {}", ranked(one));
        }
        for line in &self.not_shown {
            let _ = writeln!(text, "  {line}");
        }
        text.push('\n');
        text += &self.verdict_in_words();
        if let Some(learned) = &self.learned {
            text += &curve(learned);
        }
        text += &proposals(&self.formulas, self.closer_than.as_deref());
        if let Some(left) = self.left_to_a_load() {
            let _ = writeln!(text, "{left}");
        }
        if let Some(it) = self.load.and_then(|load| load.oscillation) {
            let sd = significant(it.sd, 3);
            let unit = for_motion(self.motion, "N m");
            let _ = writeln!(text, "the load oscillates at {:.2} Hz ({sd} {unit} rms)", it.hz);
        }
        if let Some(next) = &self.next_experiment {
            let _ = writeln!(
                text,
                "to tell {} apart, record {}",
                next.separates.join(" and "),
                next.description
            );
        }
        if let Some(path) = &self.output {
            let _ = writeln!(text, "written: {}", path.display());
        }
        text
    }

    /// What an error above its floor is taken for, where nothing is said to be left.
    fn left_to_a_load(&self) -> Option<String> {
        let (load, last) = self.load.zip(self.ladder.last())?;
        let error = last.error.max(last.validation_error);
        let said = self.remaining != Verdict::None || self.closer_than.is_some();
        if said || !has_errors(last) || error < ABOVE_FLOOR {
            return None;
        }
        let (error, sd) = (significant(error, 3), significant(load.sd, 3));
        let (time, unit) = (significant(load.time, 2), for_motion(self.motion, "N m"));
        let beside = if load.oscillation.is_some() { " beside its oscillation" } else { "" };
        Some(format!(
            "the error that is left, {error} times its floor, is taken for a random load of {sd} \
             {unit} rms that lasts {time} s{beside}"
        ))
    }

    fn verdict_in_words(&self) -> String {
        let left = match self.remaining {
            Verdict::Unknown => "; something is left that no known effect explains",
            _ => "",
        };
        match self.verdict {
            Verdict::Named => {
                let sets: Vec<String> = self.named.iter().map(|id| self.with_set(id)).collect();
                format!("{}: {}{left}\n", self.named_are, sets.join(", "))
            }
            Verdict::None => "nothing is missing that these recordings could show\n".to_owned(),
            Verdict::Unknown => {
                "something is missing, and it is none of the effects that the library knows\n"
                    .to_owned()
            }
            Verdict::NotJudged => "not judged\n".to_owned(),
        }
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
}

/// A learned curve in words.
fn curve(learned: &LearnedCurve) -> String {
    let LearnedCurve { over, over_unit, times, unit, excess_removed, addable, .. } = learned;
    let of = |unit: &str| if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    let balance = format!("{:?}", learned.balance).to_lowercase();
    let times = times.map_or(String::new(), |times| format!(", times {times}"));
    let does = if *addable {
        format!("removes {:.0} % of the excess", 100.0 * excess_removed)
    } else {
        "shows it; no effect of the drive file can hold that curve".to_owned()
    };
    let (of_over, of_value) = (of(over_unit), of(unit));
    let mut text =
        format!("a curve over {over}{of_over}{times} in the {balance}{of_value} {does}\n");
    for (knot, value) in learned.knots.iter().zip(&learned.values) {
        let _ = writeln!(text, "  {knot:>12.4} {:>12}", significant(*value, 5));
    }
    text
}

/// Formulas in words, and how one is added.
fn proposals(formulas: &[Formula], closer_than: Option<&str>) -> String {
    let Some(best) = formulas.first() else { return String::new() };
    let for_what = closer_than.map_or_else(
        || "formulas for it".to_owned(),
        |named| format!("formulas in the place of {named}, which describe it closer"),
    );
    let mut text = format!("{for_what}, the most probable first:\n");
    for it in formulas.iter().take(SHOWN) {
        let values: Vec<String> = it
            .parameters
            .iter()
            .map(|(name, value)| format!("{name} = {}", significant(*value, 4)))
            .collect();
        let _ = writeln!(
            text,
            "  {:<44} probability {:<8} evidence {:<8} complexity {:<3} {}",
            formula_text::law(it),
            probability(it.probability),
            significant(it.evidence, 4),
            it.complexity,
            values.join(", ")
        );
    }
    let _ = writeln!(
        text,
        "to add one: drivescope add DRIVE \"{PREFIX}{}\" REC... -o FILE",
        formula_text::text(best)
    );
    text
}

fn not_shown((effects, reason): (Vec<&str>, &str)) -> String {
    format!("{:<20} not judged: {reason}", effects.join(", "))
}

fn ranked(one: &Ranked) -> String {
    let why = one.refused.as_deref().map_or(String::new(), |why| format!("   not named: {why}"));
    format!(
        "{:<20} probability {:<8} {:>5.1} % of the balance   removes {:>5.1} %{why}",
        one.effect,
        probability(one.probability),
        100.0 * one.size,
        100.0 * one.excess_removed
    )
}
