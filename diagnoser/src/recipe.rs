//! From healthy recordings alone to a whole diagnoser: every model of Section 2, in one order.
//!
//! ```text
//!  excited[0] ──> process model (1), (5), its starts judged on excited[1]
//!  healthy[0] ──> error models (6), (7) of its residual
//!  healthy[1] ──> width of bands, constant thresholds
//!  healthy    ──> windows of the residual against a baseline
//!  all four   ──> operating range; GMDH network: estimated on the first of each, judged on the second;
//!                 parameters bounded on healthy[0] and excited[1]
//! ```
//!
//! The width of a band is only as good as the number of independent samples behind it: a residual
//! that is correlated over 50 samples needs some 100,000 for an exceedance rate within a tenth of
//! its nominal 5 %. So the second healthy recording should be long.

use std::ops::Range;

use drivescope_numerics::Limits;
use thiserror::Error;

use crate::arx::longest_run_up;
use crate::data::Data;
use crate::design::{Design, DesignError, DesignReport};
use crate::diagnoser::Diagnoser;
use crate::gmdh::{
    BoundOptions, Gmdh, GmdhError, GmdhOptions, GmdhReport, RobustError, RobustGmdh,
};
use crate::interface::Interface;
use crate::model::Model;
use crate::model_error::BandDesign;
use crate::network::{
    Method, Selection, Structure, Trained, Training, TrainingError, longest_memory,
    select_structure, train,
};
use crate::range::OperatingRange;
use crate::signal_model::Start;
use crate::windows::{BASELINE_S, WINDOW_S, Windows};

/// Healthy recordings, by what they are for.
#[derive(Debug, Clone)]
pub struct Sets<'a> {
    /// Runs in which the input goes through its range: to estimate models on, and to judge them.
    pub excited: [Data<'a>; 2],
    /// Runs of the kind that will be watched: to fit error models on, and, better longer, to
    /// measure widths on.
    pub healthy: [Data<'a>; 2],
}

/// What is trained and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// Sizes of the process model.
    pub structure: Structure,
    pub training: Training,
    /// Error model, bands and decision.
    pub design: Design,
    /// A second, recurrent error model.
    pub recurrent_error: Option<(Structure, Training)>,
    /// A GMDH network and the bounds of its parameters.
    pub gmdh: Option<(GmdhOptions, BoundOptions)>,
}

/// Samples of a healthy run that a GMDH network is synthesised on, and that its parameters are
/// bounded on, beyond the run-up: more add time, not knowledge.
const SYNTHESIS: usize = 2000;
const BOUNDED: usize = 4000;
/// Starts of every candidate of a choice of sizes, and their steps.
const STARTS: usize = 2;
const STEPS: usize = 60;

impl Recipe {
    /// The paper's sizes and orders; beside its ARX error model a recurrent one, and a GMDH network.
    ///
    /// From rest networks settle within the run-up by construction: what outlasted it would not have
    /// settled when it is judged, and a time constant that a healthy run hardly excites is a guess,
    /// on which a fault is carried away. Runs that begin in the steady state have
    /// [`Recipe::settling_within`].
    pub fn paper(inputs: usize, design: Design, seed: u64) -> Self {
        let memory = (design.start == Start::Rest).then(|| longest_memory(design.run_up));
        let structure = Structure { inputs, memory, ..Structure::PAPER };
        // From a steady state what a detector does not judge is not learned either.
        let run_up = match design.start {
            Start::Rest => Training::default().run_up,
            Start::Steady => design.run_up,
        };
        let training = Training { seed, run_up, start: design.start, ..Training::default() };
        let error = Structure { v1: 2, v2: 1, ..structure };
        // Settled residuals go on from where they are: from rest they need no run-up of their own.
        let run_up = if design.start == Start::Rest { 0 } else { run_up };
        let error_training = Training { starts: 3, run_up, ..training };
        let bounds =
            BoundOptions { inflation: 1.2, run_up: design.run_up, ..BoundOptions::default() };
        Self {
            structure,
            training,
            design,
            recurrent_error: Some((error, error_training)),
            gmdh: Some((GmdhOptions { survivors: 4, ..GmdhOptions::default() }, bounds)),
        }
    }
}

impl Recipe {
    /// The same with networks that settle, from a steady state, in half of each of the recordings: what
    /// remembers for longer cannot be told from a drift, and its run-up would leave nothing to judge.
    #[must_use]
    pub fn settling_within(mut self, sets: &Sets) -> Self {
        if self.design.start == Start::Steady {
            let [a, b] = &sets.excited;
            let [c, d] = &sets.healthy;
            let memory = Some(longest_memory(longest_run_up(&[a, b, c, d])));
            self.structure.memory = memory;
            self.recurrent_error.iter_mut().for_each(|(sizes, _)| sizes.memory = memory);
        }
        self
    }

    /// Sizes of a process model with the memory of this one's, compared by AIC over the excited runs;
    /// the one to use follows the first healthy run as well as the best.
    ///
    /// # Errors
    /// [`TrainingError`]
    pub fn compare_sizes(&self, sets: &Sets) -> Result<Selection, TrainingError> {
        let limits = Limits { steps: STEPS, relative_decrease: 1e-6 };
        let method = Method::LevenbergMarquardt(limits);
        let training = Training { method, starts: STARTS, ..self.training };
        let Structure { inputs, memory, .. } = self.structure;
        let grid = Structure::grid(inputs, 1).into_iter();
        let grid: Vec<_> = grid.map(|sizes| Structure { memory, ..sizes }).collect();
        let healthy = (&sets.healthy[0], self.design.run_up);
        select_structure(&grid, sets.excited.each_ref(), healthy, &training)
    }
}

/// A diagnoser and what was found on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    pub diagnoser: Diagnoser,
    /// Its process model.
    pub process: Trained,
    /// Bands of the error model.
    pub design: DesignReport,
    /// Bands of the recurrent error model.
    pub recurrent_error: Option<BandDesign>,
    /// The synthesis of the GMDH network.
    pub gmdh: Option<GmdhReport>,
}

/// Why there is no diagnoser.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RecipeError {
    /// The process model cannot be trained.
    #[error("process model: {0}")]
    Process(#[from] TrainingError),
    /// The error models cannot be fitted.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// The GMDH network cannot be synthesised.
    #[error(transparent)]
    Gmdh(#[from] GmdhError),
    /// Its parameters cannot be bounded.
    #[error("bounds of the GMDH network: {0}")]
    Bounds(#[from] RobustError),
}

impl Diagnoser {
    /// Trains all models of a recipe.
    pub fn learn(
        interface: Interface,
        sets: &Sets,
        recipe: &Recipe,
    ) -> Result<Learned, RecipeError> {
        let [estimation, validation] = &sets.excited;
        let process = train(recipe.structure, estimation, validation, &recipe.training)?;
        Self::learn_around(interface, process, sets, recipe)
    }

    /// Trains all models of a recipe but the process model, which is given.
    pub fn learn_around<'a>(
        interface: Interface,
        process: Trained,
        sets: &Sets<'a>,
        recipe: &Recipe,
    ) -> Result<Learned, RecipeError> {
        let Sets { excited, healthy } = sets;
        let model = Model::Network(process.network.clone());
        let (mut diagnoser, design) =
            Self::design(interface, model, &healthy[0], &healthy[1], &recipe.design)?;
        let mut recurrent_error = None;
        if let Some((structure, training)) = &recipe.recurrent_error {
            let how = (training, recipe.design.start);
            let (with, bands) =
                diagnoser.with_recurrent_error(&healthy[0], &healthy[1], *structure, how)?;
            (diagnoser, recurrent_error) = (with, Some(bands));
        }
        let mut gmdh = None;
        if let Some((options, bounds)) = &recipe.gmdh {
            let part = |data: &Data<'_>, samples: usize| -> Range<usize> {
                0..data.len().min(recipe.design.run_up + samples)
            };
            let long = options.run_up.max(bounds.run_up).max(bounds.excited_run_up);
            let parts = |data: &Data<'a>| long_parts(data, long);
            let set = |k: usize| {
                let healthy = healthy[k].span(part(&healthy[k], SYNTHESIS));
                [parts(&excited[k]), parts(&healthy)].concat()
            };
            let (network, report) = Gmdh::synthesise(&set(0), &set(1), options)?;
            let watched = parts(&healthy[0].span(part(&healthy[0], BOUNDED)));
            let known = parts(&excited[1]);
            let robust = RobustGmdh::design(&network, &watched, &known, bounds)?;
            (diagnoser, gmdh) = (diagnoser.with_gmdh(robust)?, Some(report));
        }
        let samples = |seconds: f64| (seconds / diagnoser.interface.period_s).round() as usize;
        let lengths = (samples(WINDOW_S).max(2), samples(BASELINE_S).max(2));
        diagnoser.windows = Windows::design(&[&healthy[0], &healthy[1]], lengths);
        let settled = excited.iter().chain(healthy).map(|data| data.settled(diagnoser.run_up));
        let settled: Vec<Data> = settled.collect();
        diagnoser.range = OperatingRange::of(&settled.iter().collect::<Vec<_>>(), diagnoser.window);
        Ok(Learned { diagnoser, process, design, recurrent_error, gmdh })
    }
}

/// The segments of more than `run_up` samples; the whole, to be refused by its number of samples,
/// where there is none.
fn long_parts<'a>(data: &Data<'a>, run_up: usize) -> Vec<Data<'a>> {
    let parts = data.parts(run_up);
    if parts.is_empty() { vec![data.clone()] } else { parts }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::data;
    use crate::detectors::DetectorKind;
    use crate::interface::Channel;
    use crate::testing::{PERIOD, Run, closed_loop, multisine};
    use crate::threshold::Confidence;

    #[test]
    fn every_threshold_of_a_learned_diagnoser_tells_a_fault_from_health() {
        let (open, closed) = (
            [multisine(1000, 1), multisine(1000, 2)],
            [closed_loop(4000, 3, usize::MAX, 0.0), closed_loop(20_000, 4, usize::MAX, 0.0)],
        );
        let interface = Interface {
            period_s: PERIOD,
            inputs: vec![Channel::new("C_m", "V")],
            output: Channel::new("T", "rpm"),
        };
        let sets =
            Sets { excited: open.each_ref().map(data), healthy: closed.each_ref().map(data) };
        let recipe = Recipe::paper(1, Design::paper(Confidence::new(0.05).unwrap()), 1);
        let Learned { diagnoser, recurrent_error, gmdh, .. } =
            Diagnoser::learn(interface, &sets, &recipe).unwrap();
        assert!(recurrent_error.is_some() && gmdh.unwrap().kept >= 2);
        let (faulty, healthy) =
            (closed_loop(5000, 5, 4000, 0.05), closed_loop(5000, 6, usize::MAX, 0.0));
        for kind in DetectorKind::ALL {
            let run = |run: &Run| diagnoser.detector(kind).unwrap().run(&data(run)).unwrap();
            let r_td = run(&faulty).exceedance_rate(4000..5000).unwrap();
            assert!(r_td > 0.97, "{kind:?}: r_td {r_td}");
            let health = run(&healthy);
            assert!(health.declarations().is_empty(), "{kind:?}");
            assert!(health.exceedance_rate(500..5000).unwrap() < 0.12, "{kind:?}");
        }
    }
}
