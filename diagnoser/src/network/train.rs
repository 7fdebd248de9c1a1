//! Training in free run: several starts in parallel, the best on held-out data is kept.
//!
//! The error is that of the free run, not of a one-step prediction: it is what residuals are made
//! of. Every start and every search draws from its own random stream, numbered by its index, so
//! that a seed gives the same network on any number of threads.

use std::sync::Arc;

use drivescope_numerics::{Limits, Residuals, aic, minimise};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use thiserror::Error;

use super::free_run_error::{FreeRunError, Standardised, rows};
use super::{Network, Structure, Theta, ars};
use crate::arx::{WORTH, leaves_half};
use crate::data::{Column, Data, DataError};
use crate::model::SETTLED_AFTER;
use crate::scale::Scale;
use crate::signal_model::{Start, residual};
use crate::threshold::mean_and_deviation;

/// Step between the streams of neighbouring starts: the PCG stream is the odd part of it.
const STREAM: u128 = 2;

/// How the error is lowered from a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Levenberg-Marquardt with exact sensitivities.
    LevenbergMarquardt(Limits),
    /// Adaptive Random Search, the paper's, with this many outer steps (the paper: 100).
    AdaptiveRandomSearch {
        /// Outer steps of 328 trials each.
        outer: usize,
    },
}

/// How a network is trained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Training {
    /// How the error is lowered.
    pub method: Method,
    /// Random starts.
    pub starts: usize,
    /// Seed of all randomness.
    pub seed: u64,
    /// Samples at the start of every segment that only settle the state. From a steady state they are
    /// counted where they are more than half of the data.
    pub run_up: usize,
    /// Where runs begin.
    pub start: Start,
}

impl Default for Training {
    fn default() -> Self {
        let method = Method::LevenbergMarquardt(Limits { steps: 150, relative_decrease: 1e-7 });
        Self { method, starts: 8, seed: 0, run_up: 100, start: Start::Rest }
    }
}

impl Training {
    /// Samples at the start of every segment that are not counted. A machine may have been found running
    /// or starting up: no steady state leads to what it does then, and a network that is to follow it
    /// is bent everywhere else.
    fn uncounted(&self, data: &Data) -> usize {
        let counts = self.start == Start::Steady && !leaves_half(data, self.run_up);
        if counts { 0 } else { self.run_up }
    }

    /// Samples of the first inputs that are held before every segment.
    fn held(&self) -> usize {
        /// Where nothing is left to settle.
        const LEAST: usize = 100;
        match self.start {
            Start::Rest => 0,
            Start::Steady => self.run_up.max(LEAST),
        }
    }

    /// The same sizes with a memory that settles within the run-up, if theirs is longer, and samples in
    /// which that one settles.
    fn settling_soon(&self, structure: Structure) -> Option<(Structure, usize)> {
        let memory = longest_memory(self.run_up);
        let longer = structure.memory.filter(|longest| *longest > memory);
        let longer = longer.filter(|_| self.start == Start::Steady)?;
        let settling = (SETTLED_AFTER * longer as f64).ceil() as usize;
        Some((Structure { memory: Some(memory), ..structure }, settling))
    }
}

/// The longest memory of a network that settles in so many samples.
pub(crate) fn longest_memory(samples: usize) -> usize {
    /// Samples that any network may remember.
    const LEAST: usize = 10;
    ((samples as f64 / SETTLED_AFTER) as usize).max(LEAST)
}

/// Why a network cannot be trained.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrainingError {
    /// The signals do not serve.
    #[error("network training, {set} data: {source}")]
    Data {
        /// Which data set.
        set: &'static str,
        /// What is wrong with it.
        source: DataError,
    },
    /// A size is zero, or the data have other numbers of signals.
    #[error(
        "the data have {inputs} inputs and {outputs} outputs, the network is to have {structure:?}"
    )]
    Structure {
        /// Sizes asked for; all must be at least 1.
        structure: Structure,
        /// Inputs in the data.
        inputs: usize,
        /// Outputs in the data.
        outputs: usize,
    },
    /// Nothing was tried.
    #[error("training needs at least one start")]
    NoStart,
    /// No structure to choose from.
    #[error("a choice of structure needs at least one candidate")]
    NoCandidate,
    /// Every start ended in an error that is not finite.
    #[error("none of {starts} starts reached a finite error: give other data or more starts")]
    NoFiniteStart {
        /// Starts tried.
        starts: usize,
    },
}

/// How one start ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartRow {
    /// Root mean square free-run error on the estimation data, in deviations of the outputs.
    pub estimation: f64,
    /// The same on the validation data, in the same deviations.
    pub validation: f64,
}

/// A trained network.
#[derive(Debug, Clone, PartialEq)]
pub struct Trained {
    /// The network of the best start.
    pub network: Arc<Network>,
    /// Its free parameters.
    pub theta: Theta,
    /// Sum of squared free-run errors on the estimation data, in deviations of the outputs.
    pub sse: f64,
    /// AIC of these errors, charged for [`Structure::effective_parameters`].
    pub aic: f64,
    /// All starts, by index.
    pub starts: Vec<StartRow>,
    /// Index of the start that was kept.
    pub best: usize,
}

/// Which start is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keep {
    /// The one that does best on validation data: a network for use.
    BestOnValidation,
    /// The one that fits best: the least squares that AIC asks for.
    BestFit,
}

/// Trains a network on `estimation` data and keeps the start that does best on `validation` data
/// (another recording of the same signals).
///
/// From a steady state nothing punishes a slow filter that the data hardly excite: it fits a drift,
/// guesses beyond what was shown, and has to be waited for. A memory that outlasts the run-up is
/// kept only if it lowers the error of the first output on the validation data by what a larger
/// model is worth.
pub fn train(
    structure: Structure,
    estimation: &Data,
    validation: &Data,
    training: &Training,
) -> Result<Trained, TrainingError> {
    let data = (estimation, validation);
    let of = |sizes, how: &Training| train_from(&[], Keep::BestOnValidation, sizes, data, how);
    let Some((soon, settling)) = training.settling_soon(structure) else {
        return of(structure, training);
    };
    let leaves = [estimation, validation].iter().all(|data| leaves_half(data, settling));
    let run_up = if leaves { settling } else { training.run_up };
    let soon = of(soon, training)?;
    let longest = of(structure, &Training { run_up, ..*training })?;
    let error = |trained: &Trained| {
        let remainder = residual(&mut trained.network.run(), validation, training.start);
        mean_and_deviation(&validation.judged(&remainder, run_up)).1
    };
    Ok(if error(&soon) > (1.0 + WORTH) * error(&longest) { longest } else { soon })
}

/// Trains from the random starts and from networks that this structure contains, which come last.
pub(super) fn train_from(
    smaller: &[&Theta],
    keep: Keep,
    structure: Structure,
    (estimation, validation): (&Data, &Data),
    training: &Training,
) -> Result<Trained, TrainingError> {
    let &Training { method, starts, seed, .. } = training;
    for (set, data) in [("estimation", estimation), ("validation", validation)] {
        let (inputs, outputs) = (data.inputs().len(), data.outputs().len());
        if !structure.is_valid() || inputs != structure.inputs || outputs != structure.outputs {
            return Err(TrainingError::Structure { structure, inputs, outputs });
        }
        let needed =
            training.uncounted(data) + structure.effective_parameters().div_ceil(outputs) + 1;
        data.require_samples(needed, "training after its run-up")
            .and_then(|()| data.require_variation())
            .map_err(|source| TrainingError::Data { set, source })?;
    }
    if starts == 0 {
        return Err(TrainingError::NoStart);
    }
    let scales = |columns: &[Column]| columns.iter().map(|c| Scale::of(c.values)).collect();
    let (input_scales, output_scales): (Vec<_>, Vec<_>) =
        (scales(estimation.inputs()), scales(estimation.outputs()));
    let held = training.held();
    let standardised = |data: &Data| -> Vec<Standardised> {
        let parts = data.parts(training.uncounted(data));
        let of = |part| Standardised::new(part, (&input_scales, &output_scales), held);
        parts.iter().map(of).collect()
    };
    let settling = [estimation, validation].map(|data| held + training.uncounted(data));
    let (estimation, validation) = (standardised(estimation), standardised(validation));
    let error = FreeRunError { structure, segments: rows(&estimation, settling[0]) };
    let judge = FreeRunError { structure, segments: rows(&validation, settling[1]) };

    let ends: Vec<(Vec<f64>, f64, f64)> = (0..starts + smaller.len())
        .into_par_iter()
        .map(|index| {
            let mut random = Pcg64::new(u128::from(seed), STREAM * index as u128);
            let normal = || StandardNormal.sample(&mut random);
            let start = match index.checked_sub(starts) {
                Some(place) => smaller[place].embedded(structure, normal).values,
                None => Theta::draw(structure, normal).values,
            };
            let (values, sse) = match method {
                Method::LevenbergMarquardt(limits) => {
                    let minimum = minimise(&error, &start, limits);
                    (minimum.parameters, minimum.sse)
                }
                Method::AdaptiveRandomSearch { outer } => {
                    ars::search(|values| error.sse(values), start, outer, &mut random)
                }
            };
            let held_out = judge.sse(&values);
            (values, sse, held_out)
        })
        .collect();

    let judged = ends
        .iter()
        .enumerate()
        .filter(|(_, (_, sse, held_out))| sse.is_finite() && held_out.is_finite());
    let measure = |(_, sse, held_out): &(Vec<f64>, f64, f64)| match keep {
        Keep::BestOnValidation => *held_out,
        Keep::BestFit => *sse,
    };
    let best = judged.min_by(|(_, a), (_, b)| measure(a).total_cmp(&measure(b)));
    let best = best.map(|(index, _)| index);
    let Some(best) = best else { return Err(TrainingError::NoFiniteStart { starts: ends.len() }) };
    let counted = |parts: &[Standardised], settling: usize| -> usize {
        parts.iter().map(|part| part.outputs.len() - settling * structure.outputs).sum()
    };
    let n_estimation = counted(&estimation, settling[0]);
    let n_validation = counted(&validation, settling[1]);
    let rows = ends.iter().map(|(_, sse, held_out)| StartRow {
        estimation: (sse / n_estimation as f64).sqrt(),
        validation: (held_out / n_validation as f64).sqrt(),
    });
    let rows = rows.collect();
    let (values, sse, _) = ends.into_iter().nth(best).expect("an index of these ends");
    let theta = Theta { structure, values };
    Ok(Trained {
        network: Arc::new(theta.network(input_scales, output_scales)),
        aic: aic(sse, n_estimation, structure.effective_parameters()),
        theta,
        sse,
        starts: rows,
        best,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::data;
    use crate::signal_model::free_run;
    use crate::testing::{multisine, noise};

    const RUN_UP: usize = 100;

    fn quick(method: Method, starts: usize) -> Training {
        Training { method, starts, seed: 5, run_up: RUN_UP, start: Start::Rest }
    }

    const LM: Method = Method::LevenbergMarquardt(Limits { steps: 60, relative_decrease: 1e-6 });

    #[test]
    fn a_motor_with_dry_friction_is_learned_to_a_few_rpm() {
        let (estimation, validation, fresh) =
            (multisine(1000, 1), multisine(1000, 2), multisine(1000, 3));
        let trained =
            train(Structure::PAPER, &data(&estimation), &data(&validation), &quick(LM, 4)).unwrap();
        let remainder = residual(&mut trained.network.run(), &data(&fresh), Start::Rest);
        let (_, remainder) = mean_and_deviation(&remainder[RUN_UP..]);
        let (_, speed) = mean_and_deviation(&fresh.speed);
        // Tachometer noise and load torque alone are 6 rpm; a linear model leaves 3 %.
        assert!(remainder < 0.02 * speed, "{remainder} of {speed} rpm");
        let row = trained.starts[trained.best];
        assert!(trained.starts.iter().all(|other| other.validation >= row.validation));
    }

    #[test]
    fn the_stored_network_is_the_trained_one() {
        let (estimation, validation) = (multisine(400, 1), multisine(400, 2));
        let structure = Structure { v1: 2, v2: 2, order: 2, ..Structure::PAPER };
        let trained =
            train(structure, &data(&estimation), &data(&validation), &quick(LM, 1)).unwrap();
        let y = free_run(&mut trained.network.run(), data(&estimation).inputs()).swap_remove(0);
        let scale = trained.network.output_scales[0];
        let sse: f64 = y
            .iter()
            .zip(&estimation.speed)
            .skip(RUN_UP)
            .map(|(y, measured)| ((y - measured) / scale.deviation).powi(2))
            .sum();
        assert!((sse / trained.sse - 1.0).abs() < 1e-9, "{sse} against {}", trained.sse);
    }

    #[test]
    fn every_segment_is_learned_from_rest() {
        let (first, second) = (multisine(400, 1), multisine(300, 2));
        let joined = crate::testing::Run {
            control: [&first.control[..], &second.control].concat(),
            speed: [&first.speed[..], &second.speed].concat(),
        };
        let parted = data(&joined).in_segments(vec![0..400, 400..700]);
        let structure = Structure { v1: 2, v2: 2, order: 2, ..Structure::PAPER };
        let trained = train(structure, &parted, &parted, &quick(LM, 1)).unwrap();
        let remainder = residual(&mut trained.network.run(), &parted, Start::Rest);
        let of_second = residual(&mut trained.network.run(), &data(&second), Start::Rest);
        assert_eq!(remainder[400..], of_second);
        let scale = trained.network.output_scales[0].deviation;
        let sse: f64 = parted.judged(&remainder, RUN_UP).iter().map(|r| (r / scale).powi(2)).sum();
        assert!((sse / trained.sse - 1.0).abs() < 1e-9, "{sse} against {}", trained.sse);
    }

    /// A lag of that pole that starts up from `from`, driven by noise, with noise of 0.5 on its output.
    fn lag(pole: f64, from: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let (u, e) = (noise(3000, seed), noise(3000, seed + 100));
        let mut x = from;
        let step = |(u, e): (&f64, &f64)| {
            let y = x + 0.5 * e;
            x = pole * x + u;
            y
        };
        let y = u.iter().zip(&e).map(step).collect();
        (u, y)
    }

    #[test]
    fn a_start_up_bends_nothing_and_memory_beyond_the_run_up_must_pay() {
        let structure = Structure { v1: 2, v2: 1, memory: Some(200), ..Structure::PAPER };
        // Time constants of 10 and 100 samples; a run-up of 100 settles the first, started from rest or not.
        for (pole, from) in [(0.9, 0.0), (0.9, -100.0), (0.99, 0.0)] {
            let runs = [1, 2].map(|seed| lag(pole, from, seed));
            let [estimation, validation] = runs.each_ref().map(|(u, y)| {
                let input = vec![Column { name: "u", values: u }];
                Data::new(input, Column { name: "y", values: y }).unwrap()
            });
            let training = Training { start: Start::Steady, ..quick(LM, 3) };
            let trained = train(structure, &estimation, &validation, &training).unwrap();
            let is_slow = pole > 0.95;
            let wanted = if is_slow { 200 } else { 20 };
            assert_eq!(trained.theta.structure.memory, Some(wanted), "{pole} {from}");
            let remainder = residual(&mut trained.network.run(), &validation, Start::Steady);
            let (_, remainder) =
                mean_and_deviation(&remainder[if is_slow { 1000 } else { RUN_UP }..]);
            assert!(remainder < 0.6, "{pole} {from}: {remainder}");
        }
        // Half of it is not left: all of it counts.
        let (u, y) = lag(0.9, 0.0, 3);
        let input = vec![Column { name: "u", values: &u[..150] }];
        let short = Data::new(input, Column { name: "y", values: &y[..150] }).unwrap();
        let training = Training { start: Start::Steady, ..quick(LM, 1) };
        assert_eq!((training.uncounted(&short), training.held()), (0, RUN_UP));
        assert!(train(structure, &short, &short, &training).is_ok());
    }

    #[test]
    fn the_seed_decides_and_the_threads_do_not() {
        let (estimation, validation) = (multisine(300, 1), multisine(300, 2));
        let (estimation, validation) = (data(&estimation), data(&validation));
        for method in [LM, Method::AdaptiveRandomSearch { outer: 1 }] {
            let on = |threads: usize, seed: u64| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let training = Training { seed, ..quick(method, 3) };
                pool.install(|| train(Structure::PAPER, &estimation, &validation, &training))
            };
            assert_eq!(on(1, 7), on(3, 7));
            assert_ne!(on(1, 7), on(1, 8));
        }
    }

    #[test]
    fn random_search_lowers_the_error_and_levenberg_marquardt_lowers_it_further() {
        let (estimation, validation) = (multisine(300, 1), multisine(300, 2));
        let (estimation, validation) = (data(&estimation), data(&validation));
        let reached = |method| {
            train(Structure::PAPER, &estimation, &validation, &quick(method, 1)).unwrap().sse
        };
        let start = reached(Method::AdaptiveRandomSearch { outer: 0 });
        let ars = reached(Method::AdaptiveRandomSearch { outer: 2 });
        let lm = reached(LM);
        assert!(ars < 0.5 * start && lm < 0.5 * ars, "{start}, {ars}, {lm}");
    }

    #[test]
    fn several_outputs_are_learned_together() {
        let run = multisine(500, 4);
        let mirrored: Vec<f64> = run.speed.iter().map(|speed| -0.1 * speed + 3.0).collect();
        let both = data(&run).and_output(Column { name: "mirrored", values: &mirrored }).unwrap();
        let structure = Structure { outputs: 2, ..Structure::PAPER };
        let trained = train(structure, &both, &both, &quick(LM, 2)).unwrap();
        assert!(trained.starts[trained.best].estimation < 0.05, "{:?}", trained.starts);
    }

    #[test]
    fn unusable_data_and_sizes_are_refused() {
        let run = multisine(300, 1);
        let good = data(&run);
        let still = vec![1.0; 300];
        let dead = Data::new(vec![Column { name: "C_m", values: &still }], good.output()).unwrap();
        let training = quick(LM, 1);
        let error = train(Structure::PAPER, &good, &dead, &training).unwrap_err().to_string();
        assert_eq!(
            error,
            "network training, validation data: signal C_m is constant at 1: nothing can be learned from it"
        );
        let short = good.span(0..110);
        let error = train(Structure::PAPER, &short, &good, &training).unwrap_err().to_string();
        assert!(error.contains("at least 117 samples, there are 110"), "{error}");
        for structure in
            [Structure { v1: 0, ..Structure::PAPER }, Structure { inputs: 2, ..Structure::PAPER }]
        {
            let refusal = train(structure, &good, &good, &training);
            assert!(matches!(refusal, Err(TrainingError::Structure { .. })));
        }
        let none = train(Structure::PAPER, &good, &good, &quick(LM, 0));
        assert_eq!(none, Err(TrainingError::NoStart));
        // Noise carries no structure, and is trained upon without an error.
        let (u, y) = (noise(300, 5), noise(300, 6));
        let noise =
            Data::new(vec![Column { name: "u", values: &u }], Column { name: "y", values: &y });
        assert!(
            train(Structure::PAPER, &noise.clone().unwrap(), &noise.unwrap(), &training).is_ok()
        );
    }
}
