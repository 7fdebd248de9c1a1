//! How large the models are: AIC over structures, Theorem 1 on an example, the GMDH network, the
//! recurrent error model.

use drivescope_scenarios::results::{
    GmdhSummary, RecurrentErrorSummary, StructureSummary, StudyResults,
};
use maud::{Markup, html};

use crate::report::page::{self, math, minus, table};
use crate::report::words::{count, given, number, p_is};

/// The section.
pub(super) fn section(study: &StudyResults) -> Markup {
    page::section(
        "models",
        "Structures of the models",
        &html! {
            (structures(study))
            (theorem(study))
            @match &study.model.recurrent_error {
                Some(model) => { (recurrent(study, model)) }
                None => { p.note { "No recurrent error model was trained." } }
            }
            @match &study.model.gmdh {
                Some(network) => { (gmdh(study, network)) }
                None => { p.note { "No GMDH network was synthesised." } }
            }
        },
    )
}

fn remarks(row: &StructureSummary) -> Vec<&'static str> {
    let all = [(row.best, "least AIC"), (row.paper, "the paper's"), (row.used, "used")];
    all.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect()
}

fn structures(study: &StudyResults) -> Markup {
    let head = html! {
        tr {
            th scope="col" { (math("v_1")) }
            th scope="col" { (math("v_2")) }
            th scope="col" { "order" }
            th scope="col" { "parameters" }
            th scope="col" { "of them K" }
            th scope="col" { "AIC" }
            th scope="col" { "validation rms [" (study.drive.tacho_unit) "]" }
            th scope="col" { "healthy sd [" (study.drive.tacho_unit) "]" }
            th.name scope="col" { "" }
        }
    };
    let body = html! {
        @for row in &study.structures {
            tr {
                td { (row.v1) }
                td { (row.v2) }
                td { (row.order) }
                td { (row.parameters) }
                td { (row.effective_parameters) }
                td { (minus(&format!("{:.0}", row.aic))) }
                td { (number(row.validation)) }
                td { (number(row.healthy)) }
                td.name { (remarks(row).join(", ")) }
            }
        }
    };
    html! {
        (table("Structures of the process model (1), (5), by AIC", &head, &body))
        p.note {
            "AIC = N ln(SSE/N) + 2 K over free-run errors, K what the input-output behaviour depends "
            "on: with first-order filters six linear FIR neurons and a linear output collapse to one "
            "row. Healthy sd: of the residual of a healthy run of the closed loop, which no network was "
            "fitted on. The study runs with the least AIC among the structures within a tenth of the "
            "least of these: what a network does between the frequencies of the excitation costs no AIC, "
            "and widens the residual."
        }
    }
}

fn theorem(study: &StudyResults) -> Markup {
    let theorem = &study.theorem;
    let head = html! {
        tr {
            th scope="col" { (math("v_1")) }
            th scope="col" { (math("v_2")) }
            th scope="col" { "order" }
            th scope="col" { "greatest error" }
            th.name scope="col" { "" }
        }
    };
    let body = html! {
        @for row in &theorem.rows {
            tr {
                td { (row.v1) }
                td { (row.v2) }
                td { (row.order) }
                td { (number(row.max_error)) }
                td.name { @if row.max_error < theorem.epsilon { "below epsilon" } }
            }
        }
    };
    html! {
        (table("Theorem 1 on an example", &head, &body))
        p.note {
            "z(k+1) = tanh(0.6 z(k) + 0.8 u(k)), u uniform between \u{2212}1 and 1: greatest error over "
            (theorem.horizon) " samples of inputs that no network was trained on; epsilon = "
            (given(theorem.epsilon)) ". The sizes that the theorem leaves open include the order of "
            "the filters: with first-order ones more neurons stop helping, for each sees the past in "
            "one exponentially weighted sum."
        }
    }
}

fn recurrent(study: &StudyResults, model: &RecurrentErrorSummary) -> Markup {
    html! {
        p {
            "Recurrent error model: " (count(model.v1, "IIR neuron")) ", "
            (count(model.v2, "FIR neuron")) ", order " (model.order) "; v = " (number(model.v)) " "
            (study.drive.tacho_unit) " (ARX: " (number(study.model.v)) "); of " (math("r \u{2212} y_e"))
            " the whiteness test has " (minus(&p_is(model.whiteness_p)))
            ", the normality test " (minus(&p_is(model.normality_p))) "."
        }
    }
}

fn gmdh(study: &StudyResults, network: &GmdhSummary) -> Markup {
    let unit = &study.drive.tacho_unit;
    let head = html! {
        tr {
            th scope="col" { "Layer" }
            th scope="col" { "validation rms of its best neuron [" (unit) "]" }
            th.name scope="col" { "" }
        }
    };
    let body = html! {
        @for (place, error) in network.layers.iter().enumerate() {
            tr {
                td { (place + 1) }
                td { (number(*error)) }
                td.name { @if place < network.kept { "kept" } @else { "no significant gain" } }
            }
        }
    };
    let [lower, upper] = network.noise.map(|epsilon| minus(&number(epsilon)));
    html! {
        (table("Synthesis of the GMDH network (Section 2.3)", &head, &body))
        p.note {
            (count(network.neurons, "neuron")) " after pruning; trained together, their validation error "
            "is " (number(network.validation)) " " (unit) ". Noise bounds (10) of the closed loop: "
            (lower) " to " (upper) " " (unit) ", the least that leave any parameters, times 1.2. The "
            "output neuron's parameters are bounded by a closed-loop and an open-loop run, their "
            "set has " (network.vertices) " vertices; its regressor is the network's own, taken as exact."
        }
    }
}
