//! The same as text for a person.

use super::{
    Answer, BandsAnswer, FaultAnswer, FaultsAnswer, GmdhAnswer, StructureAnswer, WindowsAnswer,
};
use crate::report::words::{number, p_is, percent};

impl FaultsAnswer {
    pub(super) fn text(&self) -> String {
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
    pub(in crate::commands::train) fn text(&self) -> String {
        let answer = self;
        let unit = &answer.watched.unit;
        let inputs: Vec<&str> = answer.inputs.iter().map(|channel| channel.name.as_str()).collect();
        let p = |p: Option<f64>| p.map_or_else(|| "not computed".to_owned(), p_is);
        let bands = |name: &str, bands: &BandsAnswer| {
            let orders =
                bands.orders.map_or_else(String::new, |[n_a, n_b]| format!(" ({n_a},{n_b})"));
            let refused = bands.refused.as_ref().map(|why| format!("; not used: {why}"));
            format!(
                "{name}{orders}: v = {} {unit} (plain {}) over {} samples, settles in {}; white? {}, \
                 normal? {}{}\n",
                number(bands.v),
                number(bands.plain),
                bands.samples,
                bands.run_up,
                p(bands.whiteness_p),
                p(bands.normality_p),
                refused.unwrap_or_default()
            )
        };
        let mut text = format!(
            "{} from {}, every {} s; a fault is declared after {} samples outside\n\
         process model ({}/{}/{}): free-run error {} {unit} in training, {} {unit} on what it was judged \
             by\n",
            answer.watched.name,
            inputs.join(", "),
            answer.period,
            answer.window_samples,
            answer.process_model.v1,
            answer.process_model.v2,
            answer.process_model.order,
            number(answer.process_model.estimation_rms),
            number(answer.process_model.validation_rms),
        );
        if !answer.structures.is_empty() {
            text += "sizes v1/v2/order by AIC:";
            for row in &answer.structures {
                let chosen = if row.chosen { " (chosen)" } else { "" };
                let StructureAnswer { v1, v2, order, aic, .. } = row;
                text += &format!(" {v1}/{v2}/{order} {aic:.0}{chosen};");
            }
            text += "\n";
        }
        text += &bands("ARX error model", &answer.bands);
        if let Some(recurrent) = &answer.recurrent_error {
            text += &bands("recurrent error model", recurrent);
        }
        text += &format!(
            "constant thresholds: {} to {} {unit}\n",
            number(answer.constant.lower),
            number(answer.constant.upper)
        );
        text.extend(answer.designed.iter().map(|line| format!("{line}\n")));
        if let Some(WindowsAnswer { samples, mean, spread, runs, .. }) = &answer.windows {
            text += &format!(
                "windows of {samples} samples against a baseline, from {runs} healthy runs: mean \
                 within {} {unit}, spread within {} %\n",
                number(*mean),
                percent(spread.exp() - 1.0, 0)
            );
        }
        if let Some(gmdh) = &answer.gmdh {
            let GmdhAnswer { layers, neurons, validation_rms, noise, .. } = gmdh;
            let noise = noise.map_or_else(String::new, |[lower, upper]| {
                format!(", noise bounds {} to {} {unit}", number(lower), number(upper))
            });
            text += &format!(
                "GMDH network: {neurons} neurons in {layers} layers, validation error {} {unit}{noise}; \
                 {} with bounded parameters, {} vertices; {} {unit} from its locally recurrent form\n",
                number(*validation_rms),
                gmdh.bounded_neurons,
                gmdh.vertices,
                gmdh.recurrent_difference.map_or_else(|| "not known".to_owned(), number),
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
