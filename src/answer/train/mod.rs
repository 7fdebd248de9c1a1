//! What a training says.

mod bank;
mod blocks;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use drivescope_diagnoser::{
    BandDesign, Channel, DetectorKind, FaultsReport, KnownFaults, Learned, Selection, Stored,
    StructureRow,
};
use drivescope_scenarios::results::SizeGroup;
use serde::Serialize;

pub(crate) use bank::{BankAnswer, Confusion, Separable, VerifiedAnswer};

#[derive(Debug, Serialize)]
pub(crate) struct TrainAnswer {
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<PathBuf>,
    inputs: Vec<Channel>,
    watched: Channel,
    period: f64,
    beta: f64,
    window_samples: usize,
    run_up_samples: usize,
    process_model: ProcessAnswer,
    /// The sizes that were compared, where they were.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    structures: Vec<StructureAnswer>,
    bands: BandsAnswer,
    #[serde(skip_serializing_if = "Option::is_none")]
    recurrent_error: Option<BandsAnswer>,
    constant: ConstantAnswer,
    /// Designs of the detectors that are not told of above or below, as the file holds them.
    #[serde(skip_serializing_if = "Stored::is_empty")]
    detectors: Stored,
    /// The same detectors with their designs in words.
    #[serde(skip)]
    designed: Vec<(&'static str, String)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    windows: Option<WindowsAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gmdh: Option<GmdhAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    faults: Option<FaultsAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bank: Option<BankAnswer>,
}

#[derive(Debug, Serialize)]
struct ProcessAnswer {
    v1: usize,
    v2: usize,
    order: usize,
    estimation_rms: f64,
    validation_rms: f64,
}

/// A row of the choice of sizes.
#[derive(Debug, Serialize)]
struct StructureAnswer {
    v1: usize,
    v2: usize,
    order: usize,
    effective_parameters: usize,
    aic: f64,
    /// Standard deviation of the residual of a healthy recording, unit of the output.
    healthy: f64,
    chosen: bool,
}

#[derive(Debug, Serialize)]
struct BandsAnswer {
    /// Orders of an ARX model.
    #[serde(skip_serializing_if = "Option::is_none")]
    orders: Option<[usize; 2]>,
    /// Samples in which it settles: five of its slowest time constants.
    run_up: usize,
    v: f64,
    /// Standard deviation of the plain residual over the same samples.
    plain: f64,
    samples: usize,
    whiteness_p: Option<f64>,
    normality_p: Option<f64>,
    /// Whether `diagnose` uses it: not where its bands are not narrower than the plain residual's.
    used: bool,
    /// Why it is not used.
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
}

/// Windows against a baseline.
#[derive(Debug, Serialize)]
struct WindowsAnswer {
    samples: usize,
    baseline_samples: usize,
    /// Greatest departure of the mean at once and slowly, output unit, and greatest logarithm of the
    /// spread's ratio.
    mean: f64,
    drift: Option<f64>,
    spread: f64,
    runs: usize,
}

#[derive(Debug, Serialize)]
struct ConstantAnswer {
    lower: f64,
    upper: f64,
}

#[derive(Debug, Serialize)]
struct GmdhAnswer {
    layers: usize,
    neurons: usize,
    validation_rms: f64,
    noise: Option<[f64; 2]>,
    /// Whose parameters have bounds, and vertices of their sets.
    bounded_neurons: usize,
    vertices: usize,
    /// Greatest difference from the equivalent locally recurrent network (Section 2.4) over a healthy
    /// recording, output unit.
    recurrent_difference: Option<f64>,
}

/// What was learned of labelled faults.
#[derive(Debug, Serialize)]
struct FaultsAnswer {
    classes: Vec<Vec<String>>,
    faults: Vec<FaultAnswer>,
}

#[derive(Debug, Serialize)]
struct FaultAnswer {
    fault: String,
    /// Shares of symptoms that were not learned from.
    right: f64,
    unknown: f64,
    /// Size (27), and the group it puts the fault in among the others.
    #[serde(rename = "S")]
    s: f64,
    group: SizeGroup,
}

impl TrainAnswer {
    pub(crate) fn new(
        output: Option<PathBuf>,
        learned: &Learned,
        (faults, bank): (Option<&FaultsReport>, Option<&BankAnswer>),
        (compared, recurrent_difference): (Option<&Selection>, Option<f64>),
    ) -> Self {
        let Learned { diagnoser, process, design, recurrent_error, gmdh } = learned;
        let unit = process.network.output_scales[0].deviation;
        let start = process.starts[process.best];
        let bands = |bands: &BandDesign, kind: DetectorKind, orders| BandsAnswer {
            orders,
            run_up: diagnoser.run_up_of(kind),
            plain: bands.plain,
            used: diagnoser.explains(kind),
            refused: diagnoser.refusal(kind).map(|refusal| refusal.to_string()),
            v: bands.deviation,
            samples: bands.samples,
            whiteness_p: bands.whiteness.as_ref().map(|test| test.p_value),
            normality_p: bands.normality.as_ref().map(|test| test.p_value),
        };
        let constant = diagnoser.constant.band(diagnoser.confidence);
        let designed = |kind: DetectorKind| Some((kind.label(), diagnoser.designed(kind)?));
        let network = diagnoser.gmdh.as_ref().zip(gmdh.as_ref());
        Self {
            output,
            inputs: diagnoser.interface.inputs.clone(),
            watched: diagnoser.interface.output.clone(),
            period: diagnoser.interface.period_s,
            beta: diagnoser.confidence.beta(),
            window_samples: diagnoser.window,
            run_up_samples: diagnoser.run_up,
            structures: compared.into_iter().flat_map(structures).collect(),
            process_model: ProcessAnswer {
                v1: process.theta.structure.v1,
                v2: process.theta.structure.v2,
                order: process.theta.structure.order,
                estimation_rms: unit * start.estimation,
                validation_rms: unit * start.validation,
            },
            bands: bands(
                &design.bands,
                DetectorKind::Mem,
                design.orders.map(|orders| [orders.n_a, orders.n_b]),
            ),
            recurrent_error: recurrent_error
                .as_ref()
                .map(|error| bands(error, DetectorKind::MemRecurrent, None)),
            constant: ConstantAnswer { lower: constant.lower, upper: constant.upper },
            detectors: diagnoser.detectors.clone(),
            designed: DetectorKind::ALL.into_iter().filter_map(designed).collect(),
            windows: diagnoser.windows.as_ref().map(|windows| WindowsAnswer {
                samples: windows.samples,
                baseline_samples: windows.baseline,
                mean: windows.mean,
                drift: windows.drift,
                spread: windows.spread,
                runs: windows.runs,
            }),
            gmdh: network.map(|(robust, report)| GmdhAnswer {
                layers: report.kept,
                neurons: robust.network.neurons.len(),
                validation_rms: report.validation,
                noise: robust.noise(),
                bounded_neurons: robust.bounds.len(),
                vertices: robust.bands().map_or(0, |bands| bands.vertices()),
                recurrent_difference,
            }),
            faults: diagnoser
                .faults
                .as_deref()
                .zip(faults)
                .map(|(known, report)| FaultsAnswer::new(known, report)),
            bank: bank.cloned(),
        }
    }
}

fn structures(compared: &Selection) -> Vec<StructureAnswer> {
    let answer = |(k, row): (usize, &StructureRow)| StructureAnswer {
        v1: row.structure.v1,
        v2: row.structure.v2,
        order: row.structure.order,
        effective_parameters: row.effective_parameters,
        aic: row.trained.aic,
        healthy: row.healthy,
        chosen: k == compared.used,
    };
    compared.rows.iter().enumerate().map(answer).collect()
}

impl FaultsAnswer {
    fn new(known: &KnownFaults, report: &FaultsReport) -> Self {
        let partition = &known.isolator.partition;
        let owned = |class: usize| known.class(class).into_iter().map(str::to_owned).collect();
        let (right, unknown) = (report.held_out.right(partition), report.held_out.unknown());
        let faults = known.isolator.faults.iter().zip(&known.sizes).zip(known.groups());
        let faults = faults.zip(right.into_iter().zip(unknown)).map(
            |(((fault, s), group), (right, unknown))| FaultAnswer {
                fault: fault.clone(),
                right,
                unknown,
                s: *s,
                group,
            },
        );
        Self {
            classes: (0..partition.classes.len()).map(owned).collect(),
            faults: faults.collect(),
        }
    }
}
