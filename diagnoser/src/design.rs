//! From a process model and healthy recordings to a diagnoser (steps 1 to 4 of Section 2.2).

use thiserror::Error;

use crate::arx::{Arx, ArxError, Orders};
use crate::data::{Data, DataError};
use crate::diagnoser::{Diagnoser, ModelError};
use crate::file::SCHEMA;
use crate::interface::Interface;
use crate::model::Model;
use crate::model_error::BandDesign;
use crate::network::{Structure, Training, TrainingError, train};
use crate::signal_model::residual;
use crate::threshold::{Confidence, ConstantThreshold};

/// What the residual is modelled with.
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorModel {
    /// ARX of given orders.
    Arx(Orders),
    /// ARX, orders by AIC up to these.
    ArxUpTo(Orders),
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
    /// Exceedances in a row that declare a fault.
    pub window: usize,
    /// Share of healthy samples expected outside the bands.
    pub confidence: Confidence,
}

impl Design {
    /// The paper's: ARX with n_a = n_b = 20 and a constant, 50 exceedances; 500 samples of run-up.
    pub fn paper(confidence: Confidence) -> Self {
        let orders = Orders { n_a: 20, n_b: 20, constant: true };
        Self { error_model: ErrorModel::Arx(orders), run_up: 500, window: 50, confidence }
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

impl Diagnoser {
    /// Fits the error model on the residual of `healthy` data, and measures the width of the bands
    /// and the constant thresholds on `design` data: another healthy run, or the same one (the
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
        let Design { ref error_model, run_up, window, confidence } = *how;
        for data in [healthy, design] {
            data.require_samples(run_up + 2, "a design after its run-up")?;
        }
        let mut run = model.run();
        let (r, r_design) = (residual(&mut run, healthy), residual(&mut run, design));
        let healthy = healthy.with_output("residual", &r)?;
        let design = design.with_output("residual", &r_design)?;
        let settled = healthy.span(run_up..healthy.len());
        let (error_model, orders, one_step_sse) = match *error_model {
            ErrorModel::Arx(orders) => {
                let fit = Arx::fit(&settled, orders)?;
                (Model::Arx(fit.model), Some(orders), Some(fit.sse))
            }
            ErrorModel::ArxUpTo(widest) => {
                let table = Arx::select(&settled, widest)?;
                (Model::Arx(table.fit.model), Some(table.best), Some(table.fit.sse))
            }
            ErrorModel::Network(structure, ref training) => {
                let judge = design.span(run_up..design.len());
                let trained = train(structure, &settled, &judge, training)?;
                (Model::Network(trained.network), None, None)
            }
        };
        let bands = BandDesign::measure(&mut error_model.run(), &design, run_up)?;
        let constant = ConstantThreshold::design(&design, run_up)?;
        let model_error =
            ModelError { deviation: bands.deviation, samples: bands.samples, model: error_model };
        let diagnoser = Self {
            schema: SCHEMA,
            run_up,
            window,
            confidence,
            interface,
            constant,
            model,
            model_error,
        };
        Ok((diagnoser, DesignReport { bands, orders, one_step_sse }))
    }
}
