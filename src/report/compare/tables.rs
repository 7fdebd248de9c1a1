//! The numbers of a comparison as tiles and tables.

use drivescope_discovery::compare::{Comparison, Finding, OutputComparison};
use maud::{Markup, html};

use super::Setting;
use crate::report::page::{minus, table};
use crate::report::words::{number, p_value, percent};

/// The figures that matter most.
pub(crate) fn tiles(compared: &Comparison, setting: &Setting) -> Markup {
    html! {
        dl.tiles {
            div {
                dt { "Error" @if setting.step.is_some() { " on estimation" } }
                dd {
                    (number(setting.step.map_or(compared.error, |step| step.estimation_error)))
                    span.sub { "in units of the noise, floor " (number(compared.floor)) }
                }
            }
            @if let Some(error) = setting.validation_error {
                div {
                    dt { "Error on validation" }
                    dd { (number(error)) span.sub { "what only judges" } }
                }
            }
            @for output in compared.recordings.first().map_or(&[][..], |it| &it.outputs) {
                div {
                    dt { "Fit of " (output.name) }
                    dd {
                        (fit(output.fit_percent))
                        span.sub {
                            @if setting.step.is_some() { "over the whole recording; " }
                            "one step ahead " (fit(output.one_step_percent))
                        }
                    }
                }
            }
        }
    }
}

fn fit(value: Option<f64>) -> String {
    value.map_or_else(|| "constant".to_owned(), |it| minus(&format!("{it:.2} %")))
}

/// The variables over which the model fails.
pub(crate) fn findings(compared: &Comparison) -> Markup {
    let about = html! {
        p.note {
            (compared.tested) " possible laws over speed, its sign, current, angle, time, \
             temperature, acceleration and limits were tested with blocks of "
            (number(compared.block_s)) " s. The probability is that of as much by chance, corrected \
             for their number, each row conditional on the rows above; below 0.001 it is reported."
        }
    };
    if compared.findings.is_empty() {
        return html! { p { "Nowhere: no variable explains the residual." } (about) };
    }
    let head = html! {
        tr {
            th.name scope="col" { "Variable" }
            th scope="col" { "Share of the excess [%]" }
            th scope="col" { "By chance" }
            th.name scope="col" { "Acts on" }
            th.name scope="col" { "What it looks like" }
        }
    };
    let row = |it: &Finding| {
        html! {
            tr {
                th scope="row" { (it.variable) }
                td { (percent(it.share, 1)) }
                td { (p_value(it.p_value)) }
                td.name { (it.balance) }
                td.words {
                    (it.words)
                    @if let Some(period) = it.period { ", period " (number(period)) }
                }
            }
        }
    };
    let body = html! { @for it in &compared.findings { (row(it)) } };
    html! { (table("Where the model fails, most telling first", &head, &body)) (about) }
}

/// Every output of every recording, and whether its residual is white.
pub(crate) fn residuals(compared: &Comparison) -> Markup {
    let head = html! {
        tr {
            th.name scope="col" { "Recording" }
            th.name scope="col" { "Output" }
            th scope="col" { "Fit [%]" }
            th scope="col" { "rms difference" }
            th.name scope="col" { "unit" }
            th scope="col" { "Error" }
            th scope="col" { "Error one step ahead" }
            th scope="col" { "Effective samples" }
            th.name scope="col" { "White" }
            th.name scope="col" { "Knows the input" }
        }
    };
    let yes = |found: bool| if found { "yes" } else { "no" };
    let row = |name: &str, it: &OutputComparison| {
        html! {
            tr {
                th scope="row" { (name) }
                td.name { (it.name) }
                td { (fit(it.fit_percent)) }
                td { (number(it.rms)) }
                td.name { (it.unit) }
                td { (number(it.error)) }
                td { (number(it.one_step_error)) }
                td { (format!("{:.0}", it.autocorrelation.effective_samples)) }
                td.name { (yes(!it.autocorrelation.correlated)) }
                td.name { (yes(it.input_correlation.correlated)) }
            }
        }
    };
    let body = html! {
        @for recording in &compared.recordings {
            @for output in &recording.outputs { (row(&recording.name, output)) }
        }
    };
    html! {
        (table("Residuals", &head, &body))
        p.note {
            "Errors in units of the noise. Bands of the correlations allow for correlated samples \
             (Bartlett). The prediction one step ahead uses what was left of all outputs before."
        }
        @for (place, recording) in compared.recordings.iter().enumerate() {
            (crate::report::page::figure(
                &format!("correlation-{place}"),
                super::pictures::correlations(recording, place).svg(),
                &format!("Correlations of the residual, {}", recording.name),
                &html! {
                    "Correlation of the residual with itself and with the input; within the bands, \
                     nothing was found."
                },
            ))
        }
    }
}

/// Noise, observer, doubts.
pub(crate) fn setting(compared: &Comparison, setting: &Setting) -> Markup {
    html! {
        dl.facts {
            div {
                dt { "Observer" }
                dd {
                    @if compared.observer_hz > 0.0 {
                        (number(compared.observer_hz)) " Hz, fixed"
                    } @else {
                        "none: the model runs free from u"
                    }
                }
            }
            @for (name, value, source) in &setting.noise {
                div { dt { "Noise of " (name) } dd { (value) " (" (source) ")" } }
            }
        }
        @if !setting.doubts.is_empty() {
            ul.reading { @for doubt in &setting.doubts { li { (doubt) } } }
        }
    }
}
