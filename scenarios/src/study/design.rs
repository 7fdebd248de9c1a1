//! What the study trains and designs: process model, error model, bands, thresholds.

use std::sync::Arc;

use drivescope_diagnoser::{
    Arx, ArxFit, ArxRun, Band, BandDesign, Column, Confidence, ConstantThreshold, Data, Detector,
    ErrorBands, Orders, residual,
};
use drivescope_diagnoser::{
    Network, NetworkRun, Structure, Trained, Training, train as train_network,
};
use drivescope_fmu::import::Fmu;
use drivescope_recording::Recording;

use super::judge::Watch;
use super::{RUN_UP, SAMPLES, StudyError};
use crate::cosimulated;
use crate::experiment::{Experiment, Stream};
use crate::results::ModelSummary;

/// Samples of the learning set, as in the paper.
const TRAINING_SAMPLES: usize = 1000;
/// Samples that the paper's error model was tested on.
const TEST_SAMPLES: usize = 3000;
/// Past outputs and inputs of the error model, as in the paper.
const ORDERS: Orders = Orders { n_a: 20, n_b: 20, constant: true };
/// Consecutive exceedances that declare a fault: 0.25 s at 5 ms.
pub(super) const WINDOW: usize = 50;

/// The trained process model and how well it runs free.
#[derive(Debug, Clone)]
pub(super) struct Process {
    network: Arc<Network>,
    deviation: f64,
}

/// Trains the process model T = f(C_m) on the open loop under the excitation (25). A second
/// stretch of it, with noise of its own, is held out to choose among the starts.
pub(super) fn train(experiment: &Experiment, open: &Fmu) -> Result<Process, StudyError> {
    let mut sets = Vec::new();
    for part in 0..2 {
        let excited = experiment.excited(TRAINING_SAMPLES, Stream::Training(part));
        let signals = cosimulated::open_loop(open, &excited.inputs)?;
        sets.push((excited.c_m, values(&signals, "T").to_vec()));
    }
    let data = sets
        .iter()
        .map(|(c_m, t)| Data::new(vec![column("C_m", c_m)], column("T", t)))
        .collect::<Result<Vec<_>, _>>()?;
    let training = Training { seed: experiment.seed, ..Training::default() };
    let Trained { network, .. } = train_network(Structure::PAPER, &data[0], &data[1], &training)?;
    let error = residual(&mut network.run(), &data[1]);
    let settled = &error[training.run_up..];
    let deviation = mean_and_deviation(settled).1;
    Ok(Process { network, deviation })
}

/// Everything that watches a run.
#[derive(Debug, Clone)]
pub(super) struct Diagnoser {
    process: Process,
    error_model: Arc<Arx>,
    deviation: f64,
    constant: Band,
    confidence: Confidence,
    summary: ModelSummary,
    tacho_unit: &'static str,
}

impl Diagnoser {
    /// Designs error model, bands and constant thresholds on a healthy closed-loop run.
    pub(super) fn design(
        experiment: &Experiment,
        closed: &Fmu,
        process: Process,
        beta: f64,
    ) -> Result<Self, StudyError> {
        let confidence = Confidence::new(beta)?;
        let healthy = |k: u64| -> Result<Recording, StudyError> {
            let inputs = experiment.closed_loop(SAMPLES, Stream::Design(k), None);
            Ok(cosimulated::closed_loop(closed, &inputs, None::<&mut Watch>)?)
        };
        let (design, test) = (healthy(0)?, healthy(1)?);
        let run = |signals: &Recording| -> Result<Vec<f64>, StudyError> {
            let data = Data::new(
                vec![column("C_m", values(signals, "C_m"))],
                column("T", values(signals, "T")),
            )?;
            Ok(residual(&mut process.network.run(), &data))
        };
        let r = run(&design)?;
        let data = Data::new(vec![column("C_m", values(&design, "C_m"))], column("r", &r))?;
        let settled = data.span(RUN_UP..SAMPLES);
        let ArxFit { model: error_model, .. } = Arx::fit(&settled, ORDERS)?;
        let bands = BandDesign::measure(&mut error_model.run(), &data, RUN_UP)?;
        let threshold = ConstantThreshold::design(&data, RUN_UP)?;
        let constant = threshold.band(confidence);

        let r_test = run(&test)?;
        let data = Data::new(vec![column("C_m", values(&test, "C_m"))], column("r", &r_test))?;
        let tested = data.span(RUN_UP..RUN_UP + TEST_SAMPLES);
        let scale = experiment.set_point * experiment.drive.sensors.tacho_unit.per_si();
        let errors = error_model.one_step(&tested);
        let error_model_sse = errors.iter().map(|e| (e / scale).powi(2)).sum();
        let (residual_mean, residual_sd) = mean_and_deviation(&r[RUN_UP..]);
        let Structure { v1, v2, order, .. } = Structure::PAPER;
        let summary = ModelSummary {
            process_model: format!(
                "locally recurrent network (1), (5): {v1} IIR and {v2} FIR neurons, order {order}, \
                 Levenberg-Marquardt in free run"
            ),
            training_samples: TRAINING_SAMPLES,
            training_sd: process.deviation,
            residual_sd,
            residual_mean,
            n_a: ORDERS.n_a,
            n_b: ORDERS.n_b,
            error_model_sse,
            error_model_samples: errors.len(),
            v: bands.deviation,
            whiteness_p: bands.whiteness.map_or(0.0, |test| test.p_value),
            normality_p: bands.normality.map_or(0.0, |test| test.p_value),
            constant: (constant.lower, constant.upper),
        };
        let tacho_unit = experiment.tacho_unit();
        let deviation = bands.deviation;
        Ok(Self { process, error_model, deviation, constant, confidence, summary, tacho_unit })
    }

    /// Detectors at the start of a run.
    pub(super) fn watch(&self) -> Result<Watch, StudyError> {
        let bands = ErrorBands::new(self.error_model.run(), self.deviation, self.confidence);
        let model = || self.process.network.run();
        Ok(Watch::new(
            Detector::new(model(), bands, WINDOW, RUN_UP)?,
            Detector::new(model(), self.constant, WINDOW, RUN_UP)?,
        ))
    }

    /// Half the width of the constant thresholds, unit of T.
    pub(super) fn constant_threshold(&self) -> f64 {
        0.5 * (self.constant.upper - self.constant.lower)
    }

    pub(super) fn summary(&self) -> &ModelSummary {
        &self.summary
    }

    pub(super) fn tacho_unit(&self) -> &'static str {
        self.tacho_unit
    }
}

/// The adaptive detector of the study.
pub(super) type MemDetector = Detector<NetworkRun, ErrorBands<ArxRun>>;
/// The one with constant thresholds.
pub(super) type ConstantDetector = Detector<NetworkRun, Band>;

/// The values of a signal; none if the recording does not have it.
pub(super) fn values<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    recording.signal(name).map_or(&[], |signal| &signal.values)
}

fn column<'a>(name: &'a str, values: &'a [f64]) -> Column<'a> {
    Column { name, values }
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n;
    (mean, variance.sqrt())
}
