//! From a process model and healthy recordings to a diagnoser (steps 1 to 4 of Section 2.2).

use thiserror::Error;

use crate::arx::{Arx, ArxError, Orders, leaves_half};
use crate::constant_threshold::ConstantThreshold;
use crate::data::{Data, DataError};
use crate::detectors::Stored;
use crate::diagnoser::Diagnoser;
use crate::file::SCHEMA;
use crate::gmdh::RobustGmdh;
use crate::interface::Interface;
use crate::model::Model;
use crate::model_error::BandDesign;
use crate::network::{Structure, Training, TrainingError, train};
use crate::signal_model::{Start, residual};
use crate::stored_error::ModelError;
use crate::threshold::Confidence;

/// What the residual is modelled with.
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorModel {
    /// ARX of given orders.
    Arx(Orders),
    /// ARX, orders by AIC up to these.
    ArxUpTo(Orders),
    /// ARX, orders up to these by the free-run error on data that were not fitted.
    ArxByFreeRun(Orders),
    /// A recurrent network; its starts are judged on the design data.
    Network(Structure, Training),
}

/// How a diagnoser is designed.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// What the residual is modelled with.
    pub error_model: ErrorModel,
    /// Samples at the start of a run during which the models settle.
    pub run_up: usize,
    /// Where models begin a run.
    pub start: Start,
    /// Exceedances in a row that declare a fault.
    pub window: usize,
    /// Share of healthy samples expected outside the bands.
    pub confidence: Confidence,
}

impl Design {
    /// The paper's: ARX with n_a = n_b = 20 and a constant, 50 exceedances; 500 samples of run-up from
    /// rest.
    pub fn paper(confidence: Confidence) -> Self {
        Self {
            error_model: ErrorModel::Arx(Orders::PAPER),
            run_up: 500,
            start: Start::Rest,
            window: 50,
            confidence,
        }
    }

    /// For recordings of machines that run: models begin in the steady state, and the orders are those
    /// of the least free-run error, up to the paper's.
    pub fn steady(confidence: Confidence) -> Self {
        let error_model = ErrorModel::ArxByFreeRun(Orders::PAPER);
        Self { error_model, start: Start::Steady, ..Self::paper(confidence) }
    }
}

/// What the design found on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignReport {
    /// Width of the bands and the tests of r - y_e that they rest on.
    pub bands: BandDesign,
    /// Orders of the error model if it is ARX.
    pub orders: Option<Orders>,
    /// Sum of squared one-step errors of an ARX error model on its estimation data.
    pub one_step_sse: Option<f64>,
}

/// Why a diagnoser cannot be designed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DesignError {
    /// The process model does not take these signals.
    #[error("the process model takes {model:?} (inputs, outputs), the interface has ({inputs}, 1)")]
    Signals {
        /// Inputs and outputs of the model; `None` if its parts do not fit together.
        model: Option<(usize, usize)>,
        /// Inputs of the interface and the data.
        inputs: usize,
    },
    /// The process model explodes.
    #[error("the process model is unstable in free run: train it again")]
    Unstable,
    /// The healthy data do not serve.
    #[error("healthy data: {0}")]
    Data(#[from] DataError),
    /// The ARX error model cannot be fitted.
    #[error("error model: {0}")]
    Arx(#[from] ArxError),
    /// The recurrent error model cannot be trained.
    #[error("error model: {0}")]
    Network(#[from] TrainingError),
}

/// What the models need to settle, as far as the recordings are long enough for it: five time
/// constants of the process model, and at least what is asked for.
fn own_run_up(model: &Model, healthy: &Data, design: &Data, asked: usize) -> usize {
    let own = model.run_up();
    let leaves = |data: &Data| leaves_half(data, own);
    if own > asked && leaves(healthy) && leaves(design) { own } else { asked }
}

/// Bands of an error model, after its own run-up where that leaves half of the data; and whether it
/// does not.
fn measured(
    error_model: &Model,
    design: &Data,
    (run_up, start): (usize, Start),
) -> Result<(BandDesign, bool), DataError> {
    let own = error_model.run_up().max(run_up);
    let outlasts = own > run_up && !leaves_half(design, own);
    let begun = (if outlasts { run_up } else { own }, start);
    Ok((BandDesign::measure(&mut error_model.run(), design, begun)?, outlasts))
}

impl Diagnoser {
    /// Fits the error model on the residual of `healthy` data, and measures the middle and the width of
    /// the bands and the constant thresholds on `design` data: another healthy run, or the same one (the
    /// bands then come out about K/N too narrow, K parameters on N samples).
    pub fn design(
        interface: Interface,
        model: Model,
        healthy: &Data,
        design: &Data,
        how: &Design,
    ) -> Result<(Self, DesignReport), DesignError> {
        let inputs = interface.inputs.len();
        let signals = model.signals();
        let given = [healthy.inputs().len(), design.inputs().len()];
        if signals != Some((inputs, 1)) || given != [inputs; 2] {
            return Err(DesignError::Signals { model: signals, inputs });
        }
        if !model.is_stable() {
            return Err(DesignError::Unstable);
        }
        let Design { ref error_model, run_up, start, window, confidence } = *how;
        for data in [healthy, design] {
            data.require_samples(run_up + 2, "a design after its run-up")?;
        }
        let run_up = match start {
            Start::Rest => run_up,
            Start::Steady => own_run_up(&model, healthy, design, run_up),
        };
        let mut run = model.run();
        let (r, r_design) = (residual(&mut run, healthy, start), residual(&mut run, design, start));
        let healthy = healthy.with_output("residual", &r)?;
        let design = design.with_output("residual", &r_design)?;
        let settled = healthy.settled(run_up);
        let (error_model, orders, one_step_sse) = match *error_model {
            ErrorModel::Arx(orders) => {
                let fit = Arx::fit(&settled, orders)?;
                (Model::Arx(fit.model), Some(orders), Some(fit.sse))
            }
            ErrorModel::ArxUpTo(widest) => {
                let table = Arx::select(&settled, widest)?;
                (Model::Arx(table.fit.model), Some(table.best), Some(table.fit.sse))
            }
            ErrorModel::ArxByFreeRun(widest) => {
                let found = Arx::select_by_free_run(&settled, widest, start)?;
                (Model::Arx(found.model), Some(found.best.orders), None)
            }
            ErrorModel::Network(structure, ref training) => {
                let judge = design.settled(run_up);
                let trained = train(structure, &settled, &judge, training)?;
                (Model::Network(trained.network), None, None)
            }
        };
        let (bands, outlasts) = measured(&error_model, &design, (run_up, start))?;
        let constant = ConstantThreshold::design(&design, run_up)?;
        let detectors = Stored::design(&design, run_up, confidence)?;
        let model_error = ModelError::centred(&error_model, &bands, outlasts);
        let diagnoser = Self {
            schema: SCHEMA,
            run_up,
            window,
            confidence,
            interface,
            constant,
            model,
            model_error,
            recurrent_error: None,
            gmdh: None,
            faults: None,
            windows: None,
            range: None,
            bank: None,
            detectors,
        };
        Ok((diagnoser, DesignReport { bands, orders, one_step_sse }))
    }

    /// Adds a recurrent network as second error model, with bands of its own: trained on the
    /// residual of `healthy` data, judged and measured on that of `design` data.
    pub fn with_recurrent_error(
        mut self,
        healthy: &Data,
        design: &Data,
        structure: Structure,
        (training, start): (&Training, Start),
    ) -> Result<(Self, BandDesign), DesignError> {
        let run_up = self.run_up;
        let inputs = self.interface.inputs.len();
        for data in [healthy, design] {
            if data.inputs().len() != inputs {
                return Err(DesignError::Signals { model: self.model.signals(), inputs });
            }
            data.require_samples(run_up + 2, "a design after its run-up")?;
        }
        let mut run = self.model.run();
        let (r, r_design) = (residual(&mut run, healthy, start), residual(&mut run, design, start));
        let healthy = healthy.with_output("residual", &r)?.settled(run_up);
        let design = design.with_output("residual", &r_design)?;
        let judge = design.settled(run_up);
        let model = Model::Network(train(structure, &healthy, &judge, training)?.network);
        let (bands, outlasts) = measured(&model, &design, (run_up, start))?;
        self.recurrent_error = Some(ModelError::centred(&model, &bands, outlasts));
        Ok((self, bands))
    }

    /// Adds a GMDH network with bounded parameters.
    pub fn with_gmdh(mut self, gmdh: RobustGmdh) -> Result<Self, DesignError> {
        let inputs = self.interface.inputs.len();
        if gmdh.inputs() != Some(inputs) {
            let model = gmdh.inputs().map(|inputs| (inputs, 1));
            return Err(DesignError::Signals { model, inputs });
        }
        self.gmdh = Some(gmdh);
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    //! What a diagnoser can hold beside its ARX bands: a second error model and a GMDH network.

    use std::sync::Arc;

    use super::*;
    use crate::data::data;
    use crate::detector::DetectorError;
    use crate::detectors::DetectorKind;
    use crate::file::FileError;
    use crate::flaw::Flaw;
    use crate::gmdh::{BoundOptions, Gmdh, GmdhOptions};
    use crate::interface::Channel;
    use crate::testing::{PERIOD, closed_loop, multisine};

    const RUN_UP: usize = 200;

    /// A process model without dynamics: its residual leaves everything to the error models.
    fn designed(healthy: &Data) -> Diagnoser {
        let interface = Interface {
            period_s: PERIOD,
            inputs: vec![Channel::new("C_m", "V")],
            output: Channel::new("T", "rpm"),
        };
        let gain = Arc::new(Arx { a: vec![], b: vec![vec![300.0]], constant: 0.0 });
        let orders = Orders { n_a: 4, n_b: 4, constant: true };
        let paper = Design::paper(Confidence::new(0.05).unwrap());
        let how = Design { error_model: ErrorModel::Arx(orders), run_up: RUN_UP, ..paper };
        Diagnoser::design(interface, Model::Arx(gain), healthy, healthy, &how).unwrap().0
    }

    #[test]
    fn a_second_error_model_and_a_gmdh_network_are_stored_and_run() {
        let (open, closed) = (multisine(500, 1), closed_loop(1500, 2, usize::MAX, 0.0));
        let (open, closed) = (data(&open), data(&closed));
        let diagnoser = designed(&closed);
        for kind in [DetectorKind::Gmdh, DetectorKind::MemRecurrent] {
            let refusal = diagnoser.detector(kind).unwrap_err();
            assert!(matches!(refusal, DetectorError::Missing { .. }), "{refusal}");
        }
        let small = Structure { v1: 1, v2: 1, ..Structure::PAPER };
        let training = Training { starts: 1, seed: 3, ..Training::default() };
        let (diagnoser, report) = diagnoser
            .with_recurrent_error(&closed, &closed, small, (&training, Start::Rest))
            .unwrap();
        assert!(report.normality.is_some() && report.whiteness.is_some());
        let options =
            GmdhOptions { delays: 2, survivors: 2, most_layers: 2, ..GmdhOptions::default() };
        let (network, _) =
            Gmdh::synthesise(std::slice::from_ref(&open), std::slice::from_ref(&open), &options)
                .unwrap();
        let how = BoundOptions { run_up: RUN_UP, ..BoundOptions::default() };
        let robust = RobustGmdh::design(&network, std::slice::from_ref(&open), &[], &how).unwrap();
        let diagnoser = diagnoser.with_gmdh(robust.clone()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("motor.toml");
        diagnoser.save(&path).unwrap();
        let loaded = Diagnoser::load(&path).unwrap();
        assert_eq!(loaded, diagnoser);
        for kind in [DetectorKind::Gmdh, DetectorKind::MemRecurrent] {
            let run = |diagnoser: &Diagnoser| diagnoser.detector(kind).unwrap().run(&closed);
            assert_eq!(run(&loaded), run(&diagnoser));
        }
        let mut open_set = robust;
        open_set.bounds[0].set.parts[0].facets.truncate(3);
        let broken = Diagnoser { gmdh: Some(open_set), ..diagnoser };
        assert_eq!(broken.detector(DetectorKind::Gmdh).err(), Some(DetectorError::DamagedBounds));
        broken.save(&path).unwrap();
        assert!(matches!(
            Diagnoser::load(&path),
            Err(FileError::Flaw { flaw: Flaw::Bounds(_), .. })
        ));
    }
}
