//! What a training says.

use std::path::PathBuf;

use drivescope_diagnoser::{
    BandDesign, Channel, FaultsReport, KnownFaults, Learned, ThresholdKind,
};
use drivescope_scenarios::results::SizeGroup;
use serde::Serialize;

use super::bank::BankAnswer;
use crate::report::words::{number, p_is, percent};

#[derive(Debug, Serialize)]
pub(super) struct Answer {
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<PathBuf>,
    inputs: Vec<Channel>,
    watched: Channel,
    period: f64,
    beta: f64,
    window_samples: usize,
    run_up_samples: usize,
    process_model: ProcessAnswer,
    bands: BandsAnswer,
    #[serde(skip_serializing_if = "Option::is_none")]
    recurrent_error: Option<BandsAnswer>,
    constant: ConstantAnswer,
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
    estimation_rms: f64,
    validation_rms: f64,
}

#[derive(Debug, Serialize)]
struct BandsAnswer {
    v: f64,
    samples: usize,
    whiteness_p: Option<f64>,
    normality_p: Option<f64>,
    /// Whether `diagnose` uses it: not where its bands are wider than the plain residual's.
    used: bool,
}

/// Windows against a baseline.
#[derive(Debug, Serialize)]
struct WindowsAnswer {
    samples: usize,
    baseline_samples: usize,
    /// Greatest departure of the mean, output unit, and greatest logarithm of the spread's ratio.
    mean: f64,
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

impl Answer {
    pub(super) fn new(
        output: Option<PathBuf>,
        learned: &Learned,
        faults: Option<&FaultsReport>,
        bank: Option<&BankAnswer>,
    ) -> Self {
        let Learned { diagnoser, process, design, recurrent_error, gmdh } = learned;
        let unit = process.network.output_scales[0].deviation;
        let start = process.starts[process.best];
        let bands = |bands: &BandDesign, kind: ThresholdKind| BandsAnswer {
            used: diagnoser.explains(kind),
            v: bands.deviation,
            samples: bands.samples,
            whiteness_p: bands.whiteness.as_ref().map(|test| test.p_value),
            normality_p: bands.normality.as_ref().map(|test| test.p_value),
        };
        let constant = diagnoser.constant.band(diagnoser.confidence);
        let network = diagnoser.gmdh.as_ref().zip(gmdh.as_ref());
        Self {
            output,
            inputs: diagnoser.interface.inputs.clone(),
            watched: diagnoser.interface.output.clone(),
            period: diagnoser.interface.period_s,
            beta: diagnoser.confidence.beta(),
            window_samples: diagnoser.window,
            run_up_samples: diagnoser.run_up,
            process_model: ProcessAnswer {
                estimation_rms: unit * start.estimation,
                validation_rms: unit * start.validation,
            },
            bands: bands(&design.bands, ThresholdKind::ModelError),
            recurrent_error: recurrent_error
                .as_ref()
                .map(|error| bands(error, ThresholdKind::RecurrentModelError)),
            constant: ConstantAnswer { lower: constant.lower, upper: constant.upper },
            windows: diagnoser.windows.as_ref().map(|windows| WindowsAnswer {
                samples: windows.samples,
                baseline_samples: windows.baseline,
                mean: windows.mean,
                spread: windows.spread,
                runs: windows.runs,
            }),
            gmdh: network.map(|(robust, report)| GmdhAnswer {
                layers: report.kept,
                neurons: robust.network.neurons.len(),
                validation_rms: report.validation,
                noise: robust.noise(),
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

    fn text(&self) -> String {
        let classes: Vec<String> = self.classes.iter().map(|class| class.join(" | ")).collect();
        let mut text =
            format!("classes of faults that can be told apart: {}\n", classes.join("; "));
        for FaultAnswer { fault, right, unknown, s, group } in &self.faults {
            text += &format!(
                "{fault}: {} % of held-out symptoms right, {} % unknown; S = {} thresholds, {}\n",
                percent(*right, 1),
                percent(*unknown, 1),
                number(*s),
                group.label()
            );
        }
        text
    }
}

impl Answer {
    /// As text for a person.
    pub(super) fn text(&self) -> String {
        let answer = self;
        let unit = &answer.watched.unit;
        let inputs: Vec<&str> = answer.inputs.iter().map(|channel| channel.name.as_str()).collect();
        let p = |p: Option<f64>| p.map_or_else(|| "not computed".to_owned(), p_is);
        let bands = |name: &str, bands: &BandsAnswer| {
            format!(
                "{name}: v = {} {unit} over {} samples; white? {}, normal? {}{}\n",
                number(bands.v),
                bands.samples,
                p(bands.whiteness_p),
                p(bands.normality_p),
                if bands.used { "" } else { "; wider than the plain residual: not used" }
            )
        };
        let mut text = format!(
            "{} from {}, every {} s; a fault is declared after {} samples outside\n\
         process model: free-run error {} {unit} in training, {} {unit} on what it was judged by\n",
            answer.watched.name,
            inputs.join(", "),
            answer.period,
            answer.window_samples,
            number(answer.process_model.estimation_rms),
            number(answer.process_model.validation_rms),
        );
        text += &bands("ARX error model", &answer.bands);
        if let Some(recurrent) = &answer.recurrent_error {
            text += &bands("recurrent error model", recurrent);
        }
        text += &format!(
            "constant thresholds: {} to {} {unit}\n",
            number(answer.constant.lower),
            number(answer.constant.upper)
        );
        if let Some(WindowsAnswer { samples, mean, spread, runs, .. }) = &answer.windows {
            text += &format!(
                "windows of {samples} samples against a baseline, from {runs} healthy runs: mean \
                 within {} {unit}, spread within {} %\n",
                number(*mean),
                percent(spread.exp() - 1.0, 0)
            );
        }
        if let Some(GmdhAnswer { layers, neurons, validation_rms, noise }) = &answer.gmdh {
            let noise = noise.map_or_else(String::new, |[lower, upper]| {
                format!(", noise bounds {} to {} {unit}", number(lower), number(upper))
            });
            text += &format!(
                "GMDH network: {neurons} neurons in {layers} layers, validation error {} {unit}{noise}\n",
                number(*validation_rms)
            );
        }
        if let Some(faults) = &answer.faults {
            text += &faults.text();
        }
        if let Some(bank) = &answer.bank {
            text += &bank.text();
        }
        if let Some(output) = &answer.output {
            text += &format!("written to {}\n", output.display());
        }
        text
    }
}
