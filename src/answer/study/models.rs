//! How large the models are: AIC over structures, Theorem 1 on an example, the GMDH network, the
//! recurrent error model.

use drivescope_scenarios::results::{
    GmdhSummary, RecurrentErrorSummary, StructureSummary, StudyResults,
};

use crate::answer::block::{Align, Block, Column, HTML, Table};
use crate::report::words::{count, given, number, p_is};

/// The section.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let mut blocks: Vec<Block> = structures(study).into();
    blocks.extend(theorem(study));
    match &study.model.recurrent_error {
        Some(model) => blocks.push(recurrent(study, model)),
        None => blocks.push(Block::Note("No recurrent error model was trained".to_owned())),
    }
    match &study.model.gmdh {
        Some(network) => blocks.extend(gmdh(study, network)),
        None => blocks.push(Block::Note("No GMDH network was synthesised".to_owned())),
    }
    vec![Block::In(HTML, blocks)]
}

/// Columns with these headings, and one for remarks.
fn columns<const N: usize>(headings: [&str; N]) -> Vec<Column> {
    let numbers = headings.into_iter().map(|heading| Column::new(Align::Number, heading));
    numbers.chain([Column::new(Align::Name, "")]).collect()
}

fn remarks(row: &StructureSummary) -> String {
    let all = [(row.best, "least AIC"), (row.paper, "the paper's"), (row.used, "used")];
    let those: Vec<_> = all.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
    those.join(", ")
}

fn structures(study: &StudyResults) -> [Block; 2] {
    let unit = &study.drive.tacho_unit;
    let (validation, healthy) =
        (format!("validation rms [{unit}]"), format!("healthy sd [{unit}]"));
    let headings = ["v_1", "v_2", "order", "parameters", "of them K", "AIC", &validation, &healthy];
    let caption = "Structures of the process model (1), (5), by AIC";
    let mut table = Table::new(caption, columns(headings));
    for row in &study.structures {
        table.push(vec![
            row.v1.to_string().into(),
            row.v2.to_string().into(),
            row.order.to_string().into(),
            row.parameters.to_string().into(),
            row.effective_parameters.to_string().into(),
            format!("{:.0}", row.aic).into(),
            number(row.validation).into(),
            number(row.healthy).into(),
            remarks(row).into(),
        ]);
    }
    let about = "AIC = N ln(SSE/N) + 2 K over free-run errors, K what the input-output behaviour \
                 depends on: with first-order filters six linear FIR neurons and a linear output \
                 collapse to one row. Healthy sd: of the residual of a healthy run of the closed loop, \
                 which no network was fitted on. The study runs with the least AIC among the \
                 structures within a tenth of the least of these: what a network does between the \
                 frequencies of the excitation costs no AIC, and widens the residual";
    [Block::Table(table), Block::Note(about.to_owned())]
}

fn theorem(study: &StudyResults) -> [Block; 2] {
    let theorem = &study.theorem;
    let headings = ["v_1", "v_2", "order", "greatest error"];
    let mut table = Table::new("Theorem 1 on an example", columns(headings));
    for row in &theorem.rows {
        let below = if row.max_error < theorem.epsilon { "below epsilon" } else { "" };
        table.push(vec![
            row.v1.to_string().into(),
            row.v2.to_string().into(),
            row.order.to_string().into(),
            number(row.max_error).into(),
            below.into(),
        ]);
    }
    let about = format!(
        "The example is z(k+1) = tanh(0.6 z(k) + 0.8 u(k)), u uniform between -1 and 1: greatest error \
         over {} samples of inputs that no network was trained on; epsilon = {}. The sizes that the \
         theorem leaves open include the order of the filters: with first-order ones more neurons \
         stop helping, for each sees the past in one exponentially weighted sum",
        theorem.horizon,
        given(theorem.epsilon)
    );
    [Block::Table(table), Block::Note(about)]
}

fn recurrent(study: &StudyResults, model: &RecurrentErrorSummary) -> Block {
    Block::Sentence(format!(
        "Recurrent error model: {}, {}, order {}; v = {} {} (ARX: {}); of r - y_e the whiteness test \
         has {}, the normality test {}",
        count(model.v1, "IIR neuron"),
        count(model.v2, "FIR neuron"),
        model.order,
        number(model.v),
        study.drive.tacho_unit,
        number(study.model.v),
        p_is(model.whiteness_p),
        p_is(model.normality_p)
    ))
}

fn gmdh(study: &StudyResults, network: &GmdhSummary) -> [Block; 2] {
    let unit = &study.drive.tacho_unit;
    let best = format!("validation rms of its best neuron [{unit}]");
    let caption = "Synthesis of the GMDH network (Section 2.3)";
    let mut table = Table::new(caption, columns(["Layer", &best]));
    for (place, error) in network.layers.iter().enumerate() {
        let kept = if place < network.kept { "kept" } else { "no significant gain" };
        table.push(vec![(place + 1).to_string().into(), number(*error).into(), kept.into()]);
    }
    let [lower, upper] = network.noise.map(number);
    let about = format!(
        "{} after pruning; trained together, their validation error is {} {unit}. Noise bounds (10) of \
         the closed loop: {lower} to {upper} {unit}, the least that leave any parameters, times 1.2. \
         The output neuron's parameters are bounded by a closed-loop and an open-loop run, their set \
         has {} vertices; its regressor is the network's own, taken as exact",
        count(network.neurons, "neuron"),
        number(network.validation),
        network.vertices
    );
    [Block::Table(table), Block::Note(about)]
}
