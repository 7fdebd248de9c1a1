//! What a discovery answers, or the addition of one effect.

mod blocks;
mod cards;
mod ladder;
mod missing;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::PathBuf;

use drivescope_discovery::compare::Finding;
use drivescope_discovery::signals::SignalFinding;
use drivescope_discovery::{
    BothUnexplained, Discovery, LadderStep, NoiseSource, OutputFits, Verdict,
};
use drivescope_plant::drive::Drive;
use serde::Serialize;

pub(crate) use ladder::{Step, ladder, table};
pub(crate) use missing::Missing;

use super::block::{Block, Fact, TERMINAL};
use super::compare::where_it_fails;
use super::{named, run, unusable};
use crate::evidence::Gathered;

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
    fn of(step: &LadderStep) -> Self {
        Self {
            error: step.error,
            validation_error: step.validation_error,
            unexplained: step.unexplained,
            validation_unexplained: step.validation_unexplained,
            fit_percent: step.fit_percent.clone(),
            validation_fit_percent: step.validation_fit_percent.clone(),
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

/// The answer of `discover` and `add`.
#[derive(Debug, Serialize)]
pub(crate) struct DiscoverAnswer {
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
    #[serde(flatten)]
    missing: Missing,
    observer_hz: f64,
    split: String,
    doubts: Vec<String>,
    /// Doubts that the readers of the recordings have not been told yet.
    #[serde(skip)]
    new_doubts: Vec<String>,
    seed: u64,
}

impl DiscoverAnswer {
    pub(crate) fn new(
        base: &Drive,
        output: Option<PathBuf>,
        gathered: &Gathered,
        (found, missing): (&Discovery, Missing),
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
            missing,
            observer_hz: found.observer.hz,
            split: gathered.split.clone(),
            doubts: gathered.doubts.iter().chain(&new_doubts).cloned().collect(),
            new_doubts,
            seed,
        }
    }

    /// The answer for a terminal: the verdict where the eye is when the program ends.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        let name = named(&self.drive);
        let mut blocks = unusable(&self.signals);
        if self.missing.verdict == Verdict::NotJudged {
            blocks.insert(0, self.missing.verdict_in_words(&name));
            return blocks;
        }
        blocks.push(Block::Sentence(format!("{name}: {}", self.split)));
        blocks.push(Block::Facts(vec![run(self.observer_hz)]));
        blocks.extend(self.new_doubts.iter().map(|doubt| Block::Alert(doubt.clone())));
        blocks.push(where_it_fails(&self.fails, self.missing.motion));
        let steps: Vec<Step> = self.missing.ladder.iter().map(Step::from).collect();
        blocks.extend(ladder(self.missing.motion, &steps));
        blocks.extend(self.missing.candidates(&[]));
        blocks.push(self.missing.verdict_in_words(""));
        blocks.push(self.missing.values());
        blocks.extend(self.missing.what_is_left());
        blocks.extend(self.output.as_ref().map(|path| {
            Block::Facts(vec![Fact::new(TERMINAL, "written", path.display().to_string())])
        }));
        blocks
    }
}
