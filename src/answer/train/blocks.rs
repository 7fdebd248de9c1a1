//! A training in blocks.

use super::{
    BandsAnswer, FaultAnswer, FaultsAnswer, GmdhAnswer, ProcessAnswer, StructureAnswer,
    TrainAnswer, WindowsAnswer,
};
use crate::answer::block::{ALL, Align, Block, Column, Fact, Said, TERMINAL, Table};
use crate::report::words::{count, number, p_is, percent};

impl TrainAnswer {
    /// The answer in blocks.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        let inputs: Vec<&str> = self.inputs.iter().map(|channel| channel.name.as_str()).collect();
        let mut blocks = vec![
            Block::Sentence(format!(
                "{} from {}, every {} s; a fault is declared after {} samples outside",
                self.watched.name,
                inputs.join(", "),
                self.period,
                self.window_samples
            )),
            Block::Facts(self.models()),
        ];
        blocks.extend(self.faults.iter().flat_map(FaultsAnswer::blocks));
        blocks.extend(self.bank.iter().flat_map(super::BankAnswer::blocks));
        blocks.extend(self.output.as_ref().map(|path| {
            Block::Facts(vec![Fact::new(TERMINAL, "written", path.display().to_string())])
        }));
        blocks
    }

    /// The models and their thresholds.
    fn models(&self) -> Vec<Fact> {
        let unit = &self.watched.unit;
        let of = |value: f64| format!("{} {unit}", number(value));
        let ProcessAnswer { v1, v2, order, estimation_rms, validation_rms } = &self.process_model;
        let fact = |name: String, value: String| Fact::new(ALL, name, value);
        let mut facts = vec![fact(
            format!("Process model {v1}/{v2}/{order}"),
            format!(
                "free-run error {} in training, {} on what it was judged by",
                of(*estimation_rms),
                of(*validation_rms)
            ),
        )];
        if !self.structures.is_empty() {
            let size = |row: &StructureAnswer| {
                let chosen = if row.chosen { " (chosen)" } else { "" };
                let StructureAnswer { v1, v2, order, aic, healthy, .. } = row;
                format!("{v1}/{v2}/{order} {aic:.0}, {}{chosen}", of(*healthy))
            };
            let sizes: Vec<String> = self.structures.iter().map(size).collect();
            facts.push(fact(
                "Sizes v1/v2/order by AIC, residual on a healthy recording".to_owned(),
                sizes.join("; "),
            ));
        }
        facts.push(bands("ARX error model", &self.bands, &of));
        let recurrent = self.recurrent_error.as_ref();
        facts.extend(recurrent.map(|it| bands("Recurrent error model", it, &of)));
        let (lower, upper) = (of(self.constant.lower), of(self.constant.upper));
        facts.push(fact("Constant thresholds".to_owned(), format!("{lower} to {upper}")));
        let designed = self.designed.iter();
        facts.extend(designed.map(|(label, how)| fact((*label).to_owned(), how.clone())));
        facts.extend(self.windows.as_ref().map(|it| {
            let WindowsAnswer { samples, mean, drift, spread, runs, .. } = it;
            let slowly = drift.map_or_else(String::new, |it| format!(" ({} slowly)", of(it)));
            fact(
                format!("Windows of {samples} samples against a baseline"),
                format!(
                    "mean within {}{slowly}, spread within {} %, from {runs} healthy runs",
                    of(*mean),
                    percent(spread.exp() - 1.0, 0)
                ),
            )
        }));
        facts.extend(self.gmdh.as_ref().map(|it| gmdh(it, &of)));
        facts
    }
}

fn bands(name: &str, bands: &BandsAnswer, of: &dyn Fn(f64) -> String) -> Fact {
    let p = |p: Option<f64>| p.map_or_else(|| "not computed".to_owned(), p_is);
    let orders = bands.orders.map_or_else(String::new, |[n_a, n_b]| format!(" ({n_a},{n_b})"));
    let refused = bands.refused.as_ref().map(|why| format!("; not used: {why}"));
    let value = format!(
        "v = {} (plain {}) over {} samples, settles in {} samples; white? {}, normal? {}{}",
        of(bands.v),
        of(bands.plain),
        bands.samples,
        bands.run_up,
        p(bands.whiteness_p),
        p(bands.normality_p),
        refused.unwrap_or_default()
    );
    Fact::new(ALL, format!("{name}{orders}"), value)
}

fn gmdh(it: &GmdhAnswer, of: &dyn Fn(f64) -> String) -> Fact {
    let GmdhAnswer { layers, neurons, validation_rms, noise, bounded_neurons, vertices, .. } = it;
    let noise = noise.map_or_else(String::new, |[lower, upper]| {
        format!(", noise bounds {} to {}", of(lower), of(upper))
    });
    let value = format!(
        "{} in {}, validation error {}{noise}; {bounded_neurons} with bounded parameters, \
         {vertices} vertices; {} from its locally recurrent form",
        count(*neurons, "neuron"),
        count(*layers, "layer"),
        of(*validation_rms),
        it.recurrent_difference.map_or_else(|| "not known".to_owned(), of),
    );
    Fact::new(ALL, "GMDH network", value)
}

impl FaultsAnswer {
    fn blocks(&self) -> [Block; 2] {
        let classes: Vec<String> = self.classes.iter().map(|class| class.join(" | ")).collect();
        let classes = classes.join("; ");
        let name = |heading| Column::new(Align::Name, heading);
        let figure = |heading| Column::new(Align::Number, heading);
        let columns: &[(Column, Said<&FaultAnswer>)] = &[
            (name("Fault"), |it| it.fault.as_str().into()),
            (figure("Right"), |it| format!("{} %", percent(it.right, 1)).into()),
            (figure("Unknown"), |it| format!("{} %", percent(it.unknown, 1)).into()),
            (figure("Size S, in thresholds"), |it| number(it.s).into()),
            (name("Group"), |it| it.group.label().into()),
        ];
        let table = Table::of("Symptoms that were not learned from", columns, &self.faults);
        let stated = format!("classes of faults that can be told apart: {classes}");
        [Block::Note(stated), Block::Table(table)]
    }
}
