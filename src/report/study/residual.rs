//! False alarms, the residual, and whether the assumptions of the bands hold.

use drivescope_scenarios::results::{DetectorKind, StudyResults};
use maud::{Markup, html};

use crate::report::page::{self, math, minus, table};
use crate::report::words::{TEST_LEVEL, given, normality, number, p_value, percent, whiteness};

/// Samples of the paper's sum of squared errors.
const PAPER_SAMPLES: usize = 3000;
/// The section.
pub(super) fn section(study: &StudyResults) -> Markup {
    page::section(
        "residual",
        "Residual and false alarms",
        &html! { (alarms(study)) (statistics(study)) (assumptions(study)) },
    )
}

fn alarms(study: &StudyResults) -> Markup {
    let head = html! {
        tr {
            th.name scope="col" { "Method" }
            th scope="col" { (math("r_fd [%]")) }
            th.theirs scope="col" { "paper [%]" }
            th scope="col" { "designed [%]" }
            th scope="col" { "false alarms" }
            th scope="col" { "before a fault" }
        }
    };
    let body = html! {
        @for method in DetectorKind::ALL {
            @let rows = study.detection.iter().filter(|row| row.method == method);
            @let early: usize = rows.map(|row| row.false_alarms).sum();
            @let alarms = study.healthy.alarms.of(method);
            tr {
                th scope="row" { (method.label()) }
                td { (percent(study.r_fd.of(method), 2)) }
                td.theirs {
                    @match study.paper.r_fd.of(method) {
                        Some(rate) => { (percent(rate, 1)) }
                        None => { "\u{2013}" }
                    }
                }
                td {
                    @match method.info().instead_of_level {
                        Some(words) => { (words) }
                        None => { (percent(study.beta, 1)) }
                    }
                }
                td { span.alert[alarms > 0] { (alarms) } }
                td { span.alert[early > 0] { (early) } }
            }
        }
    };
    html! {
        (table("Healthy runs", &head, &body))
        p.note {
            (math("r_fd")) ": share of " (study.healthy.samples) " healthy samples outside the threshold. "
            "Widths were measured on " (study.model.design_samples) " other healthy samples. "
            "False alarms: declarations in these samples; \u{201c}before a fault\u{201d}: in the "
            "healthy part of faulty runs."
        }
    }
}

fn statistics(study: &StudyResults) -> Markup {
    let (model, unit) = (&study.model, &study.drive.tacho_unit);
    let quantity = |name: &str, value: f64, unit: &str, note: String| {
        html! {
            tr {
                th scope="row" { (name) }
                td { (minus(&number(value))) }
                td.name { (unit) }
                td.words { (math(&note)) }
            }
        }
    };
    let head = html! {
        tr {
            th.name scope="col" { "Quantity" }
            th scope="col" { "Value" }
            th.name scope="col" { "Unit" }
            th.name scope="col" { "What it is" }
        }
    };
    let set_point = study.drive.set_point;
    let rms = |sse: f64, samples: usize| number(set_point * (sse / samples as f64).sqrt());
    let paper = format!(
        "error model with {} past outputs and {} past inputs, one-step errors over {} samples as \
         shares of the set point: {} {unit} rms. The paper gives {} over {PAPER_SAMPLES} samples \
         and no scale: as shares of this set point that would be {} {unit} rms, a tachometer's \
         noise; unscaled it would be {} {unit} rms, finer than any",
        model.n_a,
        model.n_b,
        model.error_model_samples,
        rms(model.error_model_sse, model.error_model_samples),
        number(study.paper.arx_sse),
        rms(study.paper.arx_sse, PAPER_SAMPLES),
        number((study.paper.arx_sse / PAPER_SAMPLES as f64).sqrt()),
    );
    let body = html! {
        (quantity(
            "training error, sd", model.training_sd, unit,
            format!("{}, free run over {} samples", model.process_model, model.training_samples),
        ))
        (quantity(
            "residual, mean", model.residual_mean, unit, "healthy closed-loop design data".into(),
        ))
        (quantity("residual, sd", model.residual_sd, unit, "the same data".into()))
        (quantity("v", model.v, unit, "sd of r \u{2212} y_e, from which the bands are made".into()))
        (quantity("lower constant threshold", model.constant.0, unit, "dashed above".into()))
        (quantity("upper constant threshold", model.constant.1, unit, "dashed above".into()))
        (quantity("SSE of the error model", model.error_model_sse, "\u{2013}", paper))
    };
    table("Models and residual", &head, &body)
}

fn assumptions(study: &StudyResults) -> Markup {
    let model = &study.model;
    let head = html! {
        tr {
            th.name scope="col" { (math("Assumption on r \u{2212} y_e")) }
            th scope="col" { "p value" }
            th.name scope="col" { "Reading" }
        }
    };
    let body = html! {
        @for (name, p, reading) in [
            ("white (independent)", model.whiteness_p, whiteness(model.whiteness_p)),
            ("normal", model.normality_p, normality(model.normality_p)),
        ] {
            tr {
                th scope="row" { (name) }
                td { (minus(&p_value(p))) }
                td.words { (reading) "." }
            }
        }
    };
    html! {
        (table("Do the assumptions of the bands (6), (7) hold?", &head, &body))
        p.note {
            "Healthy data. A p value below " (given(TEST_LEVEL)) " rejects the assumption; many "
            "samples reject it for deviations too small to matter, so the measured " (math("r_fd"))
            " has the last word."
        }
    }
}
